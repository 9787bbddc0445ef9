"""Cartwheel simulates the robot you described.

>>> import cartwheel as cw
>>> world = cw.World("empty")
>>> cart = world.spawn("rosbots.xacro")
>>> cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
>>> world.run(seconds=5)
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from cartwheel.errors import CartwheelError, TimedOutError

if TYPE_CHECKING:
    from cartwheel.api import (
        Acceleration,
        ActionServer,
        Built,
        Clearance,
        Contact,
        ContactRecord,
        Fault,
        Gains,
        Goal,
        Hit,
        Hold,
        Joint,
        Joints,
        JointValues,
        Light,
        Link,
        Lockstep,
        Mailbox,
        Model,
        Picture,
        Plot,
        Publisher,
        ReceivedGoal,
        RecordedContact,
        RecordedMessage,
        Recording,
        RobotDescription,
        ServiceServer,
        Stamp,
        State,
        Subscription,
        Timer,
        Topic,
        Twist,
        World,
        WorldDescription,
        build,
        launch,
        seconds,
    )
    from cartwheel.arrays import (
        Scan,
        camera_matrix,
        cloud,
        depth,
        image,
        project,
        scan,
        unproject,
    )
    from cartwheel.checks import check
    from cartwheel.geometry import Pose
    from cartwheel.sweeps import sweep

_PACKAGES = {"Pose": "geometry", "check": "checks", "sweep": "sweeps"} | dict.fromkeys(
    ("Scan", "camera_matrix", "cloud", "depth", "image", "project", "scan", "unproject"), "arrays"
)
"""Where the names are that are not in `cartwheel.api`."""

__all__ = [
    "Acceleration",
    "ActionServer",
    "Built",
    "CartwheelError",
    "Clearance",
    "Contact",
    "ContactRecord",
    "Fault",
    "Gains",
    "Goal",
    "Hit",
    "Hold",
    "Joint",
    "JointValues",
    "Joints",
    "Light",
    "Link",
    "Lockstep",
    "Mailbox",
    "Model",
    "Picture",
    "Plot",
    "Pose",
    "Publisher",
    "ReceivedGoal",
    "RecordedContact",
    "RecordedMessage",
    "Recording",
    "RobotDescription",
    "Scan",
    "ServiceServer",
    "Stamp",
    "State",
    "Subscription",
    "TimedOutError",
    "Timer",
    "Topic",
    "Twist",
    "World",
    "WorldDescription",
    "build",
    "camera_matrix",
    "check",
    "cloud",
    "depth",
    "image",
    "launch",
    "project",
    "scan",
    "seconds",
    "sweep",
    "unproject",
]
__version__ = "0.1.0"


def load_ipython_extension(shell: Any) -> None:
    """Implements ``%load_ext cartwheel``."""
    from cartwheel.api.notebook import extend

    extend(shell)


def __dir__() -> list[str]:
    """For completion in notebooks and shells, which know only what has been imported."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})


def __getattr__(name: str) -> Any:
    # The import of numpy and the physics engine takes 0.1 s, but the command line must first parse
    # its arguments and handle Ctrl-C.
    if name not in __all__:
        raise AttributeError(name)
    return getattr(importlib.import_module(f"cartwheel.{_PACKAGES.get(name, 'api')}"), name)
