"""Faults of sensors and of communication: messages that are lost, late, frozen or wrong."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from cartwheel import arrays
from cartwheel.api.arguments import refused, several
from cartwheel.api.exchange.transforms import FramedWorld
from cartwheel.api.handles import Sealed
from cartwheel.api.values import scalar
from cartwheel.arrays.fields import with_changed
from cartwheel.codes.graph import DELAYED_LOST
from cartwheel.errors import GraphError
from cartwheel.geometry import Array
from cartwheel.graph.interception import Interception
from cartwheel.graph.topic import checked_message
from cartwheel.messages import zero
from cartwheel.messages.fields import fields
from cartwheel.simulation.alarms import Alarm
from cartwheel.simulation.limits import duration_ns
from cartwheel.simulation.random_numbers import RandomNumbers

if TYPE_CHECKING:
    from cartwheel.graph.topic import Callback
    from cartwheel.simulation import Simulation

_MOST_LATE, _MOST_BYTES = 10_000, 256_000_000
"""Maximum number and size of the messages of a topic that are late at the same time."""
Numbers = Mapping[str, float]
"""Fields of a message, such as ``linear_acceleration.x`` or ``ranges``, and a number for each."""


class FaultyWorld(FramedWorld):
    """The part of `World` with faults."""

    _faults: tuple[Fault, ...] = ()

    def fault(
        self,
        topics: str | Sequence[str],
        *,
        drop: float = 0.0,
        delay: float = 0.0,
        frozen: bool = False,
        noise: Numbers | None = None,
        bias: Numbers | None = None,
        change: Callable[[Any], Any] | None = None,
    ) -> Fault:
        """Disturbs the messages of topics from now on: sensors, commands or anything else.

        All subscribers receive the disturbed messages, also recordings and ROS. The fault ends with
        `Fault.end` or with a ``with`` block. The arguments are attributes of the result, which can
        be changed at any time. Random numbers depend on the seed of the world and on the time.

        Args:
            topics: Names of existing topics. Several have the same fault, such as an image and its
                camera_info.
            drop: Share of the messages that are lost, from 0 to 1; 1 switches a sensor off.
            delay: Time by which messages are late, s. Their stamps are unchanged. At most 10,000
                messages of a topic, and 256 MB, are late at the same time; further ones are lost
                (CW739).
            frozen: Repeat the first message of the fault, with new stamps.
            noise: Standard deviation of additional Gaussian noise, for fields with a number or an
                array of numbers, named as for `Topic.values`.
            bias: Numbers that are added to fields.
            change: Receives a copy of each message before all other changes, and returns the
                message to be delivered, which may be this copy, or None for none. `run` raises its
                errors, and refuses a message as `publish` does (CW712).

        Raises:
            UnknownNameError: A topic does not exist.
            GraphError: The messages do not have a field, or it does not contain numbers.
            CartwheelError: A number is out of range.
            SimulationError: The world is closed.
        """
        with self._used() as simulation:
            infos = map(self.graph.topic, several(topics, "topics"))
            types = {each.name: each.type for each in infos}
            made = Fault(
                simulation,
                list(types.items()),
                drop=drop,
                delay=delay,
                frozen=frozen,
                noise=noise or {},
                bias=bias or {},
                change=change,
            )
            made.begin([Interception(self.graph, name, made.receiver(name)) for name in types])
            self._faults = (*self.faults, made)
            return made

    @property
    def faults(self) -> tuple[Fault, ...]:
        """The faults that have not ended."""
        return tuple(each for each in self._faults if each.active)

    def _left_out(self) -> Iterator[str]:
        for each in self.faults:
            yield f"fault of {', '.join(each.topics)}"


class Fault(Sealed):
    """A fault of topics, which `World.fault` returns. Its attributes can be changed."""

    __slots__ = (
        "_bias", "_change", "_delay_ns", "_drop", "_frozen", "_full", "_interceptions", "_kept",
        "_late", "_noise", "_random", "_rewinds", "_simulation", "_topics",
    )  # fmt: skip

    def __init__(
        self,
        simulation: Simulation,
        topics: Sequence[tuple[str, str]],
        *,
        drop: float,
        delay: float,
        frozen: bool,
        noise: Numbers,
        bias: Numbers,
        change: Callable[[Any], Any] | None,
    ) -> None:
        self._simulation = simulation
        self._topics = tuple(topics)
        self._interceptions: list[Interception] = []
        self._kept: dict[str, Any] = {}
        """The message that is repeated, by topic."""
        self._late: dict[str, _Held] = {}
        """Late messages by topic."""
        self._full: set[str] = set()
        """Topics of which messages were lost because too many are late."""
        self._rewinds = simulation.engine.rewinds
        self._random = RandomNumbers("fault")
        self.drop, self.delay, self.frozen = drop, delay, frozen
        self.noise, self.bias, self.change = noise, bias, change

    def __repr__(self) -> str:
        return f"<Fault of {', '.join(self.topics)}{'' if self.active else ', ended'}>"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.end()

    def begin(self, interceptions: Sequence[Interception]) -> None:
        """Continues with the interceptions of its topics."""
        self._interceptions += interceptions

    def end(self) -> None:
        """Ends the fault. Late messages are still delivered."""
        for each in self._interceptions:
            each.close()
        self._interceptions.clear()

    @property
    def active(self) -> bool:
        """Whether it has not ended."""
        return bool(self._interceptions)

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of its topics."""
        return tuple(name for name, _ in self._topics)

    @property
    def drop(self) -> float:
        """Share of the messages that are lost, from 0 to 1."""
        return self._drop

    @drop.setter
    def drop(self, share: float) -> None:
        self._drop = scalar(share, "drop", least=0.0, most=1.0)

    @property
    def delay(self) -> float:
        """Time by which messages are late, s."""
        return self._delay_ns / 1e9

    @delay.setter
    def delay(self, seconds: float) -> None:
        self._delay_ns = duration_ns(scalar(seconds, "delay", least=0.0), "the delay in s")

    @property
    def frozen(self) -> bool:
        """Whether one message is repeated, with new stamps."""
        return self._frozen

    @frozen.setter
    def frozen(self, frozen: bool) -> None:
        if not isinstance(frozen, bool):
            raise refused("frozen", "True or False", frozen)
        self._frozen = frozen
        if not frozen:
            self._kept.clear()

    @property
    def noise(self) -> Numbers:
        """Standard deviations of additional noise, by field."""
        return self._noise

    @noise.setter
    def noise(self, noise: Numbers) -> None:
        self._noise = self._numbers(noise, "noise", least=0.0)

    @property
    def bias(self) -> Numbers:
        """Numbers that are added, by field."""
        return self._bias

    @bias.setter
    def bias(self, bias: Numbers) -> None:
        self._bias = self._numbers(bias, "bias")

    @property
    def change(self) -> Callable[[Any], Any] | None:
        """A function that returns the message to be delivered, or None."""
        return self._change

    @change.setter
    def change(self, change: Callable[[Any], Any] | None) -> None:
        if change is not None and not callable(change):
            raise refused("change", "a function or None", change)
        self._change = change

    def receiver(self, topic: str) -> Callable[[Any, Callback], None]:
        """A function that disturbs the messages of a topic, for an `Interception`."""

        def receive(message: Any, pass_on: Callback) -> None:
            try:
                disturbed = self._disturbed(topic, message)
            except BaseException as error:  # noqa: BLE001 - raised by `run`
                self._simulation.faults.defer(error)
                return
            if disturbed is None:
                return
            if not self._delay_ns:
                pass_on(disturbed)
                return
            due = self._simulation.time_ns + self._delay_ns
            late = _Late(self, topic, disturbed, pass_on, due)
            if self._holds(late):
                self._simulation.alarms.add(late)

        return receive

    def _holds(self, late: _Late) -> bool:
        """Whether a late message is held; otherwise it is lost, which is reported once."""
        held = self._late.setdefault(late.topic, _Held())
        if held.messages < _MOST_LATE and held.size + late.size <= _MOST_BYTES:
            held.add(late)
            return True
        if late.topic not in self._full:
            self._full.add(late.topic)
            values: dict[str, str | float] = {
                "topic": late.topic,
                "delay": self.delay,
                "messages": held.messages,
            }
            self._simulation.engine.report(
                DELAYED_LOST.diagnostic(
                    f"messages of {late.topic} are lost: a fault delays them by {self.delay:g} s, "
                    f"and holds at most {_MOST_LATE} messages and {_MOST_BYTES / 1e6:g} MB",
                    hint="Use a shorter delay.",
                    values=values,
                )
            )
        return False

    def release(self, late: _Late) -> None:
        """Called when a late message is delivered."""
        self._late.setdefault(late.topic, _Held()).add(late, -1)

    def _disturbed(self, topic: str, message: Any) -> Any:
        """The message that is delivered; None if it is lost."""
        if self._rewinds != self._simulation.engine.rewinds:
            self._rewinds = self._simulation.engine.rewinds
            self._kept.clear()
            # Those of a saved state are late again.
            self._late = {}
            for each in self._simulation.alarms.pending:
                if isinstance(each, _Late) and each.fault is self:
                    self._late.setdefault(each.topic, _Held()).add(each)
        if self._change is not None:
            message = self._changed(topic, self._change(copy.deepcopy(message)))
            if message is None:
                return None
        if self._frozen:
            kept = self._kept.setdefault(topic, message)
            message = _restamped(kept, message)
        if self._drop and self._generator(f"{topic} drop").random() < self._drop:
            return None
        for field, bias in self._bias.items():
            message = with_changed(message, field, partial(np.add, bias))
        for field, deviation in self._noise.items():
            generator = self._generator(f"{topic} {field}")
            message = with_changed(message, field, partial(_noisy, generator, deviation))
        return message

    def _changed(self, topic: str, message: Any) -> Any:
        """What `change` has returned, as a message of the topic.

        Raises:
            GraphError: It is no such message, or a value in it does not fit its field.
        """
        if message is None:
            return None
        try:
            return checked_message(topic, dict(self._topics)[topic], message)
        except GraphError as error:
            error.message = f"the fault of {topic} returns an invalid message: {error.message}"
            raise

    def _generator(self, purpose: str) -> np.random.Generator:
        engine = self._simulation.engine
        return self._random.at(purpose, seed=engine.seed, time_ns=engine.time_ns)

    def _numbers(self, given: Numbers, name: str, **limits: float) -> Numbers:
        if not isinstance(given, Mapping):
            raise refused(name, "a mapping of fields to numbers", given)
        for field in given:
            for _, kind in self._topics:
                arrays.values((zero(kind),), field)
        return {
            field: scalar(number, f"{name} of {field}", **limits) for field, number in given.items()
        }


class _Late(Alarm):
    """A message of a fault that is late.

    Args:
        fault: The fault.
        topic: The topic.
        message: The message.
        pass_on: Delivers it.
        due_ns: When it is delivered.
    """

    def __init__(
        self, fault: Fault, topic: str, message: Any, pass_on: Callback, due_ns: int
    ) -> None:
        super().__init__(self._deliver, due_ns)
        self._message, self._pass_on = message, pass_on
        self.fault, self.topic = fault, topic
        values = (getattr(message, field.name) for field in fields(message.__msgtype__))
        self.size = sum(getattr(each, "nbytes", 0) for each in values)
        """Size of its arrays, bytes."""

    def _deliver(self) -> None:
        self.fault.release(self)
        self._pass_on(self._message)


@dataclass(slots=True)
class _Held:
    """Number and size of the messages of a topic that are late at the same time."""

    messages: int = 0
    size: int = 0

    def add(self, late: _Late, sign: int = 1) -> None:
        """Counts a message, or with the sign -1 no longer."""
        self.messages += sign
        self.size += sign * late.size


def _noisy(generator: np.random.Generator, deviation: float, numbers: Array) -> Array:
    return numbers + generator.normal(0.0, deviation, numbers.shape)


def _restamped(message: Any, current: Any) -> Any:
    """A message with the header's stamp of another one."""
    if message is current or not hasattr(current, "header"):
        return message
    made = copy.copy(message)
    made.header = copy.copy(made.header)
    made.header.stamp = current.header.stamp
    return made
