"""The drag of a body in the air."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.air.velocity_control import merged_inertia
from cartwheel.devices.contact.wrench import WRENCH_STAMPED, wrench_stamped
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Vec3, quat_conjugate, rotate
from cartwheel.messages import header

_FASTEST = 100.0
"""Largest velocity that causes drag, m/s or rad/s."""
_STILL: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyDragConfig:
    link: str
    """Link on which the drag acts."""
    frame: str
    """Frame ID of the messages."""
    force: Vec3
    """Force per product of the airspeed and its component along each axis, N s²/m²."""
    torque: Vec3
    """Torque per product of the angular speed and its component about each axis, N m s²."""
    wind_topic: str
    """Topic of the wind in the world (Vector3), m/s; empty: no wind."""
    wrench_topic: str
    """Topic of the force and the torque (WrenchStamped); empty: not published."""


class BodyDrag(Component):
    """Applies a force and a torque against the motion of a link through the air.

    They grow with the square of the speed. Over a step, they remove at most the motion itself.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: BodyDragConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        mass, _, inertia = merged_inertia(part.description, config.link)
        self._mass, self._inertia = (mass, mass, mass), inertia
        self._frame = self.frame(config.frame)
        self._wrenches = (
            self.advertise(config.wrench_topic, WRENCH_STAMPED) if config.wrench_topic else None
        )
        if config.wind_topic:
            self.subscribe(config.wind_topic, "geometry_msgs/msg/Vector3", self._on_wind)
        self.reset()
        part.schedule(0, before=self._apply)

    def reset(self) -> None:
        super().reset()
        self._wind = _STILL
        self._elapsed = Elapsed()

    def _on_wind(self, wind: Any) -> None:
        self._wind = (wind.x, wind.y, wind.z)

    def _apply(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        self.part.locate()
        config = self._config
        _, orientation = self._link.place()
        (vx, vy, vz), angular = self._link.motion(local=True)
        wx, wy, wz = rotate(quat_conjugate(orientation), self._wind)
        air = (vx - wx, vy - wy, vz - wz)
        force = drag(air, config.force, self._mass, seconds)
        torque = drag(angular, config.torque, self._inertia, seconds)
        self._wrench.apply(rotate(orientation, force), rotate(orientation, torque))
        if self._wrenches is not None and self._wrenches.wanted:
            moment = header(self.part.time_ns, self._frame)
            self._wrenches.publish(wrench_stamped(moment, (*force, *torque)))


def drag(
    velocity: Sequence[float], factors: Vec3, inertias: Sequence[float], seconds: float
) -> Vec3:
    """Returns the drag against a velocity, or an angular velocity.

    Args:
        velocity: m/s or rad/s.
        factors: Drag per product of the speed and the component along each axis.
        inertias: Mass in kg or moment of inertia in kg m² along each axis.
        seconds: Duration of the step. The drag is that at the end of the step.
    """
    limited = [min(max(each, -_FASTEST), _FASTEST) for each in velocity]
    speed = math.hypot(*limited)
    x, y, z = (
        -factor * speed * each / (1 + factor * speed * seconds / max(inertia, 1e-9))
        for each, factor, inertia in zip(limited, factors, inertias, strict=True)
    )
    return x, y, z
