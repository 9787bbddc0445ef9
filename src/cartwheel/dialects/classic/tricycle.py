"""``libgazebo_ros_tricycle_drive.so``: one driven and steered wheel, and two that roll freely."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.devices.drives.odometry import Odometry, OdometryConfig, planar_covariance
from cartwheel.devices.drives.reckoning import AxleReckoning
from cartwheel.devices.joints.states import JointStates, JointStatesConfig
from cartwheel.dialects.steered_drive import SteeredDrive, toward
from cartwheel.dialects.tags import tag, tags_of
from cartwheel.geometry import Quat, Vec3

_QUARTER = math.pi / 2


@dataclass(frozen=True, kw_only=True, slots=True)
class TricycleParameters:
    steering_joint: str = tag(
        "steeringJoint",
        "steering_joint",
        default="front_steering_joint",
        doc="Joint that steers the driven wheel.",
    )
    wheel_joint: str = tag(
        "actuatedWheelJoint",
        "actuated_wheel_joint",
        default="front_wheel_joint",
        doc="Joint of the driven wheel.",
    )
    left_joint: str = tag(
        "encoderWheelLeftJoint",
        "encoder_wheel_left_joint",
        default="left_wheel_joint",
        doc="Joint of the left passive wheel.",
    )
    right_joint: str = tag(
        "encoderWheelRightJoint",
        "encoder_wheel_right_joint",
        default="right_wheel_joint",
        doc="Joint of the right passive wheel.",
    )
    wheel_diameter: float = tag(
        "actuatedWheelDiameter",
        "actuated_wheel_diameter",
        default=0.15,
        unit="m",
        doc="Diameter of the driven wheel.",
    )
    encoder_diameter: float = tag(
        "encoderWheelDiameter",
        "encoder_wheel_diameter",
        default=0.15,
        unit="m",
        doc="Diameter of the passive wheels.",
    )
    encoder_separation: float = tag(
        "encoderWheelSeparation",
        "wheel_separation",
        default=0.5,
        unit="m",
        doc="Distance between the passive wheels.",
    )
    wheel_torque: float | None = tag(
        "wheelTorque",
        "max_wheel_torque",
        default=None,
        unit="N m",
        doc="Maximum torque of each motor. Default: 5, or 0.15 if the plugin tag is written "
        "for ROS 2.",
    )
    wheel_acceleration: float = tag(
        "wheelAcceleration",
        "max_wheel_acceleration",
        default=0.0,
        unit="rad/s²",
        doc="Maximum acceleration of the driven wheel. 0: no limit.",
    )
    wheel_deceleration: float | None = tag(
        "wheelDeceleration",
        "max_wheel_deceleration",
        default=None,
        unit="rad/s²",
        doc="Maximum deceleration of the driven wheel. Has no effect without "
        "`<wheelAcceleration>`. Default: `<wheelAcceleration>`.",
    )
    wheel_tolerance: float = tag(
        "wheelSpeedTolerance",
        "max_wheel_speed_tolerance",
        default=0.01,
        unit="rad/s",
        doc="No effect: the wheel reaches the commanded speed exactly.",
    )
    steering_speed: float = tag(
        "steeringSpeed",
        "max_steering_speed",
        default=0.0,
        unit="rad/s",
        doc="Maximum steering rate. 0: no limit.",
    )
    steering_tolerance: float = tag(
        "steeringAngleTolerance",
        "max_steering_angle_tolerance",
        default=0.01,
        unit="rad",
        doc="No effect: the steering reaches the commanded angle exactly.",
    )
    command_topic: str = tag(
        "commandTopic",
        default="cmd_vel",
        doc="Topic of the Twist commands. `linear.x` is the speed of the driven wheel in m/s; "
        "`angular.z` is its steering angle in rad.",
    )
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = tag(
        "odometryFrame", "odometry_frame", default="odom", doc="Frame ID of the odometry."
    )
    base_frame: str = tag(
        "robotBaseFrame",
        "robot_base_frame",
        default="base_link",
        doc="Link whose pose the odometry reports. If no link has this name, the root link "
        "is used.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=100.0,
        unit="Hz",
        doc="Rate of the control loop and of the topics. 0: every step.",
    )
    source: Literal["world", "encoder", "0", "1"] = tag(
        "odometrySource",
        "odometry_source",
        default="world",
        doc="Source of the odometry. `world` (or `1`): ground-truth pose in the world; `encoder` "
        "(or `0`): dead reckoning from the passive wheels.",
    )
    publish_odom: bool | None = tag(
        "publish_odom",
        default=None,
        doc="Publish the odometry and its transform. Default: `true`, or `false` if the "
        "plugin tag is written for ROS 2.",
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF",
        "publish_wheel_tf",
        default=False,
        doc="Publish the transforms of the joints.",
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        "publish_wheel_joint_state",
        default=False,
        doc="Publish the joint states on `joint_states`.",
    )


_ROS2 = {"ros"} | {name for name in tags_of(TricycleParameters) if name.islower()}
"""Tags of ROS 2's plugin: unlike those of ROS 1, they contain no capital letters."""


class TricycleDrive(SteeredDrive):
    """Drives a tricycle with one driven, steered wheel from Twist commands and publishes odometry.

    A plugin tag that contains ``<ros>`` or lower-case tags, such as ``<steering_joint>``, counts as
    written for ROS 2, any other as written for ROS 1. For ROS 1, the model's name is the namespace
    of the topics if the model is part of a world file and ``<robotNamespace>`` is missing. Original
    plugin: ``gazebo_ros_tricycle_drive`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_tricycle_drive.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True
    parameters: ClassVar[type] = TricycleParameters

    def configure(self) -> None:
        config: TricycleParameters = self.config
        origin, part = self.tag.origin, self.part
        # The ROS 2 plugin with the same name publishes only what its tags enable, has less torque,
        # and does not put its topics below the model's name.
        ros2 = any(child.tag in _ROS2 for child in self.tag.element.children)
        if not ros2:
            self.under_model()
        publishes = not ros2 if config.publish_odom is None else config.publish_odom
        torque = config.wheel_torque
        if torque is None:
            torque = 0.15 if ros2 else 5.0
        self.check_above_zero(wheelTorque=torque)
        self.check_lengths(
            actuatedWheelDiameter=config.wheel_diameter,
            encoderWheelDiameter=config.encoder_diameter,
            encoderWheelSeparation=config.encoder_separation,
        )
        names = (config.steering_joint, config.wheel_joint, config.left_joint, config.right_joint)
        joints = [part.joint(name, origin=origin) for name in names]
        # Gazebo subtracts in the opposite order, so its odometry is mirrored.
        self._reckoning = AxleReckoning(
            joints[2],
            joints[3],
            radius=config.encoder_diameter / 2,
            separation=config.encoder_separation,
        )
        # Without a steering speed, Gazebo sets the angle immediately, with unlimited torque.
        strength = torque if config.steering_speed > 0 else None
        self._fork = part.servo(config.steering_joint, max_effort=strength, origin=origin)
        self._motor = part.velocity_motor(config.wheel_joint, max_effort=torque, origin=origin)
        self._encoded = config.source in ("encoder", "0")
        rate = config.update_rate
        self.odometry = self.add(
            Odometry(
                self.scope,
                OdometryConfig(
                    topic=config.odometry_topic if publishes else None,
                    frame=config.odometry_frame,
                    base=config.base_frame,
                    rate=rate,
                    transform=publishes,
                    joints=names if config.publish_wheel_tf else (),
                    pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
                ),
            )
        )
        if config.publish_joint_state:
            states = JointStatesConfig(joints=names, rate=rate, velocities=True, efforts=True)
            self.joint_states = self.add(JointStates(self.scope, states))
        self._run(
            command_topic=config.command_topic,
            base=config.base_frame,
            control_rate=rate,
            rate=rate,
        )

    def reset(self) -> None:
        super().reset()
        self._speed = self._angle = 0.0
        self._reckoning.begin()

    def _turn_wheels(self, seconds: float) -> None:
        config: TricycleParameters = self.config
        target = self._forward / (config.wheel_diameter / 2)
        slows = abs(target) < abs(self._speed)
        ramp = config.wheel_acceleration
        if slows and config.wheel_deceleration is not None and ramp > 0:
            ramp = config.wheel_deceleration
        self._speed = toward(self._speed, target, ramp * seconds) if ramp > 0 else target
        self._motor.command(self._speed)
        angle = min(max(self._turn, -_QUARTER), _QUARTER)
        swing = config.steering_speed
        self._angle = toward(self._angle, angle, swing * seconds) if swing > 0 else angle
        self._fork.command_position(self._angle)
        if self._encoded:
            self._reckoning.read(seconds)

    def _motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        if self._encoded:
            return self._reckoning.motion()
        return super()._motion()
