"""Topics of a world as objects: their messages, and publishing at a rate."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Generic, Self

import numpy as np

from cartwheel import arrays
from cartwheel.api.plots import Plot
from cartwheel.api.timing import TIMEOUT, timed_out
from cartwheel.codes.graph import NO_MESSAGE
from cartwheel.errors import GraphError, Value
from cartwheel.geometry import Array
from cartwheel.graph import made_message
from cartwheel.messages import zero
from cartwheel.messages.typed import M
from cartwheel.similar_names import meant, suggestion
from cartwheel.simulation.alarms import Alarm
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import check_size, rate_period_ns

if TYPE_CHECKING:
    from cartwheel.api.messaging import MessagingWorld
    from cartwheel.simulation import Simulation

RATE = 10.0
"""Default rate of `Topic.hold`, Hz, as in ``cartwheel teleop``."""
_KEPT, _KEPT_LARGE = 1000, 10
_LARGE = frozenset(
    f"sensor_msgs/msg/{name}" for name in ("Image", "CompressedImage", "PointCloud", "PointCloud2")
)


class _Received:
    """The newest messages of a topic, without a reference to the `Topic`, which would be a cycle.

    Args:
        simulation: The simulation, for the time.
        latched: The message that the graph delivers again to a new subscriber, or None.
    """

    def __init__(self, simulation: Simulation, latched: Any) -> None:
        self._simulation = simulation
        self._rewinds = simulation.engine.rewinds
        self._latched = latched
        self.is_latched: Callable[[], bool] = bool
        """Whether the graph has a latched message of the topic."""
        self.messages: deque[tuple[int, Any]] = deque(maxlen=_KEPT)
        self.count = 0

    def __call__(self, message: Any) -> None:
        if message is not self._latched:
            self.add(message)
        self._latched = None

    def add(self, message: Any) -> None:
        self.count += 1
        if self._simulation.engine.rewinds != self._rewinds:
            self._forget()
        self.messages.append((self._simulation.time_ns, message))

    def rewind(self) -> None:
        """Forgets messages of the future after time was set, but not a latched one."""
        if self._simulation.engine.rewinds == self._rewinds:
            return  # a message was published meanwhile
        last = list(self.messages)[-1:]
        self._forget()
        if last and not self.messages and self.is_latched():
            self.messages.append((self._simulation.time_ns, last[0][1]))

    def _forget(self) -> None:
        """Forgets messages that are later than the time, at time 0 all of them."""
        self._rewinds = self._simulation.engine.rewinds
        now = self._simulation.time_ns
        kept = [each for each in self.messages if now > 0 and each[0] <= now]
        self.messages = deque(kept, self.messages.maxlen)

    def keep(self, size: int) -> None:
        self.messages = deque(self.messages, maxlen=size)


class Topic(Generic[M]):
    """A topic of a world, and its newest messages.

    `World.topic` creates it and subscribes to the topic, so that its sensor produces data. It keeps
    the newest 1000 messages, of images and point clouds the newest 10. After `World.restore`, it
    has only those up to the restored time, and after `World.reset` none, except for a latched one.

    For type checkers, ``Topic[Odometry]`` has messages of this class of `cartwheel.msgs`, and a
    `Topic` that was created without a class has messages of any type.
    """

    def __init__(
        self, world: MessagingWorld, name: str, kind: str | None, keep: int | None
    ) -> None:
        self._world = world
        graph = world.graph
        latched = graph.latched(name)
        self._received = _Received(world.session.simulation, latched)
        self._subscription = graph.subscribe(
            name, self._received, type_name=kind, node="World.topic"
        )
        self.name = self._subscription.topic
        """Name of the topic."""
        self.type: str = graph.topic(self.name).type
        """Type of the messages, such as ``sensor_msgs/msg/LaserScan``."""
        self._received.keep(keep or (_KEPT_LARGE if self.type in _LARGE else _KEPT))
        if latched is not None:
            self._received.add(latched)
        full, received = self.name, self._received
        received.is_latched = lambda: graph.latched(full) is not None
        world.session.simulation.on_reset.append(received.rewind)

    def __repr__(self) -> str:
        return f"<Topic {self.name} {self.type}, {self.count} messages>"

    def keep(self, size: int) -> None:
        """Keeps at least the newest `size` messages from now on."""
        check_size(size)
        if size > (self._messages.maxlen or 0):
            self._received.keep(size)

    @property
    def _messages(self) -> deque[tuple[int, M]]:
        return self._received.messages

    @property
    def count(self) -> int:
        """Number of messages received, also of those that a reset has removed."""
        return self._received.count

    @property
    def latest(self) -> M | Any:
        """The newest message; None if there is none yet. Do not change it.

        Type checkers check the fields of the message, but not whether there is a message: after a
        run, a topic with a rate has one. `wait` always returns a message.
        """
        return self._messages[-1][1] if self._messages else None

    @property
    def latest_time(self) -> float | None:
        """Simulation time at which the newest message was published, s."""
        return self._messages[-1][0] / NANOSECONDS if self._messages else None

    def history(self, size: int | None = None) -> list[M]:
        """The newest messages that are kept, oldest first.

        Args:
            size: Maximum number; None for all. `World.topic` sets how many are kept.
        """
        return [message for _, message in self._newest(size)]

    def times(self, size: int | None = None) -> list[float]:
        """Simulation times at which the messages of `history` were published, s."""
        return [time_ns / NANOSECONDS for time_ns, _ in self._newest(size)]

    def values(self, field: str, size: int | None = None) -> Array:
        """One number or one array of each message of `history`.

        Args:
            field: Names joined with dots, such as ``pose.pose.position.x``, ``ranges[90]`` or
                ``ranges``. A part of an array is ``ranges[:90]``, ``ranges[-90:]`` or
                ``ranges[::10]``, as in Python.
            size: As for `history`.

        Returns:
            Shape (n,), or (n, m) for an array of numbers, where m is the size of the longest one;
            NaN where an array of a message has no such index. Times are in s.

        Raises:
            GraphError: The type does not have the field, or the field is not a number or an array
                of numbers, or the arrays in all messages end before the index.
        """
        messages = self.history(size)
        if not messages:
            arrays.values((zero(self.type),), field)  # refuses unknown fields
        return arrays.values(messages, field)

    def plot(self, *fields: str, size: int | None = None) -> Plot:
        """A plot of numbers over the simulation time, which notebooks display.

        Args:
            fields: Fields as for `values`. Each element of an array has a line of its own.
            size: As for `history`.

        Raises:
            GraphError: As for `values`.
            CartwheelError: No field is given, or matplotlib is not installed.
        """
        series: dict[str, Array] = {}
        for field in fields:
            values = self.values(field, size)
            columns = {field: values}
            if values.ndim == 2:
                columns = {f"{field}[{index}]": each for index, each in enumerate(values.T)}
            series |= columns
        return Plot(np.array(self.times(size)), series, title=self.name)

    def _newest(self, size: int | None) -> Sequence[tuple[int, M]]:
        if size is None:
            return list(self._messages)
        check_size(size)
        return list(self._messages)[-size:]

    def array(self) -> Any:
        """The newest message as an array; see `cartwheel.arrays.array`.

        Raises:
            GraphError: There is no message yet, or its type contains no array, or its sizes are
                inconsistent.
        """
        if not self._messages:
            raise GraphError(
                f'no message was received on "{self.name}"',
                code=NO_MESSAGE,
                values={"topic": self.name},
                hint="Call World.run or Topic.wait first.",
            )
        return arrays.array(self.latest)

    def wait(self, timeout: float = TIMEOUT) -> M:
        """Runs the world until the next message, and returns it.

        Args:
            timeout: Maximum simulation time, s.

        Raises:
            TimedOutError: No message was published within the time, or `World.stop` was called. The
                error contains the publishers of the topic.
            CartwheelError: `timeout` is out of range.
            SimulationError: See `World.run`.
        """
        __tracebackhide__ = True
        before = self.count
        self._world._until(lambda: self.count > before, timeout=timeout)
        if self.count == before or not self._messages:
            raise self._silent(timeout)
        return self._messages[-1][1]

    def _silent(self, timeout: float) -> Exception:
        graph = self._world.graph
        publishers, rate = graph.publishers(), None
        own = [each for each in publishers if each.topic == self.name]
        names = {each.topic for each in publishers if each.type == self.type}
        if own:
            rate = next((each.rate for each in own if each.rate), None)
            nodes = ", ".join(sorted({each.node for each in own}))
            known = f"{nodes} publishes it" + (f" at {rate:g} Hz" if rate else "")
            hint = None
        else:
            known = "nothing publishes it"
            others = sorted(names - {self.name})
            hint = suggestion(self.name, others) if others else None
        last = (
            f"the last message was published at {self.latest_time:.9g} s" if self._messages else ""
        )
        values: dict[str, Value] = {
            "topic": self.name,
            "timeout": timeout,
            "publishers": tuple(each.node for each in own),
            "rate": rate,
            "messages": self.count,
            "meant": "" if own else meant(self.name, names - {self.name}),
        }
        fault = "World.faults contains a fault of it" if graph.is_disturbed(self.name) else ""
        text = "; ".join(part for part in (known, last, fault) if part)
        return timed_out(
            f'no message on "{self.name}" was published within {timeout:g} s: {text}', values, hint
        )

    def publish(self, message: M | Mapping[str, Any] | None = None, **fields: Any) -> None:
        """Publishes a message; see `World.publish`."""
        self._world.publish(self.name, message, **fields)

    def hold(
        self,
        message: M | Mapping[str, Any] | None = None,
        *,
        rate: float = RATE,
        **fields: Any,
    ) -> Hold:
        """Publishes a message now, and then at a rate while the world runs.

        Devices execute the message in the step in which it is published. A reset starts the periods
        again.

        Args:
            message: As for `World.publish`.
            rate: Hz of simulation time.
            fields: As for `World.publish`.

        Returns:
            A handle whose `stop` ends it. In a ``with`` block, the end of the block does so. The
            last message stays in effect.

        Raises:
            CartwheelError: The rate is out of range.
            GraphError: As for `World.publish`.
        """
        world = self._world
        period = rate_period_ns(rate)
        kind = self.type
        made = made_message(self.name, kind, message, fields)
        with world._used() as simulation:
            publisher = world.graph.advertise(self.name, kind, node="World.hold", rate=rate)

            def publish() -> None:
                publisher.publish(made)

            alarm = Alarm(publish, simulation.time_ns, period)
            simulation.alarms.add(alarm)
        return Hold(self.name, alarm, publisher.close)

    def close(self) -> None:
        """Ends the subscription. The messages stay readable."""
        self._subscription.close()
        resets = self._world.session.simulation.on_reset
        if self._received.rewind in resets:
            resets.remove(self._received.rewind)
        self._world._forget_topic(self)


class Hold:
    """A message that is published at a rate; see `Topic.hold`."""

    def __init__(self, topic: str, alarm: Alarm, close: Callable[[], None]) -> None:
        self._topic = topic
        self._alarm = alarm
        self._close = close

    def __repr__(self) -> str:
        return f"<Hold of {self._topic}: {'active' if self.active else 'ended'}>"

    @property
    def active(self) -> bool:
        """Whether the message is still published."""
        return self._alarm.pending

    def stop(self) -> None:
        """Ends the publishing. Does nothing if it has ended."""
        if self._alarm.pending:
            self._alarm.cancel()
            self._close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()
