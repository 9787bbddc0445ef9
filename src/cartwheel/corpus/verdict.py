"""What a trial of a robot found."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from cartwheel.errors import Diagnostic

TOLERANCE = 0.05
"""Of a commanded velocity."""
SUNK = 0.02
"""m that a robot may sit lower after a while than it was put: springs and soft tyres."""
TILTED = 0.1
"""rad that it may lean."""
CREEPING = 0.01
"""m/s and rad/s of a robot that stands."""
ANGLE, LENGTH = 0.1, 0.01
"""rad and m that a joint may be off what was commanded: a PID on efforts gives way to gravity."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stand:
    """How a robot stood while nobody commanded it."""

    fixed: bool
    """It is held by the world, or static."""
    simulated: float
    """s that were."""
    wall: float
    """s that it took, while nobody listened."""
    sunk: float
    """m that its root is lower in the end than it was put; negative is higher."""
    tilt: float
    """rad between its root's upward axis then and now."""
    speed: float
    """m/s of its root during the last second."""
    turn: float
    """rad/s of the same."""

    @property
    def state(self) -> str:
        """``fixed``, ``yes``, or what it did instead."""
        if self.fixed:
            return "fixed"
        if self.speed > CREEPING or self.turn > CREEPING:
            return "moves"
        if self.tilt > TILTED:
            return "tips"
        if abs(self.sunk) > SUNK:
            return "sinks" if self.sunk > 0 else "rises"
        return "yes"


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """How a base did what one topic commanded."""

    topic: str
    commanded: float
    """m/s ahead."""
    measured: float
    commanded_turn: float
    """rad/s about the vertical, commanded by itself."""
    measured_turn: float

    @property
    def error(self) -> float:
        """Share by which it went too fast; negative is too slow."""
        return self.measured / self.commanded - 1.0

    @property
    def error_turn(self) -> float:
        """The same of its turning: -1 is a base that does not turn where it stands."""
        return self.measured_turn / self.commanded_turn - 1.0

    @property
    def follows(self) -> bool:
        """Whether it went ahead as commanded."""
        return abs(self.error) <= TOLERANCE

    @property
    def turns(self) -> bool:
        """Whether it turned as commanded where it stood, which not every base can."""
        return abs(self.error_turn) <= TOLERANCE


@dataclass(frozen=True, kw_only=True, slots=True)
class Reach:
    """Where a controller took a joint."""

    controller: str
    joint: str
    target: float
    """rad or m."""
    reached: float
    angular: bool

    @property
    def error(self) -> float:
        """rad or m."""
        return self.reached - self.target

    @property
    def arrived(self) -> bool:
        return abs(self.error) <= (ANGLE if self.angular else LENGTH)


@dataclass(frozen=True, kw_only=True, slots=True)
class Verdict:
    """What became of one description."""

    file: Path
    name: str = ""
    error: str = ""
    """Why it did not load, or why its simulation ended; empty where all went well."""
    loaded: bool = False
    mass: float = math.nan
    """kg."""
    links: int = 0
    missing_meshes: int = 0
    plugins: tuple[str, ...] = ()
    """Those it names that act, without path, ``lib`` and ``.so``."""
    missing: tuple[str, ...] = ()
    """Those it names that are not supported."""
    controllers: tuple[str, ...] = ()
    """That ran."""
    controller_files: tuple[Path, ...] = ()
    """That started them, where the robot does not name its own."""
    stand: Stand | None = None
    topics: int = 0
    """That state a rate."""
    silent: tuple[str, ...] = ()
    """Topics of those that carried nothing."""
    drives: tuple[Drive, ...] = ()
    reasons: tuple[str, ...] = ()
    """What the description says of its wheels that is not so, where it does not drive as told."""
    reaches: tuple[Reach, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def speed(self) -> float:
        """Simulated seconds in one of wall time, while nobody listened; nan where none were."""
        return self.stand.simulated / self.stand.wall if self.stand is not None else math.nan

    @property
    def good(self) -> bool:
        """Whether it loads and does what it should; a plugin that is missing does not count."""
        return (
            self.loaded
            and not self.error
            and self.stand is not None
            and self.stand.state in ("fixed", "yes")
            and not self.silent
            and all(drive.follows for drive in self.drives)
            and all(reach.arrived for reach in self.reaches)
        )
