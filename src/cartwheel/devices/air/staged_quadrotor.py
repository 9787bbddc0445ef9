"""A quadrotor that takes off and lands by messages, and follows velocities, angles or positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.component import Component, Scope
from cartwheel.devices.air.filtered_pid import FilteredPid, FilteredPidConfig
from cartwheel.devices.air.velocity_control import Motion, VelocityControl, VelocityControlConfig
from cartwheel.devices.periodic import Elapsed, Periodic
from cartwheel.geometry import Pose as Placement
from cartwheel.geometry import Vec3, quat_conjugate, quat_from_axis_angle, rotate, yaw_of
from cartwheel.messages import message_class

_TWIST = "geometry_msgs/msg/Twist"
_VECTOR3 = "geometry_msgs/msg/Vector3"
Stage = Literal["landed", "flying", "taking off", "landing"]
_NUMBERS: dict[Stage, int] = {"landed": 0, "flying": 1, "taking off": 2, "landing": 3}
"""Stages in the messages."""
_FACTORS: dict[Stage, float] = {"landed": 0.0, "flying": 1.0, "taking off": 1.5, "landing": 0.8}
"""Applied fraction of the force and the torque."""
_NEXT: dict[Stage, tuple[Stage, float]] = {
    "taking off": ("flying", 0.5),
    "landing": ("landed", 1.0),
}
"""The stage after some stages, and their durations in s."""
_STILL: Vec3 = (0.0, 0.0, 0.0)
_UP = (0.0, 0.0, 1.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class StagedQuadrotorConfig:
    control: VelocityControlConfig
    place: FilteredPidConfig
    """Controllers of the horizontal position, which result in velocities."""
    height: FilteredPidConfig
    """Controller of the height."""
    noise: float
    """Largest noise on the angular and vertical commands, rad/s and m/s."""
    drift: float
    """Largest drift of the same commands."""
    drift_time: float
    """Time after which the drift changes, s."""


class StagedQuadrotor(Component):
    """Follows commands while it flies, takes off and lands.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: StagedQuadrotorConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._flight = VelocityControl(scope, config.control)
        self._x, self._y = (FilteredPid(config.place) for _ in range(2))
        self._z = FilteredPid(config.height)
        self._Twist, self._Vector3 = message_class(_TWIST), message_class(_VECTOR3)
        self._offer()
        self._clear()
        self.part.schedule(0, before=self._control)

    def _offer(self) -> None:
        """Creates the publishers and subscriptions."""
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Int8 = message_class("std_msgs/msg/Int8")
        self._String = message_class("std_msgs/msg/String")
        self._poses = self.advertise("gt_pose", "geometry_msgs/msg/Pose")
        self._velocities = self.advertise("gt_vel", _TWIST)
        self._accelerations = self.advertise("gt_acc", _TWIST)
        self._states = self.advertise("state", "std_msgs/msg/Int8")
        self._modes = self.advertise("cmd_mode", "std_msgs/msg/String")
        self.subscribe("cmd_vel", _TWIST, self._on_command)
        self.subscribe("posctrl", "std_msgs/msg/Bool", self._on_position_control)
        self.subscribe("dronevel_mode", "std_msgs/msg/Bool", self._on_mode)
        self.subscribe("takeoff", "std_msgs/msg/Empty", self._on_takeoff)
        self.subscribe("land", "std_msgs/msg/Empty", self._on_land)
        self.subscribe("reset", "std_msgs/msg/Empty", lambda _: self._flight.restart())

    def reset(self) -> None:
        super().reset()
        self._flight.reset()
        for each in (self._x, self._y, self._z):
            each.reset()
        self._clear()

    def _clear(self) -> None:
        self._linear, self._angular = _STILL, _STILL
        self._stage: Stage = "landed"
        self._stage_seconds = 0.0
        self._by_position = self._by_velocity = False
        self._elapsed = Elapsed()
        self._drift: tuple[float, ...] = (0.0,) * 4
        self._drift_ends = Periodic(1 / self._config.drift_time)

    def _on_command(self, command: Any) -> None:
        config, part = self._config, self.part
        linear, angular = command.linear, command.angular
        noise: tuple[float, ...] = (0.0,) * 4
        if config.drift > 0 and self._drift_ends.due(part.time_ns):
            draw = part.random(f"{self.node} drift").uniform(-config.drift, config.drift, 4)
            self._drift = tuple(draw.tolist())
        if config.noise > 0:
            draw = part.random(f"{self.node} noise").uniform(-config.noise, config.noise, 4)
            noise = tuple(draw.tolist())
        x, y, z, up = (a + b for a, b in zip(self._drift, noise, strict=True))
        self._angular = (angular.x + x, angular.y + y, angular.z + z)
        self._linear = (linear.x, linear.y, linear.z + up)

    def _on_position_control(self, message: Any) -> None:
        self._by_position = bool(message.data)

    def _on_mode(self, message: Any) -> None:
        self._by_velocity = bool(message.data)
        self._modes.publish(self._String("velocity" if self._by_velocity else "position"))

    def _on_takeoff(self, _: Any) -> None:
        if self._stage == "landed":
            self._begin("taking off")

    def _on_land(self, _: Any) -> None:
        if self._stage in ("flying", "taking off"):
            self._begin("landing")

    def _begin(self, stage: Stage) -> None:
        self._stage, self._stage_seconds = stage, 0.0
        self.part.count_command()

    def _control(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        self._stage_seconds += seconds
        following = _NEXT.get(self._stage)
        if following is not None and self._stage_seconds > following[1]:
            self._stage, self._stage_seconds = following[0], 0.0
        self._states.publish(self._Int8(_NUMBERS[self._stage]))
        motion = self._flight.motion(seconds)
        place = self._flight.link.pose
        self._publish(place, motion)
        force, torque = self._wanted(motion, place, seconds)
        factor = _FACTORS[self._stage]
        x, y, z = torque
        self._flight.apply(factor * force, (factor * x, factor * y, factor * z))

    def _wanted(self, motion: Motion, place: Placement, seconds: float) -> tuple[float, Vec3]:
        """Returns the force along z and the torque that follow the command."""
        flight, (x, y, z), (about_x, about_y, turn) = self._flight, self._linear, self._angular
        if self._by_position:
            if self._stage != "flying":
                return 0.0, _STILL
            here_x, here_y, here_z = place.position
            east = self._x.update(x, here_x, 0.0, seconds)
            north = self._y.update(y, here_y, 0.0, seconds)
            climb = self._z.update(z, here_z, 0.0, seconds)
            back = quat_from_axis_angle(_UP, -yaw_of(place.orientation))
            ahead, left, _ = rotate(back, (east, north, 0.0))
            tilt = flight.tilt_for(motion, ahead, left, seconds)
            return flight.lift(motion, climb, seconds), tilt
        if self._stage == "flying":
            tilt = flight.tilt_for(motion, x, y, seconds)
        elif self._by_velocity:
            tilt = flight.tilt_for(motion, about_x, about_y, seconds)
        else:
            tilt = flight.tilt(motion, about_x, about_y, seconds)
        return flight.lift(motion, z, seconds), (
            tilt[0],
            tilt[1],
            flight.turn(motion, turn, seconds),
        )

    def _publish(self, place: Placement, motion: Motion) -> None:
        """Publishes the true pose, and velocity and acceleration in the axes of the link."""
        if self._poses.wanted:
            x, y, z, w = place.orientation
            at = self._Point(*place.position)
            self._poses.publish(self._Pose(at, self._Quaternion(x, y, z, w)))
        turn = quat_conjugate(place.orientation)
        heading = quat_from_axis_angle(_UP, yaw_of(place.orientation))
        for publisher, vector in (
            (self._velocities, motion.velocity),
            (self._accelerations, motion.acceleration),
        ):
            if publisher.wanted:
                linear = self._Vector3(*rotate(turn, rotate(heading, vector)))
                publisher.publish(self._Twist(linear, self._Vector3(*_STILL)))
