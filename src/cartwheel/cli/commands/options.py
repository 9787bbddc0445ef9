"""The options of a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.assembly.plan import Plan


@dataclass(frozen=True, kw_only=True, slots=True)
class Options:
    """The user's options."""

    file: str | None = None
    values: Mapping[str, str]
    """Values of ``name:=value`` arguments."""
    world: str | None = None
    headless: bool = False
    speed: float | None = 1.0
    """Real-time factor; None is as fast as possible."""
    seconds: float | None = None
    """Simulation time; None is unlimited."""
    steps: int | None = None
    """Number of steps, instead of `seconds`."""
    paused: bool = False
    seed: int = 0
    strict: bool = False
    without: tuple[str, ...] = ()
    """Physics that Cartwheel adds to descriptions, to be omitted."""
    host: str = "127.0.0.1"
    allow_origin: tuple[str, ...] = ()
    port: int = 8080
    open_browser: bool | None = None
    place: Mapping[str, float] = field(default_factory=dict)
    """Some of x, y, z, roll, pitch, yaw."""
    model: str | None = None
    package_path: tuple[Path, ...] = ()
    allow_path: tuple[Path, ...] = ()
    """Folders with files that clients may access."""
    controllers: tuple[Path, ...] = ()
    """YAML files whose controllers are started."""
    plugins: tuple[Path, ...] = ()
    """Python files that define plugins."""
    bridge: tuple[Path, ...] = ()
    """Configuration files of ros_gz_bridge."""
    plan: Plan = field(default_factory=Plan)
    """ROS, Foxglove and recordings."""
    verbose: bool = False
