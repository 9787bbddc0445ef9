"""The supported controller types."""

from __future__ import annotations

import functools
import importlib
from pathlib import Path

from cartwheel.codes import devices
from cartwheel.description.files.plugin_xml import exporting_file
from cartwheel.dialects.generated import CONTROLLERS
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.errors import UnknownNameError
from cartwheel.similar_names import LONGEST, meant_one

ACKERMANN = "ackermann_steering_controller/AckermannSteeringController"
_MISSPELT = 0.85
"""Minimum similarity of the name of a misspelt package to the correct one."""


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


def find_type(name: str, *, ros2: bool, file: str = "") -> type[Controller]:
    """Returns the class of a controller type. The C++ spelling ``a::B`` is read as ``a/B``.

    Args:
        name: The type.
        ros2: Whether it is a type of ROS 2.
        file: A file of the repository, which may define controllers of its own.

    Raises:
        UnknownNameError: The type is not supported.
    """
    known = controller_types()
    plain = name.strip().replace("::", "/")
    if not ros2 and plain == ACKERMANN:
        # ROS 1 and ROS 2 use this name for two different controllers.
        from cartwheel.dialects.ros_control.controllers.steer_drive import SteerDriveController

        return SteerDriveController
    if plain in known:
        return known[plain]
    code = devices.CONTROLLER_TYPE_UNKNOWN
    shown = name.strip()[:LONGEST]
    exporting = exporting_file(Path(file), plain) if file else None
    if exporting is not None:
        message = f'controller type "{shown}", which "{exporting.name}" exports, is not supported'
        raise UnknownNameError("controller type", name, (), code=code, message=message)
    if "/" in plain and not _is_misspelt(
        plain.partition("/")[0], {each.partition("/")[0] for each in known}
    ):
        # The package may be anyone's.
        message = f'controller type "{shown}" is not supported'
        raise UnknownNameError("controller type", name, (), code=code, message=message)
    raise UnknownNameError("controller type", name, known, code=code)


def _is_misspelt(package: str, known: set[str]) -> bool:
    """Whether the package of a controller type is a known one, or is misspelt."""
    words = package.count("_")
    alike = {each for each in known if each.count("_") == words}
    return package in known or bool(meant_one(package, alike, cutoff=_MISSPELT))
