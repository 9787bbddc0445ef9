"""A model that stands in a world, with what its plugins asked to be built into it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from cartwheel.description.model import CameraIntrinsics, RobotDescription
from cartwheel.geometry import Pose


def scoped(*parts: str) -> str:
    """Gazebo's scoped name: ``model::link::collision``."""
    return "::".join(parts)


@dataclass(frozen=True, kw_only=True, slots=True)
class Motor:
    """A driven joint."""

    joint: str
    mode: Literal["velocity", "effort"]
    max_effort: float | None = None
    """N m or N; None is unlimited."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraMount:
    """A camera on a link: looks along the x axis of `pose`, z up."""

    name: str
    """Unique in its model."""
    link: str
    pose: Pose
    intrinsics: CameraIntrinsics


@dataclass(kw_only=True, slots=True)
class ModelEntry:
    """A model in the world."""

    name: str
    description: RobotDescription
    pose: Pose
    """Of the model's frame: where it was spawned and where a reset returns it."""
    motors: dict[str, Motor] = field(default_factory=dict)
    """By joint."""
    cameras: list[CameraMount] = field(default_factory=list)
