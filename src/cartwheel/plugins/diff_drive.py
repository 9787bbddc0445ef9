"""``libgazebo_ros_diff_drive.so``: two driven wheels, odometry, TF and joint states."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from cartwheel.errors import Diagnostic, PluginError
from cartwheel.geometry import Quat, Vec3, yaw_of
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.parameters import tag

_COVARIANCE = np.diag([1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3]).ravel()
_NO_COVARIANCE = np.zeros(36)
_NOTHING = np.zeros(0)


@dataclass(frozen=True, kw_only=True, slots=True)
class DiffDriveParameters:
    left_joint: str = tag(
        "leftJoint", "left_joint", default="left_joint", doc="Joint of the left wheel."
    )
    right_joint: str = tag(
        "rightJoint", "right_joint", default="right_joint", doc="Joint of the right wheel."
    )
    wheel_separation: float = tag(
        "wheelSeparation", "wheel_separation", default=0.34, unit="m", doc="Between the wheels."
    )
    wheel_diameter: float = tag(
        "wheelDiameter", "wheel_diameter", default=0.15, unit="m", doc="Of both wheels."
    )
    wheel_torque: float = tag(
        "wheelTorque",
        "max_wheel_torque",
        "torque",
        default=5.0,
        unit="N m",
        doc="The most that each wheel's motor gives. Gazebo 11 does not read torque.",
    )
    wheel_acceleration: float = tag(
        "wheelAcceleration",
        "max_wheel_acceleration",
        default=0.0,
        unit="m/s²",
        doc="Ramp of the wheels' commanded rim speed; 0 is none.",
    )
    command_topic: str = tag(
        "commandTopic", "command_topic", default="cmd_vel", doc="Twist that drives."
    )
    odometry_topic: str = tag("odometryTopic", "odometry_topic", default="odom", doc="Odometry.")
    odometry_frame: str = tag(
        "odometryFrame", "odometry_frame", default="odom", doc="Frame of the odometry."
    )
    base_frame: str = tag(
        "robotBaseFrame",
        "robot_base_frame",
        default="base_footprint",
        doc="Link whose pose is told; the root link where there is none of that name.",
    )
    update_rate: float = tag(
        "updateRate", "update_rate", default=100.0, unit="Hz", doc="Of control and topics."
    )
    source: Literal["world", "encoder", "0", "1"] = tag(
        "odometrySource",
        "odometry_source",
        default="world",
        doc="world: the true pose; encoder: what the wheels' turning gives.",
    )
    publish_tf: bool = tag(
        "publishTf", "publishTF", default=True, doc="Publish odometry and its transform."
    )
    publish_odom: bool = tag("publish_odom", default=True, doc="Publish odometry (ROS 2 spelling).")
    publish_odom_tf: bool = tag(
        "publishOdomTF", "publish_odom_tf", default=True, doc="Publish odometry's transform."
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF", "publish_wheel_tf", default=False, doc="Publish the wheels' transforms."
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        default=False,
        doc="Publish the wheels' positions on joint_states.",
    )
    legacy_mode: bool = tag(
        "legacyMode", default=False, doc="Turn the other way, as an old release did."
    )


class DiffDrive(Plugin[DiffDriveParameters]):
    """Drives two wheels by Twist, and tells where that took the robot.

    Each wheel is a velocity servo that gives at most `wheel_torque`; a command holds until
    the next one. Source: gazebo_plugins, gazebo_ros_diff_drive.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_diff_drive.so",)
    parameters: ClassVar[type] = DiffDriveParameters

    def configure(self) -> None:
        config = self.config
        origin = self.tag.origin
        for value, what in (
            (config.wheel_separation, "wheelSeparation"),
            (config.wheel_diameter, "wheelDiameter"),
            (config.wheel_torque, "wheelTorque"),
        ):
            if value <= 0:
                raise PluginError(f"<{what}> {value:g} must be above 0", origin=origin)
        if config.wheel_acceleration < 0 or config.update_rate < 0:
            raise PluginError("an acceleration or rate cannot be below 0", origin=origin)
        if self.tag.element.find("torque") and not self.tag.element.find("wheelTorque"):
            self.part.report(
                Diagnostic(
                    severity="info",
                    message="<torque> is read as <wheelTorque>; Gazebo 11 would take 5 N m",
                    origin=origin,
                )
            )
        part = self.part
        self._joints = [
            part.joint(name, origin=origin) for name in (config.left_joint, config.right_joint)
        ]
        self._motors = [
            part.velocity_motor(handle.name, max_effort=config.wheel_torque, origin=origin)
            for handle in self._joints
        ]
        description = part.description
        known = description.link(config.base_frame) is not None
        self._base = part.link(config.base_frame if known else description.canonical_link)
        made = {joint.name: joint for joint in description.joints}
        self._wheels = [
            (handle, made[handle.name].parent, made[handle.name].child) for handle in self._joints
        ]
        self._names = [config.right_joint, config.left_joint]
        self._encoded = config.source in ("encoder", "0")
        self._load_classes()
        rate = config.update_rate
        tells = config.publish_tf and config.publish_odom
        self._odometry = (
            self.advertise(config.odometry_topic, "nav_msgs/msg/Odometry", rate=rate)
            if tells
            else None
        )
        transforms = (config.publish_tf and config.publish_odom_tf) or config.publish_wheel_tf
        self._tf = (
            self.advertise("/tf", "tf2_msgs/msg/TFMessage", rate=rate) if transforms else None
        )
        self._joint_states = (
            self.advertise("joint_states", "sensor_msgs/msg/JointState", rate=rate)
            if config.publish_joint_state
            else None
        )
        told = (self._odometry, self._tf, self._joint_states)
        self._publishers = [publisher for publisher in told if publisher is not None]
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        part.schedule(rate, before=self._control)
        part.schedule(rate, after=self._publish, active=self._wanted)
        self._radius = config.wheel_diameter / 2
        self.reset()

    def reset(self) -> None:
        self._target = [0.0, 0.0]
        self._ramped = [0.0, 0.0]
        self._updated_ns: int | None = None
        self._turned: list[float] | None = None
        self._x = self._y = self._heading = 0.0
        self._speed = self._turn_rate = 0.0
        for motor in self._motors:
            motor.target = 0.0

    def _load_classes(self) -> None:
        self._Odometry = message_class("nav_msgs/msg/Odometry")
        self._PoseWithCovariance = message_class("geometry_msgs/msg/PoseWithCovariance")
        self._TwistWithCovariance = message_class("geometry_msgs/msg/TwistWithCovariance")
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Twist = message_class("geometry_msgs/msg/Twist")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")
        self._TFMessage = message_class("tf2_msgs/msg/TFMessage")
        self._JointState = message_class("sensor_msgs/msg/JointState")

    def _on_command(self, message: Any) -> None:
        forward, turn = float(message.linear.x), float(message.angular.z)
        if not (math.isfinite(forward) and math.isfinite(turn)):
            self.warn("a command that is not finite was ignored")
            return
        rim = turn * self.config.wheel_separation / 2
        if self.config.legacy_mode:
            rim = -rim
        self._target = [forward - rim, forward + rim]

    def _control(self) -> None:
        """Ramps the rim speeds towards the command; integrates the encoders."""
        now = self.part.time_ns
        seconds = 0.0 if self._updated_ns is None else (now - self._updated_ns) * 1e-9
        self._updated_ns = now
        ramp = self.config.wheel_acceleration
        limit = ramp * seconds
        for index, motor in enumerate(self._motors):
            target, ramped = self._target[index], self._ramped[index]
            if target != ramped:
                ramped = ramped + min(max(target - ramped, -limit), limit) if ramp > 0 else target
                self._ramped[index] = ramped
            motor.command(ramped / self._radius)
        if self._encoded:
            self._integrate(seconds)

    def _integrate(self, seconds: float) -> None:
        turned = [joint.position for joint in self._joints]
        if self._turned is not None:
            left, right = (
                (new - old) * self._radius for new, old in zip(turned, self._turned, strict=True)
            )
            forward, turn = (left + right) / 2, (right - left) / self.config.wheel_separation
            # Along the chord of the arc: exact for constant wheel speeds.
            chord = forward * (math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0)
            self._x += chord * math.cos(self._heading + turn / 2)
            self._y += chord * math.sin(self._heading + turn / 2)
            self._heading += turn
            if seconds > 0:
                self._speed, self._turn_rate = forward / seconds, turn / seconds
        self._turned = turned

    def _wanted(self) -> bool:
        for publisher in self._publishers:  # noqa: SIM110 - any() costs more than the answer
            if publisher.wanted:
                return True
        return False

    def _publish(self) -> None:
        # The path of most messages. Fields are given by position, in the order of their
        # definition, and parts that say the same are one object: both halve its cost.
        now = self.part.time_ns
        config = self.config
        if self._joint_states is not None and self._joint_states.wanted:
            left, right = self._joints
            positions = np.array((right.position, left.position))
            self._joint_states.publish(
                self._JointState(header(now, ""), self._names, positions, _NOTHING, _NOTHING)
            )
        odometry = self._odometry is not None and self._odometry.wanted
        transforms = self._tf is not None and self._tf.wanted
        if not (odometry or transforms):
            return
        (x, y, z), turn, forward, sideways, turn_rate = self._state()
        Vector3 = self._Vector3
        head, rotation = header(now, config.odometry_frame), self._Quaternion(*turn)
        if transforms:
            assert self._tf is not None
            TransformStamped, Transform = self._TransformStamped, self._Transform
            sent = []
            if config.publish_tf and config.publish_odom_tf:
                moved = Transform(Vector3(x, y, z), rotation)
                sent.append(TransformStamped(head, config.base_frame, moved))
            if config.publish_wheel_tf:
                for joint, parent, child in self._wheels:
                    place, (qx, qy, qz, qw) = joint.child_place()
                    moved = Transform(Vector3(*place), self._Quaternion(qx, qy, qz, qw))
                    sent.append(TransformStamped(header(now, parent), child, moved))
            self._tf.publish(self._TFMessage(sent))
        if odometry:
            assert self._odometry is not None
            pose = self._Pose(self._Point(x, y, z), rotation)
            twist = self._Twist(Vector3(forward, sideways, 0.0), Vector3(0.0, 0.0, turn_rate))
            self._odometry.publish(
                self._Odometry(
                    head,
                    config.base_frame,
                    self._PoseWithCovariance(pose, _COVARIANCE),
                    self._TwistWithCovariance(twist, _NO_COVARIANCE),
                )
            )

    def _state(self) -> tuple[Vec3, Quat, float, float, float]:
        """Place in the odometry frame; forward and sideways speed in m/s; turning in rad/s."""
        if self._encoded:
            half = self._heading / 2
            turned: Quat = (0.0, 0.0, math.sin(half), math.cos(half))
            return (self._x, self._y, 0.0), turned, self._speed, 0.0, self._turn_rate
        place, turned = self._base.place()
        (vx, vy, _), (_, _, turn_rate) = self._base.motion(local=False)
        yaw = yaw_of(turned)
        cos, sin = math.cos(yaw), math.sin(yaw)
        return place, turned, cos * vx + sin * vy, cos * vy - sin * vx, turn_rate
