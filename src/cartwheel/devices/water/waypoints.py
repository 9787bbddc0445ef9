"""Follows waypoints in the plane by a force ahead and a torque about the vertical."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.air.velocity_control import merged_inertia
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Quat, Vec3, quat_conjugate, quat_multiply, rotate

Point = tuple[float, float]
_ZERO: Vec3 = (0.0, 0.0, 0.0)
_CIRCLE = 8
"""Number of waypoints on a circle, as in gz-sim."""


@dataclass(frozen=True, slots=True)
class Circle:
    """Waypoints on a circle about the first place of a link."""

    radius: float
    """m."""


@dataclass(frozen=True, slots=True)
class Line:
    """Waypoints at the first place of a link and at the end of a line from there."""

    direction: float
    """Angle to the first x axis of the link, rad."""
    length: float
    """m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WaypointsConfig:
    link: str
    """Link on which the force and the torque act."""
    path: tuple[Point, ...] | Circle | Line
    """Waypoints in the world, m, or how they follow from the first place of the link."""
    loops: bool
    """Whether the first waypoint follows the last one."""
    reached: float
    """Distance at which a waypoint is reached, m."""
    aligned: float
    """Bearing up to which the force acts instead of the torque, rad."""
    stops_turning: bool
    """Whether the rotation stops when the bearing is at most half of `aligned`."""
    force: float
    """Force along the x axis of the link's inertial frame, N."""
    torque: float
    """Torque about its z axis, N m."""
    pause_topic: str
    """Topic that pauses the motion (Bool)."""


class Waypoints(Component):
    """Turns a link to the next waypoint by a torque, and moves it there by a force.

    Without a loop, the last waypoint remains the target. Source: TrajectoryFollower of gz-sim.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: WaypointsConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        description = part.description.link(config.link)
        assert description is not None
        inertial = description.inertial
        self._frame: Quat = inertial.pose.orientation if inertial else (0.0, 0.0, 0.0, 1.0)
        _, _, self._inertia = merged_inertia(part.description, config.link)
        self.reset()
        self.subscribe(config.pause_topic, "std_msgs/msg/Bool", self._on_pause)
        part.schedule(0, before=self._move)

    def reset(self) -> None:
        super().reset()
        self._paused = False
        self._left: deque[Point] | None = None
        self._elapsed = Elapsed()

    def _on_pause(self, message: Any) -> None:
        self._paused = bool(message.data)

    def _move(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if self._paused:
            self._wrench.apply(_ZERO, _ZERO)
            return
        self.part.locate()
        (x, y, _), orientation = self._link.place()
        if self._left is None:
            self._left = deque(waypoints(self._config, (x, y), orientation))
        force, torque = self._steer((x, y), orientation, seconds)
        axes = quat_multiply(orientation, self._frame)
        self._wrench.apply(rotate(axes, (force, 0.0, 0.0)), rotate(axes, torque))

    def _steer(self, place: Point, orientation: Quat, seconds: float) -> tuple[float, Vec3]:
        """The force ahead in N and the torque in N m."""
        config, left = self._config, self._left
        if not left:
            return 0.0, _ZERO
        ahead = (left[0][0] - place[0], left[0][1] - place[1], 0.0)
        if math.hypot(*ahead) <= config.reached:
            if len(left) > 1:
                passed = left.popleft()
                if config.loops:
                    left.append(passed)
            return 0.0, _ZERO
        x, y, _ = rotate(quat_conjugate(orientation), ahead)
        bearing = math.atan2(y, x)
        if abs(bearing) > config.aligned:
            return 0.0, (0.0, 0.0, math.copysign(config.torque, bearing))
        stop = _ZERO
        if config.stops_turning and abs(bearing) <= config.aligned / 2 and seconds > 0:
            _, rates = self._link.motion(local=True)
            rx, ry, rz = rotate(quat_conjugate(self._frame), rates)
            ix, iy, iz = self._inertia
            stop = (-ix * rx / seconds, -iy * ry / seconds, -iz * rz / seconds)
        return config.force, stop


def waypoints(config: WaypointsConfig, place: Point, orientation: Quat) -> list[Point]:
    """Returns the waypoints in the world, m.

    Args:
        config: The path.
        place: First place of the link, m.
        orientation: Its first orientation.
    """
    path, (x, y) = config.path, place
    if isinstance(path, Circle):
        angles = [2 * math.pi * number / _CIRCLE for number in range(_CIRCLE)]
        radius = path.radius
        return [(x + radius * math.cos(each), y + radius * math.sin(each)) for each in angles]
    if isinstance(path, Line):
        along = (math.cos(path.direction), math.sin(path.direction), 0.0)
        dx, dy, _ = rotate(orientation, along)
        return [(x, y), (x + path.length * dx, y + path.length * dy)]
    return list(path)
