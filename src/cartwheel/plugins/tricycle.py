"""``libgazebo_ros_tricycle_drive.so``: one wheel that drives and steers, two that roll."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.geometry import Quat, Vec3
from cartwheel.plugins.odometry import AxleReckoning, Odometry, planar_covariance
from cartwheel.plugins.parameters import tag, tags_of
from cartwheel.plugins.steered_drive import SteeredDrive, toward
from cartwheel.plugins.wheel_states import JointStates, WheelTransforms

_QUARTER = math.pi / 2


@dataclass(frozen=True, kw_only=True, slots=True)
class TricycleParameters:
    steering_joint: str = tag(
        "steeringJoint",
        "steering_joint",
        default="front_steering_joint",
        doc="Turns the driven wheel's fork.",
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
        doc="Joint of the left rolling wheel.",
    )
    right_joint: str = tag(
        "encoderWheelRightJoint",
        "encoder_wheel_right_joint",
        default="right_wheel_joint",
        doc="Joint of the right rolling wheel.",
    )
    wheel_diameter: float = tag(
        "actuatedWheelDiameter",
        "actuated_wheel_diameter",
        default=0.15,
        unit="m",
        doc="Of the driven wheel.",
    )
    encoder_diameter: float = tag(
        "encoderWheelDiameter",
        "encoder_wheel_diameter",
        default=0.15,
        unit="m",
        doc="Of the rolling wheels.",
    )
    encoder_separation: float = tag(
        "encoderWheelSeparation",
        "wheel_separation",
        default=0.5,
        unit="m",
        doc="Between the rolling wheels.",
    )
    wheel_torque: float | None = tag(
        "wheelTorque",
        "max_wheel_torque",
        default=None,
        unit="N m",
        doc="The most that each motor gives; 5, and 0.15 in ROS 2's spelling.",
    )
    wheel_acceleration: float = tag(
        "wheelAcceleration",
        "max_wheel_acceleration",
        default=0.0,
        unit="rad/s²",
        doc="Ramp of the driven wheel's turning; 0 is none.",
    )
    wheel_deceleration: float | None = tag(
        "wheelDeceleration",
        "max_wheel_deceleration",
        default=None,
        unit="rad/s²",
        doc="The same towards a stand; as wheelAcceleration when missing.",
    )
    wheel_tolerance: float = tag(
        "wheelSpeedTolerance",
        "max_wheel_speed_tolerance",
        default=0.01,
        unit="rad/s",
        doc="Accepted: the ramp ends exactly.",
    )
    steering_speed: float = tag(
        "steeringSpeed",
        "max_steering_speed",
        default=0.0,
        unit="rad/s",
        doc="Of the fork; 0 is at once.",
    )
    steering_tolerance: float = tag(
        "steeringAngleTolerance",
        "max_steering_angle_tolerance",
        default=0.01,
        unit="rad",
        doc="Accepted: the angle is exact.",
    )
    command_topic: str = tag(
        "commandTopic",
        default="cmd_vel",
        doc="Twist: linear.x is the driven wheel's speed, angular.z its steering angle in rad.",
    )
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Odometry.")
    odometry_frame: str = tag(
        "odometryFrame", "odometry_frame", default="odom", doc="Frame of the odometry."
    )
    base_frame: str = tag(
        "robotBaseFrame",
        "robot_base_frame",
        default="base_link",
        doc="Link whose pose is told; the root link where there is none of that name.",
    )
    update_rate: float = tag(
        "updateRate", "update_rate", default=100.0, unit="Hz", doc="Of control and topics."
    )
    source: Literal["world", "encoder", "0", "1"] = tag(
        "odometrySource",
        "odometry_source",
        default="world",
        doc="world or 1: the true pose; encoder or 0: what the rolling wheels' turning gives.",
    )
    publish_odom: bool | None = tag(
        "publish_odom",
        default=None,
        doc="Publish odometry and its transform; true, and false in ROS 2's spelling.",
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF",
        "publish_wheel_tf",
        default=False,
        doc="Publish the joints' transforms.",
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        "publish_wheel_joint_state",
        default=False,
        doc="Publish the joints on joint_states.",
    )


_ROS2 = {"ros"} | {name for name in tags_of(TricycleParameters) if name.islower()}
"""What is written for ROS 2's plugin alone: its tags have no capitals, and ROS 1's have."""


class TricycleDrive(SteeredDrive):
    """Drives and steers one wheel by Twist, and tells where that took the robot.

    In ROS 1's spelling, in a model of a world, its topics are under the model's name where no
    ``<robotNamespace>`` is stated. Source: gazebo_plugins, gazebo_ros_tricycle_drive.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_tricycle_drive.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True
    parameters: ClassVar[type] = TricycleParameters

    def configure(self) -> None:
        config: TricycleParameters = self.config
        origin, part = self.tag.origin, self.part
        # ROS 2's plugin of the same name publishes only what it is told to, and is weaker; its
        # topics are under no model's name.
        ros2 = any(child.tag in _ROS2 for child in self.tag.element.children)
        if not ros2:
            self.under_model()
        told = not ros2 if config.publish_odom is None else config.publish_odom
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
        # Gazebo takes the difference the other way round, and its odometry turns mirrored.
        self._reckoning = AxleReckoning(
            joints[2],
            joints[3],
            radius=config.encoder_diameter / 2,
            separation=config.encoder_separation,
        )
        # Gazebo sets the angle at once where no speed is given: nothing limits its torque.
        strength = torque if config.steering_speed > 0 else None
        self._fork = part.servo(config.steering_joint, max_effort=strength, origin=origin)
        self._motor = part.velocity_motor(config.wheel_joint, max_effort=torque, origin=origin)
        self._encoded = config.source in ("encoder", "0")
        rate = config.update_rate
        self.odometry = self.keep(
            Odometry(
                self,
                topic=config.odometry_topic if told else None,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=rate,
                transform=told,
                wheels=WheelTransforms(self, joints) if config.publish_wheel_tf else None,
                pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
            )
        )
        if config.publish_joint_state:
            self.joint_states = JointStates(self, joints, rate=rate, velocities=True, efforts=True)
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
