"""The models and the world in the arguments of Gazebo's nodes and commands."""

from __future__ import annotations

import itertools
import math
import re
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
_WITH_VALUE = re.compile(r"(-[A-Za-z_]+)=(.*)", re.DOTALL)
"""An argument with its value in the same word, as in ``-x=1``."""
_OF_GZ = "create"
"""The executable of ros_gz_sim. It also accepts arguments with two hyphens."""
_RENAMES = re.compile(r"--?allow_renaming(?:=(?:true|True|t|1|yes|y))?")
"""A flag of `_OF_GZ`. A value in the next word has no effect."""
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
    """Those of name, namespace, place and joints that are stated, but unknown."""
    model: str = ""
    """The name of the model in Gazebo's model path that is spawned; empty if another description
    is."""
    frame: str = ""
    """The model or link in whose frame the place is; empty for the world."""
    joints: Mapping[str, float] = field(default_factory=dict)
    """Positions of joints with which it starts, rad or m."""
    renames: bool = False
    """Whether it gets another name if its own one is in use."""


def spawn_of(executable: str, words: Sequence[str], space: str) -> Spawn:
    """The model that a spawner with these arguments spawns.

    Args:
        executable: The spawner.
        words: Its arguments.
        space: Its namespace.
    """
    file, source, name, model, frame = None, "", "", "", ""
    renames = executable == _OF_GZ and any(_RENAMES.fullmatch(word) for word in words)
    words = [part for word in words for part in _parts(executable, word)]
    namespace = space if executable in _IN_NAMESPACE else ""
    place: dict[str, float] = {}
    joints: dict[str, float] = {}
    stated = 0
    unknown: set[str] = set()
    for index, (flag, word) in enumerate(itertools.pairwise(words)):
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
        elif flag == "-database":
            model = word
        elif flag == "-reference_frame":
            frame = word.strip()
        elif flag == "-J" and executable == "spawn_model":
            number = _number(words[index + 2]) if index + 2 < len(words) else None
            if number is None or UNKNOWN in word:
                unknown.add("joints")
            else:
                joints[word] = number
    if UNKNOWN in frame:
        frame, stated = "", len(place) + 1
    if stated > len(place):
        unknown.add("place")
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
        model=model,
        frame=frame,
        joints=joints,
        renames=renames,
        unknown=frozenset(unknown),
    )


def spawns(words: Sequence[str]) -> bool:
    """Whether these are arguments of a spawner, by the options of the model's source and name."""
    return not _SOURCES.isdisjoint(words) and not _NAMES.isdisjoint(words)


def _parts(executable: str, word: str) -> Sequence[str]:
    """An argument of a spawner, with its value if the same word contains it."""
    if executable == _OF_GZ and word.startswith("--") and word != "--ros-args":
        word = word[1:]
    found = _WITH_VALUE.fullmatch(word)
    return (word,) if found is None else found.groups()


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
