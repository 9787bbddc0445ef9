"""The supported controller types."""

from __future__ import annotations

import functools
import importlib

from cartwheel.codes import devices
from cartwheel.dialects.generated import CONTROLLERS
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.errors import UnknownNameError

ACKERMANN = "ackermann_steering_controller/AckermannSteeringController"


@functools.cache
def controller_types() -> dict[str, type[Controller]]:
    """Returns all controller types by name, in the spellings of ROS 1 and ROS 2."""
    return {
        name: each
        for module in sorted(set(CONTROLLERS.values()))
        for each in vars(importlib.import_module(f"cartwheel.dialects.{module}")).values()
        if isinstance(each, type) and issubclass(each, Controller)
        for name in vars(each).get("types", ())
    }


def find_type(name: str, *, ros2: bool) -> type[Controller]:
    """Returns the class of a controller type. The C++ spelling ``a::B`` is read as ``a/B``.

    Raises:
        UnknownNameError: The type is not supported.
    """
    known = controller_types()
    plain = name.strip().replace("::", "/")
    if not ros2 and plain == ACKERMANN:
        # ROS 1 and ROS 2 use this name for two different controllers.
        from cartwheel.dialects.ros_control.controllers.steer_drive import SteerDriveController

        return SteerDriveController
    if plain not in known:
        raise UnknownNameError("controller type", name, known, code=devices.CONTROLLER_TYPE_UNKNOWN)
    return known[plain]
