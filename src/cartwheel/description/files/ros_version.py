"""The version of ROS for which a package is built."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import Literal

from cartwheel.description.files.package_folders import is_file, package_above

_MOST = 65536
"""Bytes of a package.xml that are read."""
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
_ROS1 = re.compile(rb"<(?:buildtool_depend|build_type)\b[^<>]*>\s*catkin\b")
_ROS2 = re.compile(rb"<(?:buildtool_depend|build_type)\b[^<>]*>\s*ament_\w")
_LIBRARY = rb"<(?:depend|build_depend|exec_depend|run_depend)\b[^<>]*>\s*(?:%b)\s*<"
_LIBRARY1 = re.compile(_LIBRARY % rb"roscpp|rospy")
_LIBRARY2 = re.compile(_LIBRARY % rb"rclcpp|rclpy")


def ros_version(file: Path) -> Literal[1, 2] | None:
    """The version of ROS of the package that contains a file.

    Args:
        file: Any file.

    Returns:
        None if the file is in no package, or if its package.xml is for both versions or neither.
    """
    package = package_above(file.absolute().parent)
    if package is None:
        return None
    manifest = package / "package.xml"
    try:
        return _stated(manifest, manifest.stat().st_mtime_ns)
    except (OSError, ValueError):
        return None


@lru_cache(maxsize=4096)
def _stated(manifest: Path, _changed: int) -> Literal[1, 2] | None:
    if not is_file(manifest):
        return None
    with manifest.open("rb") as file:
        text = _COMMENT.sub(b"", file.read(_MOST))
    first, second = bool(_ROS1.search(text)), bool(_ROS2.search(text))
    if first and second:
        # One of the two may be a leftover, which the libraries of a package for both are not.
        first, second = bool(_LIBRARY1.search(text)), bool(_LIBRARY2.search(text))
    if first == second:
        return None
    return 1 if first else 2
