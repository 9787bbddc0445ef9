"""A model in a world, with the elements that its plugins requested."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from cartwheel.description.model import CameraIntrinsics, Mimic, RobotDescription, Surface
from cartwheel.geometry import Pose, Vec3
from cartwheel.world.motion import Motion

ROTOR = "rotor"
"""Name of the rotor of a driven joint: a body, a joint and a tendon."""
TYRE = "tyre"
"""Name of the tyre of a slipping wheel: a body, and the prefix of its two joints."""
TURN, SHIFT = "turn", "shift"
DRIVE_AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""Axes of a `BodyDrive`'s servos, in the world."""


def scoped(*parts: str) -> str:
    """Gazebo's scoped name: ``model::link::collision``."""
    return "::".join(parts)


_PART = "\x1f"
"""Separates a collision's name from a part number; it cannot occur in XML."""


def part_name(collision: str, number: int) -> str:
    """The name of a convex part of a collision; the first part has the collision's name."""
    return f"{collision}{_PART}{number}" if number else collision


def collision_of(part: str) -> str:
    """The collision name of a part."""
    return part.partition(_PART)[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class Motor:
    """A driven joint."""

    joint: str
    mode: Literal["velocity", "servo"]
    """A servo's control law is set at run time; see `ServoHandle`."""
    max_effort: float | None = None
    """N m or N; None is unlimited."""
    beyond: bool = False
    """Whether holding a position or velocity may exceed the joint's effort limit."""
    replaces_friction: bool = False
    """Whether the joint's own dry friction has no effect, as with a motor of ODE."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyDrive:
    """A servo that moves a whole model by holding the velocity of one link."""

    link: str
    centre: Vec3
    """Point of application in the link: at the model's centre of mass, no tilting torque results.
    """
    force_gain: float
    """N s/m, along each axis."""
    torque_gain: float
    """N m s/rad, about each axis."""
    band: float
    """m/s or rad/s; larger velocity errors are clipped to this value."""
    tilt_gain: float = 0.0
    """N m s/rad, about horizontal axes while the drive is level. 0: as for other axes."""
    tilt_band: float = 0.0
    """rad/s; larger errors of the roll and pitch rates are clipped to this value."""
    number: int = 0
    """Index in the model: two plugins may push it."""

    @property
    def name(self) -> str:
        """Name of its site and motors in the link."""
        return f"drive{self.number or ''}"


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraMount:
    """A camera on a link: looks along the x axis of `pose`, with z up."""

    name: str
    """Unique in its model."""
    link: str
    pose: Pose
    intrinsics: CameraIntrinsics


@dataclass(frozen=True, kw_only=True, slots=True)
class Grip:
    """The friction of a link, in place of that in the description."""

    mu1: float | None
    """None: as described, as for `mu2`."""
    mu2: float | None
    direction: tuple[str, Vec3] | None
    """A link, and the direction in its axes in which mu1 applies; None: as described."""

    def given_to(self, surface: Surface) -> Surface:
        """A surface with this friction."""
        mu1 = surface.mu1 if self.mu1 is None else self.mu1
        mu2 = surface.mu2 if self.mu2 is None else self.mu2
        fdir1, frame = surface.fdir1, surface.fdir1_frame
        if self.direction is not None:
            frame, fdir1 = self.direction
        return replace(surface, mu1=mu1, mu2=mu2, fdir1=fdir1, fdir1_frame=frame)


@dataclass(kw_only=True, slots=True)
class ModelEntry:
    """A model in the world."""

    name: str
    description: RobotDescription
    pose: Pose
    """Pose of the model's frame at spawn and after a reset, or now if it is fixed to the world."""
    motion: Motion | None = None
    """The motion of a model that is fixed to the world; None while it stands."""
    motors: dict[str, Motor] = field(default_factory=dict)
    """By joint."""
    mimics: dict[str, Mimic] = field(default_factory=dict)
    """By follower joint; in addition to those in the description."""
    drives: list[BodyDrive] = field(default_factory=list)
    cameras: list[CameraMount] = field(default_factory=list)
    slips: dict[str, float] = field(default_factory=dict)
    """Wheels with slipping tyres by link, with their radius in m; see `SlipHandle`."""
    grips: dict[str, Grip] = field(default_factory=dict)
    """Friction that plugins state, by link."""
    tracks: list[str] = field(default_factory=list)
    """Links whose surface moves along itself; see `SurfaceHandle`."""
    felt: list[str] = field(default_factory=list)
    """Links whose contacts must stay awake, besides those with contact sensors."""
    attachments: list[str] = field(default_factory=list)
    """Names of initially inactive welds; see `AttachmentHandle`."""
    longest_step: float = math.inf
    """Longest time step for a control loop of the model in a world without a stated step, s."""

    def copy(self) -> ModelEntry:
        """A copy that later requests do not change."""
        return replace(
            self,
            motors=dict(self.motors),
            mimics=dict(self.mimics),
            drives=list(self.drives),
            cameras=list(self.cameras),
            slips=dict(self.slips),
            grips=dict(self.grips),
            tracks=list(self.tracks),
            felt=list(self.felt),
            attachments=list(self.attachments),
        )
