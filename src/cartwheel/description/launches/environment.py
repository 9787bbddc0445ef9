"""Environment variables in launch files: those that every sourced ROS sets."""

from __future__ import annotations

import ast
import os
from pathlib import Path
from typing import Any

from cartwheel.description.files.ros_environment import ROS_VARIABLES, RosEnvironment, assumed
from cartwheel.description.launches.use import Facts
from cartwheel.errors import Origin


def ros_variable(name: Any, path: Path, line: int, facts: Facts) -> str | None:
    """The value of an environment variable that ROS sets; None for any other one.

    If it is not set, it has the value of the ROS version of the launch file, which is noted.

    Args:
        name: The variable.
        path: The launch file.
        line: The line that uses the variable.
        facts: Receives the note.
    """

    def note(name: str, value: str, version: int) -> None:
        origin = Origin(file=str(path), line=line)
        facts.assumed.setdefault(name, assumed(name, value, version, origin))

    environment = RosEnvironment(os.environ, path, note)
    known = isinstance(name, str) and name in ROS_VARIABLES and name in environment
    return environment[name] if known else None


def is_environ(node: ast.expr) -> bool:
    """Whether an expression is ``os.environ``."""
    return (
        isinstance(node, ast.Attribute)
        and node.attr == "environ"
        and isinstance(node.value, ast.Name)
        and node.value.id == "os"
    )


def is_variable(node: ast.Call, name: str) -> bool:
    """Whether a function of this name returns the environment variable of its first argument."""
    if name == "get":
        return isinstance(node.func, ast.Attribute) and is_environ(node.func.value)
    return name in ("getenv", "EnvironmentVariable")
