"""``libgazebo_ros_tricycle_drive.so``: one driven and steered wheel, and two that roll freely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig, planar_covariance
from cartwheel.devices.drives.tricycle import TricycleDrive, TricycleDriveConfig
from cartwheel.devices.joints.states import JointStatesConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import size_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag, tags_of


@dataclass(frozen=True, kw_only=True, slots=True)
class TricycleParameters:
    steering_joint: str = tag(
        "steeringJoint",
        "steering_joint",
        default="front_steering_joint",
        role="steering",
        doc="Joint that steers the driven wheel.",
    )
    wheel_joint: str = tag(
        "actuatedWheelJoint",
        "actuated_wheel_joint",
        default="front_wheel_joint",
        role="joint",
        doc="Joint of the driven wheel.",
    )
    left_joint: str = tag(
        "encoderWheelLeftJoint",
        "encoder_wheel_left_joint",
        default="left_wheel_joint",
        role="other_joint",
        doc="Joint of the left passive wheel.",
    )
    right_joint: str = tag(
        "encoderWheelRightJoint",
        "encoder_wheel_right_joint",
        default="right_wheel_joint",
        role="other_joint",
        doc="Joint of the right passive wheel.",
    )
    wheel_diameter: float = size_tag(
        "actuatedWheelDiameter",
        "actuated_wheel_diameter",
        default=0.15,
        role="wheel_diameter",
        wheels=("wheel_joint",),
        doc="Diameter of the driven wheel.",
    )
    encoder_diameter: float = size_tag(
        "encoderWheelDiameter",
        "encoder_wheel_diameter",
        default=0.15,
        role="wheel_diameter",
        wheels=("left_joint", "right_joint"),
        doc="Diameter of the passive wheels.",
    )
    encoder_separation: float = size_tag(
        "encoderWheelSeparation",
        "wheel_separation",
        default=0.5,
        role="wheel_separation",
        wheels=("left_joint", "right_joint"),
        doc="Distance between the passive wheels.",
    )
    wheel_torque: float | None = tag(
        "wheelTorque",
        "max_wheel_torque",
        default=None,
        unit="N m",
        least=SMALLEST,
        doc="Maximum torque of each motor. Default: 5, or 0.15 if the `<plugin>` is written for "
        "ROS 2.",
    )
    wheel_acceleration: float = tag(
        "wheelAcceleration",
        "max_wheel_acceleration",
        default=0.0,
        unit="rad/s²",
        doc="Maximum acceleration of the driven wheel. If 0, there is no limit.",
    )
    wheel_deceleration: float | None = tag(
        "wheelDeceleration",
        "max_wheel_deceleration",
        default=None,
        unit="rad/s²",
        doc="Maximum deceleration of the driven wheel. It has no effect if "
        "`<wheelAcceleration>` is 0. Default: `<wheelAcceleration>`.",
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
        doc="Maximum speed of the steering joint. If 0, there is no limit.",
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
        doc="Topic of the Twist commands. `linear.x` is the rim speed of the driven wheel in "
        "m/s, and `angular.z` is its steering angle in rad.",
    )
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame", "odometry_frame")
    base_frame: str = drive_tags.base_frame(
        "robotBaseFrame", "robot_base_frame", default="base_link"
    )
    update_rate: float = drive_tags.control_rate("updateRate", "update_rate", least=None)
    source: Literal["world", "encoder", "0", "1"] = tag(
        "odometrySource",
        "odometry_source",
        default="world",
        doc="Source of the odometry: `world` (or `1`) is the ground-truth pose in the world, "
        "and `encoder` (or `0`) is dead reckoning from the rotation of the passive wheels.",
    )
    publish_odom: bool | None = tag(
        "publish_odom",
        default=None,
        doc="Whether to publish the odometry and its transform. Default: `true`, or `false` if "
        "the `<plugin>` is written for ROS 2.",
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF",
        "publish_wheel_tf",
        default=False,
        doc="Whether to publish the transforms of the wheel and steering joints.",
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        "publish_wheel_joint_state",
        default=False,
        doc="Whether to publish the states of the wheel and steering joints on `joint_states`.",
    )


_ROS2 = {"ros"} | {name for name in tags_of(TricycleParameters) if name.islower()}
"""Tags of ROS 2's plugin: unlike those of ROS 1, they contain no capital letters."""


class ClassicTricycleDrive(Plugin[TricycleParameters]):
    """Drives and steers a tricycle as commanded by Twist messages, and publishes odometry.

    One wheel is driven and steered. The other two wheels are passive.

    The ``<plugin>`` is treated as written for ROS 2 if it contains ``<ros>`` or lower-case tags,
    such as ``<steering_joint>``, and otherwise as written for ROS 1. With a ``<plugin>`` for ROS 1,
    the topics are in a namespace with the model's name if the model is part of a world file and
    there is no ``<robotNamespace>``. Original plugin: ``gazebo_ros_tricycle_drive`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_tricycle_drive.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        # The ROS 2 plugin with the same name publishes only what its tags enable, has less torque,
        # and does not put its topics below the model's name.
        ros2 = any(child.tag in _ROS2 for child in self.tag.element.children)
        if not ros2:
            self.under_model()
        publishes = not ros2 if config.publish_odom is None else config.publish_odom
        torque = config.wheel_torque
        if torque is None:
            torque = 0.15 if ros2 else 5.0
        names = (config.steering_joint, config.wheel_joint, config.left_joint, config.right_joint)
        rate, acceleration = config.update_rate, config.wheel_acceleration
        # Without a limit on the acceleration, a limit on the deceleration has no effect.
        deceleration = config.wheel_deceleration
        if deceleration is None or acceleration <= 0:
            deceleration = acceleration
        odometry = OdometryConfig(
            topic=config.odometry_topic if publishes else None,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=rate,
            transform=publishes,
            joints=names if config.publish_wheel_tf else (),
            pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
        )
        states = JointStatesConfig(joints=names, rate=rate, velocities=True, efforts=True)
        self.add(
            TricycleDrive(
                self.scope,
                TricycleDriveConfig(
                    wheel=config.wheel_joint,
                    steering=config.steering_joint,
                    left=config.left_joint,
                    right=config.right_joint,
                    wheel_radius=config.wheel_diameter / 2,
                    free_radius=config.encoder_diameter / 2,
                    separation=config.encoder_separation,
                    torque=torque,
                    acceleration=acceleration,
                    deceleration=deceleration,
                    steering_rate=config.steering_speed,
                    # Gazebo subtracts right from left: its odometry is mirrored, unlike this one.
                    encoded=config.source in ("encoder", "0"),
                    drive=DriveConfig(
                        command_topic=config.command_topic,
                        control_rate=rate,
                        odometry=odometry,
                        joint_states=states if config.publish_joint_state else None,
                    ),
                ),
            )
        )
