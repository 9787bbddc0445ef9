"""Contacts over a run: when models touched, and with which force."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Self

from cartwheel.geometry import Vec3
from cartwheel.simulation import Simulation
from cartwheel.simulation.clock import NANOSECONDS

if TYPE_CHECKING:
    from cartwheel.api.surroundings.contacts import Place as Collision

Place = tuple[str, str]
"""Names of a model and of a link in it."""
_NONE: Vec3 = (0.0, 0.0, 0.0)
_APART = 0.001
"""Distance between the surfaces beyond which a contact has ended, m. Source: the thickness of the
layer in which bodies touch in Gazebo with ODE, `contact_surface_layer`."""
_PAUSE_NS = 200_000_000
"""Time without a force after which a contact has ended, ns."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordedContact:
    """A period in which two links touched.

    Bodies that roll, or press lightly, bounce by some micrometres, so there are steps without a
    force. A contact has ended when the surfaces are more than 1 mm apart, or when there has been no
    force for 0.2 s. The forces of all points of contact between the two links are added.
    """

    models: tuple[str, str]
    """Names of the two models."""
    links: tuple[str, str]
    """Names of the two links in their models."""
    start: float
    """Simulation time of the first step with a force, s."""
    end: float | None
    """Simulation time of the step after the last one with a force, s; None until it has ended."""
    point: Vec3
    """Where they touched first, m, in the world."""
    peak_force: float
    """Largest force of a step, N."""
    peak_time: float
    """Simulation time of the largest force, s."""
    impulse: Vec3
    """Integral of the force on the first link until now, N s, in world axes."""


@dataclass(slots=True)
class _Open:
    """A contact that has not ended."""

    start_ns: int
    point: Vec3
    force: Vec3
    pause_ns: int | None = None
    """Time since which there is no force, ns; None while there is one."""
    peak: float = 0.0
    peak_ns: int = 0
    impulse: Vec3 = _NONE

    def add(self, force: Vec3, now_ns: int) -> None:
        self.force, self.pause_ns = force, None
        strength = math.hypot(*force)
        if strength > self.peak or not self.peak_ns:
            self.peak, self.peak_ns = strength, now_ns

    def last(self, seconds: float) -> None:
        """The force lasted for a time."""
        self.impulse = _plus(self.impulse, self.force, seconds)

    def pause(self, now_ns: int) -> None:
        """There is no force from now on."""
        if self.pause_ns is None:
            self.force, self.pause_ns = _NONE, now_ns

    def record(self, pair: tuple[Place, Place], end_ns: int | None) -> RecordedContact:
        (model, link), (with_model, with_link) = pair
        return RecordedContact(
            models=(model, with_model),
            links=(link, with_link),
            start=self.start_ns / NANOSECONDS,
            end=None if end_ns is None else end_ns / NANOSECONDS,
            point=self.point,
            peak_force=self.peak,
            peak_time=self.peak_ns / NANOSECONDS,
            impulse=self.impulse,
        )


class ContactRecord:
    """Contacts since `World.record_contacts`, observed in each step.

    It is true if there was a contact, so that it can be a condition of `World.run_until`. It ends
    with `close`, or with the ``with`` block.

    Args:
        simulation: The simulation.
        turns: Returns whether a contact of two collisions counts, with both turned; else None.
    """

    def __init__(
        self,
        simulation: Simulation,
        turns: Callable[[Collision, Collision], bool | None],
    ) -> None:
        self._simulation = simulation
        self._turns = turns
        self._over: list[tuple[int, RecordedContact]] = []
        """Contacts that have ended, with the number of their start."""
        self._open: dict[tuple[Place, Place], tuple[int, _Open]] = {}
        self._started = 0
        self._last_ns = simulation.time_ns
        self._rewinds = simulation.engine.rewinds
        self._task = simulation.schedule(0, after=self._sample)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<ContactRecord of {len(self)} contacts>"

    def __len__(self) -> int:
        return self._started

    def __iter__(self) -> Iterator[RecordedContact]:
        return iter(self.contacts)

    def close(self) -> None:
        """Ends the record. Contacts stay readable."""
        if self._task in self._simulation.population.world_tasks:
            self._simulation.unschedule(self._task)
            self._end([pair for pair, (_, each) in self._open.items() if each.pause_ns is not None])

    @property
    def contacts(self) -> tuple[RecordedContact, ...]:
        """The contacts so far, by their start."""
        ends = [*self._over]
        ends += [(number, each.record(pair, None)) for pair, (number, each) in self._open.items()]
        return tuple(contact for _, contact in sorted(ends, key=lambda each: each[0]))

    @property
    def first(self) -> RecordedContact | None:
        """The first contact; None without one."""
        return self.contacts[0] if self else None

    @property
    def peak_force(self) -> float:
        """The largest force of all contacts, N; 0 without one."""
        return max((each.peak_force for each in self.contacts), default=0.0)

    def _sample(self) -> None:
        """Observes the state from which the next step begins, whose forces act in this step."""
        simulation = self._simulation
        now_ns, rewinds = simulation.time_ns, simulation.engine.rewinds
        if rewinds != self._rewinds:
            # Time was set: all contacts have ended with the last state that was observed.
            self._rewinds = rewinds
            for _, lasting in self._open.values():
                lasting.pause(self._last_ns)
            self._end(list(self._open))
        else:
            seconds = (now_ns - self._last_ns) / NANOSECONDS
            for _, lasting in self._open.values():
                lasting.last(seconds)
        self._last_ns = now_ns
        forces: dict[tuple[Place, Place], tuple[Vec3, Vec3]] = {}
        turns = self._turns
        for each in simulation.truth.contacts(lambda one, two: turns(one, two) is not None):
            touch = each.turned() if turns(each.first, each.second) else each
            pair = touch.first[:2], touch.second[:2]
            point, force = forces.get(pair, (touch.point, _NONE))
            forces[pair] = point, _plus(force, touch.force, 1.0)
        for pair, (_, lasting) in self._open.items():
            if pair not in forces:
                lasting.pause(now_ns)
        self._end(
            [pair for pair in self._open if pair not in forces and self._is_over(pair, now_ns)]
        )
        for pair, (point, force) in forces.items():
            if pair not in self._open:
                self._open[pair] = self._started, _Open(now_ns, point, force)
                self._started += 1
            self._open[pair][1].add(force, now_ns)

    def _is_over(self, pair: tuple[Place, Place], now_ns: int) -> bool:
        """Whether a contact without a force has ended."""
        pause_ns = self._open[pair][1].pause_ns
        if pause_ns is None:
            return False
        return now_ns - pause_ns >= _PAUSE_NS or self._simulation.truth.shapes.are_apart(
            *pair, _APART
        )

    def _end(self, pairs: Sequence[tuple[Place, Place]]) -> None:
        for pair in pairs:
            number, each = self._open.pop(pair)
            self._over.append((number, each.record(pair, each.pause_ns)))


def _plus(one: Vec3, other: Vec3, factor: float) -> Vec3:
    return (
        one[0] + factor * other[0],
        one[1] + factor * other[1],
        one[2] + factor * other[2],
    )
