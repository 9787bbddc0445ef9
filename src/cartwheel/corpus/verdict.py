"""The results of testing a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cartwheel.corpus.faults import MOTION, Fault, Test
from cartwheel.description.launches import LaunchUse
from cartwheel.errors import Diagnostic

TOLERANCE = 0.05
"""Relative tolerance of a commanded velocity."""
SUNK = 0.02
"""m, or a part of the robot's size if it is longer than 1 m; maximum settling of a standing robot,
for springs, soft tyres and casters that are lower than the wheels."""
TILTED = 0.1
"""rad; maximum tilt."""
RISEN = 0.2
"""m; minimum increase in height of an aircraft that takes off."""
_DEEP = 1.0
"""m; least way by which a vehicle in water sinks that is too heavy for it."""
CREEPING = 0.01
"""m/s and rad/s; maximum motion of a standing robot."""
MOVED = 0.1
"""Smallest part of the commanded way or speed at which a joint moves."""
ANGLE, LENGTH = 0.1, 0.01
"""rad and m; maximum error of a joint position: a PID with effort output yields to gravity."""
SHORT = 0.5
"""The same relative to the way, which limits shorten."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stand:
    """How a robot stood without commands."""

    fixed: bool
    """Whether it is fixed to the world, or static."""
    simulated: float
    """Simulation time, s."""
    wall: float
    """Wall time without subscribers, s."""
    sunk: float
    """Decrease in the root's height, m; negative if it rose."""
    tilt: float
    """Angle between the root's initial and final upward axes, rad."""
    speed: float
    """The root's speed during the last second, m/s."""
    turn: float
    """The root's angular speed during the last second, rad/s."""
    size: float = 0.0
    """Longest edge of the robot's bounding box, m."""
    floats: bool = False
    """Whether it was tested in water, where it need not stand."""
    heavy: bool = False
    """Whether it weighs much more than the water that it displaces."""
    settled: float | None = None
    """Decrease in height of the lowest collision, m, if all links had moved with the root; None for
    `sunk`. A long robot that tilts a little until it rests on another part lowers its root, but not
    this, unlike one whose legs give way."""

    @property
    def state(self) -> str:
        """``fixed``, ``floats``, ``yes``, or what the robot did instead."""
        if self.fixed:
            return "fixed"
        if self.floats:
            return "sinks" if self.heavy and self.sunk > max(_DEEP, self.size) else "floats"
        if self.speed > CREEPING or self.turn > CREEPING:
            return "moves"
        if self.tilt > TILTED:
            return "tips"
        lowered = self.sunk if self.settled is None else self.settled
        if abs(lowered) > SUNK * max(1.0, self.size):
            return "sinks" if lowered > 0 else "rises"
        return "yes"


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """How a base followed the commands on one topic."""

    topic: str
    commanded: float
    """Commanded forward speed, m/s."""
    measured: float
    commanded_turn: float
    """Separately commanded turn rate about the vertical, rad/s."""
    measured_turn: float
    commanded_sideways: float = 0.0
    """Separately commanded speed to the left, m/s; 0 if the base cannot move sideways."""
    measured_sideways: float = 0.0
    turning: Literal["in place", "arc"] = "in place"
    """How it was commanded to turn: steered bases turn on an arc, while they drive forward."""
    limited: bool = False
    """Whether limits in the robot's files are below the usual commands, which were reduced."""
    sag: float = 0.0
    """Relative error of the speed that follows from drag and the gains of a multicopter, or from
    the friction of a base without wheels."""
    sag_turn: float = 0.0
    """The same for the turn rate."""

    @property
    def error(self) -> float:
        """Relative error of the speed; negative if too slow."""
        return self.measured / self.commanded - 1.0

    @property
    def error_turn(self) -> float:
        """Relative error of the turn rate."""
        return self.measured_turn / self.commanded_turn - 1.0

    @property
    def error_sideways(self) -> float:
        """Relative error of the speed to the left; 0 if it was not commanded."""
        if not self.commanded_sideways:
            return 0.0
        return self.measured_sideways / self.commanded_sideways - 1.0

    @property
    def passes(self) -> bool:
        """Whether it moved as commanded in all directions."""
        return self.follows and self.turns and self.slides

    @property
    def slides(self) -> bool:
        """Whether it moved sideways as commanded, if it can."""
        return -self.sag - TOLERANCE <= self.error_sideways <= TOLERANCE

    @property
    def follows(self) -> bool:
        """Whether it moved forward as commanded."""
        return -self.sag - TOLERANCE <= self.error <= TOLERANCE

    @property
    def turns(self) -> bool:
        """Whether it turned as commanded."""
        return -self.sag_turn - TOLERANCE <= self.error_turn <= TOLERANCE


@dataclass(frozen=True, kw_only=True, slots=True)
class Reach:
    """The final position of a joint commanded by a controller."""

    controller: str
    joint: str
    target: float
    """rad or m."""
    reached: float
    angular: bool
    start: float | None = None
    """Where it was commanded, rad or m; None if this is unknown."""
    sag: float = 0.0
    """Error that follows from gravity, friction and the controller's own gains, rad or m: the load
    and the friction divided by the proportional gain of a PID controller with an effort output,
    whose integral is 0 or takes more than 5 s."""

    @property
    def error(self) -> float:
        """Position error, rad or m."""
        return self.reached - self.target

    @property
    def moved(self) -> bool:
        """Whether it left the position at which it was commanded to move."""
        if self.start is None:
            return True
        return abs(self.reached - self.start) >= MOVED * abs(self.target - self.start)

    @property
    def arrived(self) -> bool:
        """Whether it moved, with a small error.

        If limits shorten the way, this is a larger part of it where gravity and the gains explain
        the error.
        """
        return self._follows and abs(self.error) <= self._longest

    @property
    def sags(self) -> bool:
        """Whether it moved, with a large error that follows from gravity and the gains."""
        return self._follows and not self.arrived

    @property
    def _follows(self) -> bool:
        return self.moved and abs(self.error) <= self.limit + self.sag

    @property
    def limit(self) -> float:
        """Maximum error without a load, rad or m."""
        if self.start is None:
            return self._longest
        # Half of a way of 0.2 rad is not exactly 0.1 rad.
        return min(self._longest, SHORT * abs(self.target - self.start) * (1.0 + 1e-9))

    @property
    def _longest(self) -> float:
        return ANGLE if self.angular else LENGTH


@dataclass(frozen=True, kw_only=True, slots=True)
class Spin:
    """How a joint followed a velocity or effort command of a controller or plugin."""

    topic: str
    joint: str
    """The joint that moved most; empty if none moved."""
    commanded: float
    """rad/s or m/s; the effort in N m or N for effort controllers."""
    measured: float
    """Velocity of the joint, rad/s or m/s."""
    effort: bool
    """Whether the command is an effort, so that any motion is a success."""
    sag: float = 0.0
    """Error that follows from gravity, friction, damping and the controller's own gains, rad/s or
    m/s; see `Reach.sag`."""

    @property
    def follows(self) -> bool:
        """Whether the joint moved as commanded."""
        if self.effort:
            return self.measured * self.commanded > 0
        if self.measured * self.commanded < MOVED * self.commanded**2:
            return False
        return abs(self.measured - self.commanded) <= TOLERANCE * abs(self.commanded) + self.sag


@dataclass(frozen=True, kw_only=True, slots=True)
class Flight:
    """How an aircraft followed the commands to its propellers."""

    topic: str
    motors: int
    command: float
    """Speed of the propellers at which it rose, rad/s; otherwise the highest speed that was
    tried."""
    rose: float
    """Increase in height, or the way in the direction of thrust if no propeller lifts, m."""

    @property
    def flies(self) -> bool:
        """Whether it took off."""
        return self.rose >= RISEN


Outcome = Literal["good", "file", "unknown"]
"""- ``good``: the robot loads, stands, and moves as commanded.
- ``file``: every fault is explained by a mistake in the robot's files, or at least one of them
  whatever the causes of the others are; see `Fault.decides`.
- ``unknown``: the cause of a fault is unknown, or Cartwheel does not support something.
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Verdict:
    """The results for one description."""

    file: Path
    model: str = ""
    """Name of the tested model of a world; empty if the file is not a world."""
    name: str = ""
    error: str = ""
    """Why loading or the simulation failed; empty for success."""
    failure: Diagnostic | None = None
    """The error as a diagnostic."""
    loaded: bool = False
    mass: float = math.nan
    """Mass, kg."""
    links: int = 0
    missing_meshes: int = 0
    plugins: tuple[str, ...] = ()
    """Supported plugins, without path, ``lib`` and ``.so``."""
    missing: tuple[str, ...] = ()
    """Unsupported plugins."""
    controllers: tuple[str, ...] = ()
    """Controllers that ran."""
    spawned: tuple[str, ...] = ()
    """Controllers that a launch file starts."""
    controller_files: tuple[Path, ...] = ()
    """Files that started the controllers, if the robot does not specify any."""
    stand: Stand | None = None
    topics: int = 0
    """Number of topics with a stated rate."""
    silent: tuple[str, ...] = ()
    """Those topics without messages."""
    drives: tuple[Drive, ...] = ()
    reaches: tuple[Reach, ...] = ()
    spins: tuple[Spin, ...] = ()
    flights: tuple[Flight, ...] = ()
    movers: tuple[str, ...] = ()
    """Plugins and controllers, supported or not, that should move the robot or its joints."""
    faults: tuple[Fault, ...] = ()
    """What failed, with reasons."""
    launch: LaunchUse | None = None
    """The launch file whose arguments were used."""
    diagnostics: tuple[Diagnostic, ...] = ()
    driven: frozenset[str] = frozenset()
    """Joints that plugins and controllers drive."""
    hindered: frozenset[tuple[Test, str]] = frozenset()
    """The failed tests, each with topic or joint, whose error changes if only one of two plugins
    drives the joints."""
    observed: tuple[Diagnostic, ...] = ()
    """Reasons for failures that were seen in the simulation, or in the files of launch files."""
    unread: tuple[Diagnostic, ...] = ()
    """What was not read of the launch files of the robot's author."""

    @property
    def speed(self) -> float:
        """Real-time factor without subscribers; nan if nothing was simulated."""
        return self.stand.simulated / self.stand.wall if self.stand is not None else math.nan

    @property
    def should_move(self) -> bool:
        """Whether a plugin or controller should move the robot or its joints."""
        return bool(self.movers) or any(fault.test in MOTION for fault in self.faults)

    @property
    def moves(self) -> bool:
        """Whether everything that should move was moved by commands, and moved as commanded.

        A robot that only Cartwheel loads does not.
        """
        return bool(self.drives or self.reaches or self.spins or self.flights) and not any(
            fault.test in MOTION or (fault.test == "load" and fault.source == "file")
            for fault in self.faults
        )

    @property
    def passes(self) -> bool:
        """Whether commands moved it, and all measurements were as expected."""
        moved = (
            *(drive.passes for drive in self.drives),
            *(reach.arrived for reach in self.reaches),
            *(spin.follows for spin in self.spins),
            *(flight.flies for flight in self.flights),
        )
        whole = self.failure is None and self.stands and not self.silent
        return whole and bool(moved) and all(moved)

    @property
    def stands(self) -> bool:
        """Whether it stands, floats, or is fixed to the world."""
        return self.stand is not None and self.stand.state in ("fixed", "floats", "yes")

    @property
    def outcome(self) -> Outcome:
        """The overall result."""
        if not self.faults:
            return "good"
        hidden = any(fault.hides for fault in self.faults)
        if not hidden and any(fault.decides for fault in self.faults):
            return "file"
        return "file" if all(fault.source == "file" for fault in self.faults) else "unknown"

    @property
    def good(self) -> bool:
        """Whether it loads, stands, publishes, and moves as commanded."""
        return self.outcome == "good"
