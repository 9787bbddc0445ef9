"""Files of ROS 2 from which a controller manager starts no controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.devices import CONTROLLERS_FILE_WITHOUT_CONTROLLERS
from cartwheel.description.elements.xml import shown_path
from cartwheel.dialects.ros_control.files import (
    Ros2File,
    controller_entries,
    misspelt_key,
    ros2_file,
)
from cartwheel.errors import Diagnostic, Origin


def without_controllers(
    merged: Ros2File,
    files: Sequence[tuple[Path, Mapping[str, Any]]],
    place: str,
    origin: Origin,
) -> Diagnostic | None:
    """Why files contain no controller for a manager; None if they do, or if there are none.

    Args:
        merged: The parameters in the files.
        files: The files, with their contents.
        place: The manager's namespace and name.
        origin: The manager.
    """
    if merged.elsewhere and not merged.manager:
        return CONTROLLERS_FILE_WITHOUT_CONTROLLERS.diagnostic(
            f"the controller files have parameters for {', '.join(merged.elsewhere)}, but the "
            f'controller manager is "/{place}", so no controller starts'.replace("//", "/"),
            origin=origin,
            values={"nodes": tuple(merged.elsewhere)},
        )
    if not files or merged.elsewhere or controller_entries(merged, "", ""):
        return None
    source = ", ".join(shown_path(path) for path, _ in files)
    message, at = "no parameter specifies a controller type", Origin(file=source)
    found = ((path, misspelt_key(each)) for path, each in files)
    path, key = next((each for each in found if each[1]), (None, ""))
    if path is not None:
        message = f'ROS 2 refuses the file, because "{key}" is not "ros__parameters"'
        lines = yaml_text.read(path).splitlines()
        named = (number for number, line in enumerate(lines, 1) if _begins(line, key))
        at = Origin(file=shown_path(path), line=next(named, 0))
    return CONTROLLERS_FILE_WITHOUT_CONTROLLERS.diagnostic(
        f"{message}, so no controller starts", origin=at, values={"key": key}
    )


def without_namespace(
    contents: Sequence[Mapping[str, Any]], namespace: str, manager: str, origin: Origin
) -> Diagnostic | None:
    """Why a manager in a namespace finds no controller in the files that its tag names, if they
    contain controllers for one without a namespace. Cartwheel starts these.

    Args:
        contents: The contents of the files.
        namespace: The manager's namespace.
        manager: Its name.
        origin: The manager.
    """
    space = namespace.strip("/")
    if not space or controller_entries(ros2_file(contents, space, manager, strict=True), "", ""):
        return None
    if not controller_entries(ros2_file(contents, space, manager), "", ""):
        return None
    return CONTROLLERS_FILE_WITHOUT_CONTROLLERS.diagnostic(
        f'the controller files have parameters for "/{manager}", but the controller manager is '
        f'"/{space}/{manager}", so no controller starts in ROS 2',
        severity="error",
        origin=origin,
        hint=f"Write /**/{manager}: and the same for each controller, or /**: for all nodes.",
        values={"nodes": (f"/{manager}",), "stops": True},
    )


def _begins(line: str, key: str) -> bool:
    return line.strip(" '\"").startswith(key)
