"""``libgazebo_ros_diff_drive.so``: differential drive with odometry, TF and joint states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.devices.drives.differential import (
    DifferentialDriveConfig,
    WheelPair,
)
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import NO_COVARIANCE, OdometryConfig
from cartwheel.devices.joints.states import JointStatesConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, wheel_pairs
from cartwheel.errors import PluginError

_TORQUE = 5.0
"""Default of the maximum torque of each wheel, N m."""
LEGACY_SWAPPED = (
    "Swap the two names, and remove <legacyMode>, which Gazebo ignores since ROS Melodic."
)
"""What to do if the wheels of a robot with ``<legacyMode>`` are swapped."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DiffDriveParameters:
    left_joint: tuple[str, ...] = tag(
        "leftJoint",
        "left_joint",
        default=("left_joint",),
        role="left_wheel",
        doc="Joint of the left wheel of a pair. Repeat the tag for each pair.",
    )
    right_joint: tuple[str, ...] = tag(
        "rightJoint",
        "right_joint",
        default=("right_joint",),
        role="right_wheel",
        doc="Joint of the right wheel of a pair. Repeat the tag for each pair.",
    )
    pairs: int = tag("num_wheel_pairs", default=1, doc="Number of wheel pairs.")
    wheel_separation: tuple[float, ...] = tag(
        "wheelSeparation",
        "wheel_separation",
        default=(0.34,),
        unit="m",
        role="wheel_separation",
        doc="Distance between the left and right wheels of a pair. Repeat the tag for each "
        "pair; the last value also applies to all further pairs.",
    )
    wheel_diameter: tuple[float, ...] = tag(
        "wheelDiameter",
        "wheel_diameter",
        default=(0.15,),
        unit="m",
        role="wheel_diameter",
        doc="Diameter of the wheels of a pair. Repeat the tag for each pair; the last value "
        "also applies to all further pairs.",
    )
    wheel_torque: float = tag(
        "wheelTorque",
        "max_wheel_torque",
        "torque",
        default=_TORQUE,
        unit="N m",
        role="wheel_torque",
        obsolete=("torque",),
        least=SMALLEST,
        doc="Maximum motor torque of each wheel. The spelling `<torque>` has no effect, as in "
        f"Gazebo 11, which uses {_TORQUE:g} N m instead.",
    )
    wheel_acceleration: float = tag(
        "wheelAcceleration",
        "max_wheel_acceleration",
        default=0.0,
        unit="m/s²",
        least=0.0,
        doc="Maximum acceleration of the wheel rims; it limits how fast the commanded wheel "
        "speeds change. If 0, there is no limit.",
    )
    command_topic: str = drive_tags.command_topic("commandTopic", "command_topic")
    odometry_topic: str = drive_tags.odometry_topic("odometryTopic", "odometry_topic")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame", "odometry_frame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame", "robot_base_frame")
    update_rate: float = drive_tags.control_rate("updateRate", "update_rate")
    source: Literal["world", "encoder", "0", "1"] = tag(
        "odometrySource",
        "odometry_source",
        default="world",
        doc="Source of the odometry: `world` (or `1`) is the ground-truth pose in the world, "
        "and `encoder` (or `0`) is dead reckoning from the rotation of the wheels.",
    )
    publish_tf: bool = tag(
        "publishTf",
        "publishTF",
        default=True,
        doc="Whether to publish the odometry and its transform. If false, `<publish_odom>` and "
        "`<publishOdomTF>` have no effect.",
    )
    publish_odom: bool | None = tag(
        "publish_odom",
        default=None,
        doc="Whether to publish the odometry as messages. Default: `true`, or `false` if the "
        "`<plugin>` is written for ROS 2.",
    )
    publish_odom_tf: bool | None = tag(
        "publishOdomTF",
        "publish_odom_tf",
        default=None,
        doc="Whether to publish the odometry as a transform on `/tf`. Default: `true`, or "
        "`false` if the `<plugin>` is written for ROS 2.",
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF",
        "publish_wheel_tf",
        default=False,
        doc="Whether to publish the transforms of the wheels.",
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        default=False,
        doc="Whether to publish the positions and velocities of the wheel joints on "
        "`joint_states`.",
    )
    covariance_x: float = drive_tags.position_variance("covariance_x", 1e-5)
    covariance_y: float = drive_tags.position_variance("covariance_y", 1e-5)
    covariance_yaw: float = drive_tags.yaw_variance("covariance_yaw", 1e-3)
    legacy_mode: bool = tag(
        "legacyMode",
        default=False,
        doc="No effect, as in Gazebo 11. The plugin of ROS Jade, Kinetic and Lunar swapped the "
        "left and the right wheel.",
    )


class DiffDrive(Plugin[DiffDriveParameters]):
    """Drives pairs of left and right wheels as commanded by Twist messages, and publishes odometry.

    Each wheel is driven by a velocity servo with the maximum torque ``<wheelTorque>``. A command
    stays in effect until the next command.

    The ``<plugin>`` is treated as written for ROS 2 if it contains ``<ros>``, ``<left_joint>`` or
    ``<right_joint>``, and otherwise as written for ROS 1. With a ``<plugin>`` for ROS 1, the topics
    are in a namespace with the model's name if the model is part of a world file and there is no
    ``<robotNamespace>``. Original plugin: ``gazebo_ros_diff_drive`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_diff_drive.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        element = self.tag.element
        torque = config.wheel_torque
        if element.find("torque") and not any(
            map(element.find, ("wheelTorque", "max_wheel_torque"))
        ):
            torque = _TORQUE
            self.warn(
                devices.PLUGIN_PARAMETER_OBSOLETE,
                f"Gazebo 11 ignores <torque>, so the wheel torque is {torque:g} N m",
                severity="info",
                values={"parameter": "torque", "torque": torque},
            )
        pairs = self._wheel_pairs()
        # The ROS 2 plugin of the same name publishes only on request, without the model's name.
        ros2 = any(element.find(name) for name in ("left_joint", "right_joint", "ros"))
        if not ros2:
            self.under_model()
        publishes_odom = not ros2 if config.publish_odom is None else config.publish_odom
        publishes_tf = not ros2 if config.publish_odom_tf is None else config.publish_odom_tf
        covariance = drive_tags.covariance(config)
        joints = tuple(name for pair in pairs for name in (pair.left, pair.right))
        odometry = OdometryConfig(
            topic=config.odometry_topic if config.publish_tf and publishes_odom else None,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=config.update_rate,
            transform=config.publish_tf and publishes_tf,
            joints=joints if config.publish_wheel_tf else (),
            pose_covariance=covariance,
            twist_covariance=covariance if ros2 else NO_COVARIANCE,
        )
        states = None
        if config.publish_joint_state:
            # In Gazebo's order: right before left.
            order = tuple(name for pair in pairs for name in (pair.right, pair.left))
            states = JointStatesConfig(joints=order, rate=config.update_rate)
        encoder = config.source in ("encoder", "0")
        add_differential_drive(
            self,
            DifferentialDriveConfig(
                pairs=pairs,
                max_torque=torque,
                acceleration=config.wheel_acceleration,
                odometry="positions" if encoder else "ground truth",
                drive=DriveConfig(
                    command_topic=config.command_topic,
                    control_rate=config.update_rate,
                    odometry=odometry,
                    joint_states=states,
                ),
            ),
            hint=LEGACY_SWAPPED if config.legacy_mode else "",
        )

    def _wheel_pairs(self) -> tuple[WheelPair, ...]:
        config = self.config
        lefts, rights = config.left_joint, config.right_joint
        if not len(lefts) == len(rights) == config.pairs:
            raise PluginError(
                f"the numbers of left and right wheel joints must equal the number of wheel pairs, "
                f"{config.pairs} (got {len(lefts)} left, {len(rights)} right)",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                hint="Set <num_wheel_pairs> to the number of pairs of left and right wheels.",
                values={"left": len(lefts), "right": len(rights)},
            )
        joints = [(left.strip(), right.strip()) for left, right in zip(lefts, rights, strict=True)]
        return wheel_pairs(self, joints, config.wheel_separation, config.wheel_diameter)
