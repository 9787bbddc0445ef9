"""The models and the world in the arguments of Gazebo's nodes and commands."""

from __future__ import annotations

import itertools
import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.description.launches.effort import UNKNOWN, limited

MODEL_SPAWNERS = frozenset({"spawn_model", "spawn_entity.py", "create"})
"""Executables of gazebo_ros and ros_gz_sim that spawn a model."""
_PLACE = {"-x": "x", "-y": "y", "-z": "z", "-R": "roll", "-P": "pitch", "-Y": "yaw"}
_FILES = frozenset({"-file", "-f", "--file"})
_SOURCES = frozenset({"-param", "-topic"})
_NAMES = frozenset({"-model", "-entity", "-name"})
_SPACES = frozenset({"-robot_namespace", "-namespace"})
_IN_NAMESPACE = frozenset({"spawn_model", "spawn_entity.py"})
"""Those whose models have the namespace of their node, unless another one is stated."""
_MANAGERS = frozenset({"-c", "--controller-manager"})
_MANAGER_SPACES = frozenset({"-n", "--namespace"})
"""Options of spawners that state the controller manager, or its namespace."""
INACTIVE = frozenset({"--inactive", "--stopped", "--load-only"})
"""Options of spawners that only load controllers."""
SWITCHES = INACTIVE | {"--activate-as-group", "--unload-on-kill", "-u"}
"""Options of spawners without a value."""
_LOADING_OPTIONS = frozenset({"--set-state", "-c", "--controller-manager", "--spin-time"})
"""Options of ``ros2 control load_controller`` with a value."""
_FARTHEST = 1e6
_WORLDS = (".world", ".sdf")


@dataclass(frozen=True, kw_only=True, slots=True)
class Spawn:
    """A model that a launch file spawns."""

    file: Path | None = None
    """Its description; None for that of `source`."""
    described: int | None = None
    """The number of its description in `Facts.descriptions`; None if the file does not exist, or
    for that of `source`."""
    source: str = ""
    """The topic or parameter that contains its description, such as ``one/robot_description``."""
    name: str = ""
    """Empty for the name in the description."""
    namespace: str = ""
    place: Mapping[str, float] = field(default_factory=dict)
    """Those of x, y, z, roll, pitch and yaw that are stated and known, m and rad."""
    unknown: frozenset[str] = frozenset()
    """Those of name, namespace and place that are stated, but unknown."""


def spawn_of(executable: str, words: Sequence[str], space: str) -> Spawn:
    """The model that a spawner with these arguments spawns.

    Args:
        executable: The spawner.
        words: Its arguments.
        space: Its namespace.
    """
    file, source, name = None, "", ""
    namespace = space if executable in _IN_NAMESPACE else ""
    place: dict[str, float] = {}
    stated = 0
    for flag, word in itertools.pairwise(words):
        if flag in _FILES:
            file = Path(word)
        elif flag in _SOURCES:
            source = resolved(space, word)
        elif flag in _PLACE:
            stated += 1
            number = _number(word)
            if number is not None:
                place[_PLACE[flag]] = number
        elif flag in _NAMES:
            name = word
        elif flag in _SPACES:
            namespace = word.strip("/")
    unknown = {"place"} if stated > len(place) else set()
    if UNKNOWN in name:
        name = ""
        unknown.add("name")
    if UNKNOWN in namespace:
        namespace = ""
        unknown.add("namespace")
    return Spawn(
        file=file,
        source=source,
        name=name,
        namespace=namespace,
        place=place,
        unknown=frozenset(unknown),
    )


def resolved(space: str, name: str) -> str:
    """A name in a namespace, without the first slash."""
    if not name.startswith("/"):
        name = f"{space}/{name}"
    return limited("/".join(part for part in name.split("/") if part))


def options_apart(words: list[str]) -> list[str]:
    """Arguments of a spawner, with the value of an option such as ``--param-file=FILE`` apart."""
    parts = (word.split("=", 1) if word.startswith("--") else [word] for word in words)
    return [*itertools.chain(*parts)]


def loaded_controller(words: list[str]) -> list[str]:
    """The arguments of ``ros2 control load_controller`` that are no options: a controller, and
    perhaps its file.
    """
    found = []
    options = iter(words)
    for word in options:
        if word in _LOADING_OPTIONS:
            next(options, None)
        elif not word.startswith("-"):
            found.append(word)
    return found


def manager_space(words: list[str], space: str) -> str:
    """The namespace of a controller manager; empty if it is unknown, as for that of any robot.

    Args:
        words: Arguments of a spawner, which may state the manager.
        space: The namespace of the spawner.
    """
    for flag, word in itertools.pairwise(words):
        if flag in _MANAGERS:
            space = resolved(space, word).rpartition("/")[0]
        elif flag in _MANAGER_SPACES:
            space = resolved(space, word)
    return "" if UNKNOWN in space else space


def _number(word: str) -> float | None:
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) and abs(value) <= _FARTHEST else None


def world_in(words: Sequence[str]) -> str:
    """The world among the arguments of Gazebo; empty if there is none."""
    return next((word for word in words if word.endswith(_WORLDS)), "")


def split(text: str) -> list[str]:
    """The words of a command line."""
    try:
        return shlex.split(text)
    except ValueError:
        return text.split()
