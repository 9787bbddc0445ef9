"""A model that stands in a world, with what its plugins asked to be built into it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from cartwheel.description.model import CameraIntrinsics, Mimic, RobotDescription
from cartwheel.geometry import Pose, Vec3

ROTOR = "rotor"
"""Of a driven joint: what it is coupled to; a body, a joint and a tendon of that name."""
TYRE = "tyre"
"""Of a wheel that slips: a body, that turns and shifts on the wheel by joints of these names."""
TURN, SHIFT = "turn", "shift"
DRIVE_AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""Of a `BodyDrive`'s servos, in the world's axes."""


def scoped(*parts: str) -> str:
    """Gazebo's scoped name: ``model::link::collision``."""
    return "::".join(parts)


_PART = "\x1f"
"""Between a collision's name and the number of a part; no XML can hold it."""


def part_name(collision: str, number: int) -> str:
    """The name of one of the convex parts of a collision; the first has the collision's own."""
    return f"{collision}{_PART}{number}" if number else collision


def collision_of(part: str) -> str:
    """The name of the collision that a part belongs to."""
    return part.partition(_PART)[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class Motor:
    """A driven joint."""

    joint: str
    mode: Literal["velocity", "servo"]
    """A servo's law is set while it runs; see `ServoHandle`."""
    max_effort: float | None = None
    """N m or N; None is unlimited."""
    beyond: bool = False
    """Whether a position or velocity is held with that even beyond the joint's effort limit."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyDrive:
    """A servo that moves a whole model: it holds the velocity of one of its links."""

    link: str
    centre: Vec3
    """Where it pushes, in the link: at the model's centre of mass it tips nothing over."""
    force_gain: float
    """N s/m, along each axis."""
    torque_gain: float
    """N m s/rad, about each axis."""
    band: float
    """m/s or rad/s: a larger difference of velocities counts as this one."""
    number: int = 0
    """Among the model's: two plugins may push it."""

    @property
    def name(self) -> str:
        """Of its site and its motors, in the link."""
        return f"drive{self.number or ''}"


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
    mimics: dict[str, Mimic] = field(default_factory=dict)
    """By the joint that follows; besides those of the description."""
    drives: list[BodyDrive] = field(default_factory=list)
    cameras: list[CameraMount] = field(default_factory=list)
    slips: dict[str, float] = field(default_factory=dict)
    """Wheels whose tyres give way, with their radius in m, by link; see `SlipHandle`."""
    felt: list[str] = field(default_factory=list)
    """Links on which what lies must stay awake, besides those with contact sensors."""
    attachments: list[str] = field(default_factory=list)
    """Names of welds that hold nothing at first; see `AttachmentHandle`."""
