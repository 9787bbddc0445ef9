"""One world of a batch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.arrays import depth, image, reader
from cartwheel.batch.plan import AbsoluteVary, Applied, Plan, Readable, TopicFields, invalid
from cartwheel.batch.start import Start
from cartwheel.codes.graph import NO_MESSAGE
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array
from cartwheel.messages.making import maker

if TYPE_CHECKING:
    from cartwheel.api import Built, World

Values = dict[str, Array]
Observer = Callable[["World"], Any]
Reader = Callable[[Any], Any]
_DEPTHS = ("32FC1", "16UC1")


class Lane:
    """A world with its subscriptions.

    Args:
        built: Makes the world.
        plan: What it receives and returns.
        seed: Seed for all noise.

    Raises:
        UnknownNameError: A topic does not exist.
        GraphError: A message does not have a field.
        CartwheelError: The world cannot be made.
    """

    def __init__(self, built: Built, plan: Plan, seed: int) -> None:
        self._plan, self._seed = plan, seed
        self.world: World = built._world(seed=seed, watched=False)
        self._newest: dict[str, Any] = {}
        self._actions: list[Callable[[Sequence[float]], object]] = []
        self._sources: list[tuple[str, Callable[[], Any]]] = []
        """Reads each observation."""
        self._start: Start | None = None
        try:
            column = 0
            for name, action in plan.act.items():
                count = action.count if isinstance(action, Applied) else len(action)
                columns = slice(column, column + count)
                self._actions.append(self._action(name, action, columns))
                column = columns.stop
            self._sources += [(name, self._source(name, each)) for name, each in plan.obs.items()]
            if plan.vary is not None and not isinstance(plan.vary, AbsoluteVary):
                self._start = Start(self.world, plan.vary)
        except BaseException:
            self.world.close()
            raise

    def _action(
        self, name: str, action: Sequence[str] | Applied, columns: slice
    ) -> Callable[[Sequence[float]], object]:
        """A function that applies its columns of the actions."""
        world, graph = self.world, self.world.graph
        if isinstance(action, Applied):
            function = action.function
            return lambda values: function(world, np.array(values[columns]))
        kind = graph.topic(name).type
        make = maker(kind, action)
        return lambda values: graph.publish(name, kind, make(values[columns]))

    def _source(self, name: str, observed: TopicFields | Observer | Readable) -> Callable[[], Any]:
        """A function that reads an observation: an array, or a list of as many numbers each time.

        Array and list are not changed later.
        """
        world = self.world
        if isinstance(observed, TopicFields):
            return self._fields(observed)
        if not callable(observed):
            return observed.reader(world)

        def call() -> Array:
            try:
                return _numbers(observed(world))
            except (TypeError, ValueError, OverflowError) as error:
                raise invalid(
                    f'the function of the observation "{name}" must return numbers: {error}', "obs"
                ) from None

        return call

    def _fields(self, observed: TopicFields) -> Callable[[], Array]:
        """A function that reads fields of the newest message of a topic."""
        topic, newest = observed.topic, self._newest
        kind = self.world.graph.topic(topic).type
        readers = [_reader(kind, field) for field in observed.fields]
        empty = self.world.message_class(kind)()
        for read in readers:
            if read is not _picture:
                read(empty)  # a field that does not exist is an error now
        if topic not in newest:
            newest[topic] = None
            self.world.subscribe(topic, self._keeper(topic))

        def read_newest() -> Array:
            message = newest[topic]
            if message is None:
                raise self._no_message(topic)
            read = [each(message) for each in readers]
            return _numbers(read[0] if observed.single else _row(read))

        return read_newest

    def _keeper(self, topic: str) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            self._newest[topic] = message

        return keep

    def begin(self, seed: int | None) -> None:
        """Starts again, with a new seed unless it is None."""
        world, plan = self.world, self._plan
        self._seed = self._seed if seed is None else seed
        if self._start is not None:
            self._start.begin(world, self._seed)
        else:
            world.reset(seed=seed)
            if plan.vary is not None:
                plan.vary(world, np.random.default_rng(self._seed))
        for topic in self._newest:
            self._newest[topic] = None

    def act(self, action: Sequence[float]) -> None:
        """Publishes or applies the actions."""
        for each in self._actions:
            each(action)

    def observe(self) -> dict[str, Any]:
        """The observations at the current time: arrays, or lists of numbers.

        Raises:
            CartwheelError: A topic has not had a message yet, or a function has not returned
                numbers.
        """
        return {name: read() for name, read in self._sources}

    def _no_message(self, topic: str) -> CartwheelError:
        return CartwheelError(
            f"there has been no message on {topic} in the first {self._plan.period:g} s",
            code=NO_MESSAGE,
            hint="Choose a longer period, or a sensor with a higher rate.",
            values={"topic": topic},
        )

    def close(self) -> None:
        """Closes the world."""
        self.world.close()


def _reader(kind: str, field: str) -> Reader:
    """Reads a field of messages of a type; the data of images as a picture."""
    if field == "data" and kind.startswith("sensor_msgs/") and kind.endswith("Image"):
        return _picture
    return reader(field)


def _picture(message: Any) -> Array:
    encoding = getattr(message, "encoding", "") or message.format
    return (
        depth(message) if encoding in _DEPTHS or "compressedDepth" in encoding else image(message)
    )


def _row(values: list[Any]) -> Any:
    """The numbers of several fields, some of which may be arrays."""
    return np.hstack(values) if any(isinstance(each, np.ndarray) for each in values) else values


def _numbers(value: Any) -> Array:
    """A copy as an array of float64; pictures remain uint8."""
    kind = np.uint8 if isinstance(value, np.ndarray) and value.dtype == np.uint8 else float
    return np.array(value, dtype=kind)


def stacked(rows: list[Mapping[str, Any]]) -> Values:
    """The observations of several worlds, with the world as the first axis.

    Raises:
        CartwheelError: Arrays of an observation have different shapes or types.
    """
    found: Values = {}
    for name, first in rows[0].items():
        if isinstance(first, list):
            found[name] = np.array([row[name] for row in rows], dtype=float)
            continue
        shape = first.shape
        table = found[name] = np.empty((len(rows), *shape), first.dtype)
        for line, row in enumerate(rows):
            each = row[name]
            if each.shape != shape or each.dtype != first.dtype:
                check_alike(name, first, each)
            table[line] = each
    return found


def check_alike(name: str, one: Array, other: Array) -> None:
    """Checks that an observation is alike in two worlds.

    Raises:
        CartwheelError: The arrays have different shapes or types.
    """
    for what, a, b in (("shapes", one.shape, other.shape), ("types", one.dtype, other.dtype)):
        if a != b:
            raise invalid(
                f'the observation "{name}" has different {what} in different worlds: {a} and {b}',
                "obs",
            )
