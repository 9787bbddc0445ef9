"""Published robots for benchmarks, and what replaces them where they are missing."""

from __future__ import annotations

import os
from pathlib import Path

import cartwheel as cw
from benchmarks.sensors import carrying, scanner
from cartwheel.description import load_robot
from cartwheel.description.model import RobotDescription

_ROOT = Path(__file__).parents[1]
BURGER = "turtlebot3/turtlebot3_description/urdf/turtlebot3_burger.urdf.xacro"
_MIR = "mir_robot/mir_description/urdf/mir.urdf.xacro"
TWIST = "geometry_msgs/msg/Twist"


def corpus() -> Path | None:
    """The folder of published robots; None if it is missing."""
    folder = Path(os.environ.get("CARTWHEEL_CORPUS", _ROOT.parent / "shared" / "corpus"))
    return folder if folder.is_dir() else None


def with_laser() -> tuple[RobotDescription, str]:
    """A TurtleBot3 Burger, or else a cart with the same laser, and its name."""
    folder = corpus()
    if folder is not None:
        return load_robot(folder / BURGER), "burger"
    return carrying(scanner(columns=360, rate=5.0, reach=3.5)), "cart"


def with_two_lasers() -> RobotDescription | None:
    """A MiR 100 with its two scanners; None if it is missing."""
    folder = corpus()
    return None if folder is None else load_robot(folder / _MIR)


def command_topic(world: cw.World) -> str:
    """The first topic with velocity commands."""
    return next(
        topic.name for topic in world.graph.topics() if topic.subscribers and topic.type == TWIST
    )
