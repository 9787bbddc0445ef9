"""The environment variables that every sourced ROS sets, without a sourced ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Literal

from cartwheel.codes.files import ENVIRONMENT_ASSUMED
from cartwheel.description.files.package_folders import package_above
from cartwheel.description.files.ros_version import ros_version
from cartwheel.errors import Diagnostic, Origin

_SET: Mapping[int, Mapping[str, str]] = {
    1: {
        "ROS_VERSION": "1",
        "ROS_DISTRO": "noetic",
        "ROS_PYTHON_VERSION": "3",
        "ROS_MASTER_URI": "http://localhost:11311",
    },
    2: {"ROS_VERSION": "2", "ROS_DISTRO": "humble", "ROS_PYTHON_VERSION": "3"},
}
"""By the version of ROS. Of both, the last distribution with Gazebo Classic."""
ROS_VARIABLES = frozenset(name for names in _SET.values() for name in names)
_ROS2 = (".launch.xml", "_launch.xml", ".launch.yaml", "_launch.yaml")
"""Ends of the names of launch files for ROS 2 that are not in Python."""
_MOST = 500
"""Maximum number of launch files to look at."""


class RosEnvironment(Mapping[str, str]):
    """Environment variables, and in addition those that ROS sets.

    As no ROS is sourced, they have the values of the ROS version for which a file is made. If it is
    unknown, a variable that must be set has the value of ROS 2, and one that may be set is not.

    Args:
        variables: The variables that are set.
        file: The file that uses them; None for a text.
        report: Called with each value that is not among `variables`.
    """

    def __init__(
        self,
        variables: Mapping[str, str],
        file: Path | None,
        report: Callable[[str, str, int], None],
    ) -> None:
        self._variables = variables
        self._file = file
        self._report = report

    def __getitem__(self, name: str) -> str:
        if name in self._variables or name not in ROS_VARIABLES:
            return self._variables[name]
        version = self._known or 2
        value = _SET[version].get(name)
        if value is None:
            raise KeyError(name)
        self._report(name, value, version)
        return value

    def __contains__(self, name: object) -> bool:
        if name in self._variables or name not in ROS_VARIABLES:
            return name in self._variables
        return name in _SET.get(self._known or 0, {})

    def __iter__(self) -> Iterator[str]:
        return iter(self._variables)

    def __len__(self) -> int:
        return len(self._variables)

    @cached_property
    def _known(self) -> Literal[1, 2] | None:
        if self._file is None:
            return None
        return ros_version(self._file) or _launched_by(self._file.absolute())


def assumed(name: str, value: str, version: int, origin: Origin) -> Diagnostic:
    """The message that an environment variable has the value that ROS would set."""
    return ENVIRONMENT_ASSUMED.diagnostic(
        f'the environment variable "{name}" is not set, so its value in ROS {version} is used: '
        f'"{value}"',
        origin=origin,
        hint=f"For a different value, set {name}.",
        mark=name,
        values={"name": name, "value": value, "ros": float(version)},
    )


def _launched_by(file: Path) -> Literal[1, 2] | None:
    """The version of ROS of a launch file, or of all launch files in the package of a file."""
    own = 2 if file.suffix == ".py" else _started_by(file.name)
    if own is not None:
        return own
    package = package_above(file.parent)
    try:
        files = sorted((package / "launch").iterdir())[:_MOST] if package is not None else []
    except OSError:
        return None
    first, second = (any(_started_by(each.name) == ros for each in files) for ros in (1, 2))
    if first == second:
        return None
    return 1 if first else 2


def _started_by(name: str) -> Literal[1, 2] | None:
    """The version of ROS that starts a launch file, by its name; None for another file."""
    if name.endswith(_ROS2) or (name.endswith(".py") and "launch" in name):
        return 2
    return 1 if name.endswith(".launch") else None
