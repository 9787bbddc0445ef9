"""The models and the world in the arguments of Gazebo's nodes and commands."""

from __future__ import annotations

import itertools
import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.launches.effort import UNKNOWN

MODEL_SPAWNERS = frozenset({"spawn_model", "spawn_entity.py", "create"})
"""Executables of gazebo_ros and ros_gz_sim that spawn a model."""
_PLACE = {"-x": "x", "-y": "y", "-z": "z", "-R": "roll", "-P": "pitch", "-Y": "yaw"}
_FILES = frozenset({"-file", "-f", "--file"})
_NAMES = frozenset({"-model", "-entity", "-name"})
_SPACES = frozenset({"-robot_namespace", "-namespace"})
_FARTHEST = 1e6
_WORLDS = (".world", ".sdf")


@dataclass(frozen=True, kw_only=True, slots=True)
class Spawn:
    """A model that a launch file spawns."""

    file: Path | None
    """Its description; None for that of ``robot_description``."""
    name: str = ""
    """Empty for the name in the description."""
    namespace: str = ""
    place: Mapping[str, float]
    """Those of x, y, z, roll, pitch and yaw that are stated and known, m and rad."""
    unknown: bool = False
    """Whether a stated one is unknown."""


def spawn_of(words: Sequence[str]) -> Spawn:
    """The model that a spawner with these arguments spawns."""
    file, name, namespace = None, "", ""
    place: dict[str, float] = {}
    stated = 0
    for flag, word in itertools.pairwise(words):
        if flag in _FILES:
            file = Path(word)
        elif flag in _PLACE:
            stated += 1
            number = _number(word)
            if number is not None:
                place[_PLACE[flag]] = number
        elif flag in _NAMES and UNKNOWN not in word:
            name = word
        elif flag in _SPACES and UNKNOWN not in word:
            namespace = word.strip("/")
    unknown = stated > len(place)
    return Spawn(file=file, name=name, namespace=namespace, place=place, unknown=unknown)


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
