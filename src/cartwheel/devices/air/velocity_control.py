"""The flight of a quadrotor by a force along its z axis and torques, which follow velocities."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cartwheel.component import Scope
from cartwheel.description.inertia import combined
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.devices.air.filtered_pid import FilteredPid, FilteredPidConfig
from cartwheel.geometry import Array, Vec3, quat_conjugate, rotate

_LEAST_UPRIGHT = 0.1
"""Smallest cosine of the tilt at which the thrust compensates gravity completely."""
_NONE: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class VelocityControlConfig:
    link: str
    """Link on which the force and the torques act."""
    tilt: FilteredPidConfig
    """Controllers of roll and pitch, which result in angular accelerations."""
    yaw: FilteredPidConfig
    """Controller of the yaw rate."""
    level: FilteredPidConfig
    """Controllers of the two horizontal velocities, which result in accelerations."""
    climb: FilteredPidConfig
    """Controller of the vertical velocity."""
    max_force: float
    """Largest force, N; 0 or less: no limit."""
    acts_at: Literal["origin", "centre of mass"]
    """Point of the link at which the force acts."""
    leads: bool
    """See `FilteredPid`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Motion:
    """Motion of a quadrotor."""

    roll: float
    pitch: float
    """rad."""
    velocity: Vec3
    """Velocity with the axes ahead, left, up, which are level, m/s."""
    acceleration: Vec3
    """Acceleration in the same axes, m/s²."""
    rates: Vec3
    """Angular velocity in the axes of the link, rad/s."""
    yaw_rate: float
    """Angular velocity about the vertical, rad/s."""
    upright: float
    """Cosine of the angle between the z axis of the link and the vertical."""


class VelocityControl:
    """Computes and applies the force and the torques.

    The mass and the inertia are those of the link together with the links that are fixed to it, as
    Gazebo merges them.

    Args:
        scope: The quadrotor's model.
        config: Link, controllers and limits.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: VelocityControlConfig) -> None:
        part = scope.part
        self._part, self._config = part, config
        self.link = part.link(config.link, origin=scope.origin)
        self._wrench = part.wrench(config.link, origin=scope.origin)
        mass, centre, inertia = merged_inertia(part.description, config.link)
        self._mass, self._inertia = mass, inertia
        target = np.zeros(3) if config.acts_at == "origin" else centre
        own = part.description.link(config.link)
        assert own is not None
        self._arm = target - np.array(own.mass_centre)
        leads = config.leads
        self._roll, self._pitch = (FilteredPid(config.tilt, leads=leads) for _ in range(2))
        self._yaw = FilteredPid(config.yaw, leads=leads)
        self._ahead, self._left = (FilteredPid(config.level, leads=leads) for _ in range(2))
        self.climb = FilteredPid(config.climb, leads=leads)
        """Controller of the vertical velocity."""
        self._velocity: Vec3 | None = None

    def restart(self) -> None:
        """Clears the controllers."""
        for each in (self._roll, self._pitch, self._yaw, self._ahead, self._left, self.climb):
            each.reset()

    def reset(self) -> None:
        """Clears the controllers."""
        self.restart()
        self._velocity = None

    def motion(self, seconds: float) -> Motion:
        """Returns the motion now, a time in s after the last call."""
        self._part.locate()
        _, orientation = self.link.place()
        linear, angular = self.link.motion(local=False)
        before, self._velocity = self._velocity, linear
        acceleration = _NONE
        if before is not None and seconds > 0:
            x, y, z = ((now - old) / seconds for now, old in zip(linear, before, strict=True))
            acceleration = (x, y, z)
        up = rotate(orientation, (0.0, 0.0, 1.0))
        ahead = rotate(orientation, (1.0, 0.0, 0.0))
        yaw = math.atan2(ahead[1], ahead[0])
        across = rotate(orientation, (0.0, 1.0, 0.0))
        return Motion(
            roll=math.atan2(across[2], up[2]),
            pitch=math.asin(min(max(-ahead[2], -1.0), 1.0)),
            velocity=_turned(linear, yaw),
            acceleration=_turned(acceleration, yaw),
            rates=rotate(quat_conjugate(orientation), angular),
            yaw_rate=angular[2],
            upright=up[2],
        )

    def tilt_for(self, motion: Motion, ahead: float, left: float, seconds: float) -> Vec3:
        """Returns the torques about x and y that follow horizontal velocities in m/s; z is 0."""
        gravity = math.hypot(*self.link.gravity) or 1.0
        (vx, vy, _), (ax, ay, _) = motion.velocity, motion.acceleration
        pitch = self._ahead.update(ahead, vx, ax, seconds) / gravity
        roll = -self._left.update(left, vy, ay, seconds) / gravity
        return self.tilt(motion, roll, pitch, seconds)

    def tilt(self, motion: Motion, roll: float, pitch: float, seconds: float) -> Vec3:
        """Returns the torques about x and y in N m that follow angles in rad; z is 0."""
        x, y, _ = motion.rates
        about_x = self._roll.update(roll, motion.roll, x, seconds)
        about_y = self._pitch.update(pitch, motion.pitch, y, seconds)
        return self._inertia[0] * about_x, self._inertia[1] * about_y, 0.0

    def turn(self, motion: Motion, rate: float, seconds: float) -> float:
        """Returns the torque about z in N m that follows a yaw rate in rad/s."""
        wanted = self._yaw.acceleration(rate, motion.yaw_rate, seconds)
        return self._inertia[2] * wanted

    def lift(self, motion: Motion, climb: float, seconds: float) -> float:
        """Returns the force along z in N that follows a vertical velocity in m/s."""
        wanted = self.climb.acceleration(climb, motion.velocity[2], seconds)
        gravity = math.hypot(*self.link.gravity) / max(motion.upright, _LEAST_UPRIGHT)
        force = max(0.0, self._mass * (wanted + gravity)) if motion.upright > 0 else 0.0
        most = self._config.max_force
        return min(force, most) if most > 0 else force

    def apply(self, force: float, torque: Vec3) -> None:
        """Applies a force along z in N and a torque in N m, in the axes of the link."""
        _, orientation = self.link.place()
        ax, ay, _ = self._arm.tolist()
        x, y, z = torque
        self._wrench.apply(
            rotate(orientation, (0.0, 0.0, force)),
            rotate(orientation, (x + ay * force, y - ax * force, z)),
        )


def merged_inertia(description: RobotDescription, link: str) -> tuple[float, Array, Vec3]:
    """Returns the inertia of a link and the links that are fixed to it.

    Args:
        description: The model.
        link: Name of the link.

    Returns:
        The mass in kg, the centre of mass in the link in m, shape (3,), and the moments of inertia
        about it and the axes of the link in kg m².
    """
    merged = {link}
    while True:
        fixed = {
            name
            for joint in description.joints
            if joint.type == "fixed" and not merged.isdisjoint((joint.parent, joint.child))
            for name in (joint.parent, joint.child)
        }
        if fixed <= merged:
            break
        merged |= fixed
    poses = link_poses(description, {})
    to_link = poses[link].inverse()
    mass, centre, total = combined(
        (to_link @ poses[each.name], each.inertial)
        for each in description.links
        if each.name in merged and each.inertial is not None
    )
    x, y, z = np.diag(total).tolist()
    return mass, centre, (x, y, z)


def _turned(vector: Vec3, yaw: float) -> Vec3:
    """Returns a vector in the world in level axes whose x axis has a yaw in rad."""
    x, y, z = vector
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * x + sin * y, cos * y - sin * x, z
