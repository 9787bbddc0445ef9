"""One world of a batch."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel import arrays
from cartwheel.batch.plan import Plan, TopicFields, invalid
from cartwheel.codes.graph import NO_MESSAGE
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array
from cartwheel.messages import from_dict

if TYPE_CHECKING:
    from cartwheel.api import Built, World

Values = dict[str, Array]


class Lane:
    """A world with its subscriptions.

    Args:
        built: Makes the world.
        plan: What it receives and returns.
        seed: Seed for all noise.

    Raises:
        UnknownNameError: A topic does not exist.
        CartwheelError: The world cannot be made.
    """

    def __init__(self, built: Built, plan: Plan, seed: int) -> None:
        self._plan, self._seed = plan, seed
        self.world: World = built.world(seed=seed)
        self._newest: dict[str, Any] = {}
        try:
            self._kinds = {topic: self.world.graph.topic(topic).type for topic in plan.act}
            for each in plan.obs.values():
                if isinstance(each, TopicFields) and each.topic not in self._newest:
                    self._newest[each.topic] = None
                    self.world.subscribe(each.topic, self._keeper(each.topic))
        except BaseException:
            self.world.close()
            raise

    def _keeper(self, topic: str) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            self._newest[topic] = message

        return keep

    def reset(self, seed: int | None) -> Values:
        """Begins anew, with a new seed unless it is None, and runs a step without an action."""
        world, plan = self.world, self._plan
        self._seed = self._seed if seed is None else seed
        world.reset(seed=seed)
        for topic in self._newest:
            self._newest[topic] = None
        if plan.vary is not None:
            plan.vary(world, np.random.default_rng(self._seed))
        world.run(plan.period)
        return self.observe()

    def step(self, action: Array) -> Values:
        """Publishes the actions, and runs for a period."""
        world = self.world
        column = 0
        for topic, fields in self._plan.act.items():
            message: dict[str, Any] = {}
            for field in fields:
                _set(message, field, float(action[column]))
                column += 1
            kind = self._kinds[topic]
            world.graph.publish(topic, kind, from_dict(kind, message))
        world.run(self._plan.period)
        return self.observe()

    def observe(self) -> Values:
        """The observations at the current time.

        Raises:
            CartwheelError: A topic has not had a message yet, or a function has not returned
                numbers.
        """
        return {name: self._value(name, each) for name, each in self._plan.obs.items()}

    def _value(self, name: str, source: TopicFields | Callable[[World], Any]) -> Array:
        if not isinstance(source, TopicFields):
            try:
                return np.array(source(self.world), dtype=float)
            except (TypeError, ValueError) as error:
                raise invalid(
                    f'the function of the observation "{name}" must return numbers: {error}', "obs"
                ) from None
        message = self._newest[source.topic]
        if message is None:
            raise CartwheelError(
                f"there has been no message on {source.topic} in the first {self._plan.period:g} s",
                code=NO_MESSAGE,
                hint="Choose a longer period, or a sensor with a higher rate.",
                values={"topic": source.topic},
            )
        found = [arrays.values((message,), field)[0] for field in source.fields]
        return np.asarray(found[0] if source.single else found, dtype=float)

    def close(self) -> None:
        """Closes the world."""
        self.world.close()


def _set(message: dict[str, Any], field: str, value: float) -> None:
    *parents, last = field.split(".")
    for parent in parents:
        message = message.setdefault(parent, {})
    message[last] = value


def stacked(rows: list[Mapping[str, Array]]) -> Values:
    """The observations of several worlds, with the world as the first axis.

    Raises:
        CartwheelError: Arrays of an observation have different shapes.
    """
    found: Values = {}
    for name in rows[0]:
        shapes = {row[name].shape for row in rows}
        if len(shapes) > 1:
            raise different_shapes(name, shapes)
        found[name] = np.stack([row[name] for row in rows])
    return found


def different_shapes(name: str, shapes: Iterable[tuple[int, ...]]) -> CartwheelError:
    """The error of an observation that is not of the same size in all worlds."""
    return invalid(
        f'the observation "{name}" has different shapes in different worlds: '
        f"{', '.join(map(str, sorted(shapes)))}",
        "obs",
    )
