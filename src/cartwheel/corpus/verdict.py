"""The results of testing a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from cartwheel.errors import Diagnostic

TOLERANCE = 0.05
"""Relative tolerance of a commanded velocity."""
SUNK = 0.02
"""m; maximum settling of a standing robot, for springs and soft tyres."""
TILTED = 0.1
"""rad; maximum tilt."""
CREEPING = 0.01
"""m/s and rad/s; maximum motion of a standing robot."""
ANGLE, LENGTH = 0.1, 0.01
"""rad and m; maximum error of a joint position: a PID with effort output yields to gravity."""


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

    @property
    def state(self) -> str:
        """``fixed``, ``yes``, or what the robot did instead."""
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
    """How a base followed the commands on one topic."""

    topic: str
    commanded: float
    """Commanded forward speed, m/s."""
    measured: float
    commanded_turn: float
    """Separately commanded turn rate about the vertical, rad/s."""
    measured_turn: float

    @property
    def error(self) -> float:
        """Relative error of the speed; negative if too slow."""
        return self.measured / self.commanded - 1.0

    @property
    def error_turn(self) -> float:
        """Relative error of the turn rate; -1 for a base that cannot turn in place."""
        return self.measured_turn / self.commanded_turn - 1.0

    @property
    def follows(self) -> bool:
        """Whether it moved forward as commanded."""
        return abs(self.error) <= TOLERANCE

    @property
    def turns(self) -> bool:
        """Whether it turned in place as commanded, which not every base can do."""
        return abs(self.error_turn) <= TOLERANCE


@dataclass(frozen=True, kw_only=True, slots=True)
class Reach:
    """The final position of a joint commanded by a controller."""

    controller: str
    joint: str
    target: float
    """rad or m."""
    reached: float
    angular: bool

    @property
    def error(self) -> float:
        """Position error, rad or m."""
        return self.reached - self.target

    @property
    def arrived(self) -> bool:
        return abs(self.error) <= (ANGLE if self.angular else LENGTH)


@dataclass(frozen=True, kw_only=True, slots=True)
class Verdict:
    """The results for one description."""

    file: Path
    name: str = ""
    error: str = ""
    """Why loading or the simulation failed; empty for success."""
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
    controller_files: tuple[Path, ...] = ()
    """Files that started the controllers, if the robot does not specify any."""
    stand: Stand | None = None
    topics: int = 0
    """Number of topics with a stated rate."""
    silent: tuple[str, ...] = ()
    """Those topics without messages."""
    drives: tuple[Drive, ...] = ()
    reasons: tuple[str, ...] = ()
    """Wrong statements about the wheels that explain why the robot does not follow its commands."""
    reaches: tuple[Reach, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def speed(self) -> float:
        """Real-time factor without subscribers; nan if nothing was simulated."""
        return self.stand.simulated / self.stand.wall if self.stand is not None else math.nan

    @property
    def good(self) -> bool:
        """Whether it loads and works; missing plugins are ignored."""
        return (
            self.loaded
            and not self.error
            and self.stand is not None
            and self.stand.state in ("fixed", "yes")
            and not self.silent
            and all(drive.follows for drive in self.drives)
            and all(reach.arrived for reach in self.reaches)
        )
