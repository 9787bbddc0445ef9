"""What can be said of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal


@dataclass(frozen=True, kw_only=True, slots=True)
class Options:
    """What the user asked for."""

    file: str | None = None
    values: Mapping[str, str]
    """Of ``name:=value``."""
    world: str | None = None
    headless: bool = False
    speed: float | None = 1.0
    """Real-time factor; None is as fast as it can."""
    seconds: float | None = None
    """Of simulated time; None is endless."""
    steps: int | None = None
    """To make, instead of `seconds`."""
    paused: bool = False
    seed: int = 0
    strict: bool = False
    host: str = "127.0.0.1"
    allow_origin: tuple[str, ...] = ()
    port: int = 8080
    open_browser: bool | None = None
    place: Mapping[str, float] = field(default_factory=dict)
    """Some of x, y, z, roll, pitch, yaw."""
    model: str | None = None
    package_path: tuple[Path, ...] = ()
    allow_path: tuple[Path, ...] = ()
    """Folders whose files clients may name."""
    controllers: tuple[Path, ...] = ()
    """YAML files whose controllers start."""
    bridge: tuple[Path, ...] = ()
    """YAML files of ros_gz_bridge."""
    ros1_node: str | None = None
    """Name of the ROS 1 node; None is to be none."""
    ros1_arguments: tuple[str, ...] = ()
    ros2_node: str | None = None
    """Name of the ROS 2 node; None is to be none."""
    rmw: Literal["dds", "zenoh"] = "dds"
    record: tuple[Path, ...] = ()
    """Files or folders to record to."""
    record_topics: tuple[str, ...] = ()
    """Patterns; all topics where there are none."""
    record_encoding: str | None = None
    overwrite: bool = False
    foxglove_port: int | None = None
    """To serve Foxglove's protocol on; None is not to."""
    verbose: bool = False
