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
