"""``libgazebo_ros_diff_drive.so``: driven wheels in pairs, odometry, TF and joint states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.plugins.odometry import NO_COVARIANCE, Odometry, planar_covariance
from cartwheel.plugins.parameters import tag
from cartwheel.plugins.wheel_drive import WheelDrive, WheelPair
from cartwheel.plugins.wheel_states import JointStates, WheelTransforms


@dataclass(frozen=True, kw_only=True, slots=True)
class DiffDriveParameters:
    left_joint: tuple[str, ...] = tag(
        "leftJoint",
        "left_joint",
        default=("left_joint",),
        doc="Joint of the left wheel; once for each pair.",
    )
    right_joint: tuple[str, ...] = tag(
        "rightJoint",
        "right_joint",
        default=("right_joint",),
        doc="Joint of the right wheel; once for each pair.",
    )
    pairs: int = tag("num_wheel_pairs", default=1, doc="How many pairs there are.")
    wheel_separation: tuple[float, ...] = tag(
        "wheelSeparation",
        "wheel_separation",
        default=(0.34,),
        unit="m",
        doc="Between the wheels; once for each pair, the last counts for those that follow.",
    )
    wheel_diameter: tuple[float, ...] = tag(
        "wheelDiameter",
        "wheel_diameter",
        default=(0.15,),
        unit="m",
        doc="Of both wheels; once for each pair, the last counts for those that follow.",
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
    publish_odom: bool | None = tag(
        "publish_odom", default=None, doc="Publish odometry: ROS 2's, where false is the default."
    )
    publish_odom_tf: bool | None = tag(
        "publishOdomTF",
        "publish_odom_tf",
        default=None,
        doc="Publish odometry's transform; true, and false in ROS 2's spelling.",
    )
    publish_wheel_tf: bool = tag(
        "publishWheelTF", "publish_wheel_tf", default=False, doc="Publish the wheels' transforms."
    )
    publish_joint_state: bool = tag(
        "publishWheelJointState",
        default=False,
        doc="Publish the wheels' positions on joint_states.",
    )
    covariance_x: float = tag("covariance_x", default=1e-5, unit="m²", doc="Of the odometry.")
    covariance_y: float = tag("covariance_y", default=1e-5, unit="m²", doc="Of the odometry.")
    covariance_yaw: float = tag("covariance_yaw", default=1e-3, unit="rad²", doc="Of the odometry.")
    legacy_mode: bool = tag(
        "legacyMode", default=False, doc="Turn the other way, as an old release did."
    )


class DiffDrive(WheelDrive):
    """Drives pairs of wheels by Twist, and tells where that took the robot.

    Each wheel is a velocity servo that gives at most `wheel_torque`; a command holds until
    the next one. In ROS 1's spelling, in a model of a world, its topics are under the model's
    name where no ``<robotNamespace>`` is stated. Source: gazebo_plugins, gazebo_ros_diff_drive.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_diff_drive.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True
    parameters: ClassVar[type] = DiffDriveParameters

    def configure(self) -> None:
        config: DiffDriveParameters = self.config
        element = self.tag.element
        self.check_above_zero(wheelTorque=config.wheel_torque)
        if element.find("torque") and not element.find("wheelTorque"):
            self.warn(
                devices.PLUGIN_PARAMETER_OBSOLETE,
                "<torque> is read as <wheelTorque>; Gazebo 11 ignores it and uses 5 N m",
                severity="info",
                values={"parameter": "torque"},
            )
        self._take_wheels(self._wheel_pairs(), torque=config.wheel_torque)
        rate = config.update_rate
        # ROS 2's plugin of the same name publishes only what it is told to, under no model's name.
        ros2 = any(element.find(name) for name in ("left_joint", "right_joint", "ros"))
        if not ros2:
            self.under_model()
        told = not ros2 if config.publish_odom is None else config.publish_odom
        moved = not ros2 if config.publish_odom_tf is None else config.publish_odom_tf
        covariance = planar_covariance(
            config.covariance_x, config.covariance_y, config.covariance_yaw
        )
        self.odometry = self.keep(
            Odometry(
                self,
                topic=config.odometry_topic if config.publish_tf and told else None,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=rate,
                transform=config.publish_tf and moved,
                wheels=WheelTransforms(self, self.joints) if config.publish_wheel_tf else None,
                pose_covariance=covariance,
                twist_covariance=covariance if ros2 else NO_COVARIANCE,
            )
        )
        if config.publish_joint_state:
            # Gazebo's order, right before left.
            order = [self.joints[i ^ 1] for i in range(len(self.joints))]
            self.joint_states = JointStates(self, order, rate=rate)
        self._run_wheels(
            command_topic=config.command_topic,
            base=config.base_frame,
            encoded=config.source in ("encoder", "0"),
            control_rate=rate,
            rate=rate,
            acceleration=config.wheel_acceleration,
            reverse=config.legacy_mode,
        )

    def _wheel_pairs(self) -> list[WheelPair]:
        config: DiffDriveParameters = self.config
        lefts, rights = config.left_joint, config.right_joint
        if not len(lefts) == len(rights) == config.pairs:
            raise PluginError(
                f"{config.pairs} pairs of wheels need as many left and right joints "
                f"(got {len(lefts)} left, {len(rights)} right)",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                hint="<num_wheel_pairs> states the number of pairs.",
                values={"left": len(lefts), "right": len(rights)},
            )
        separations, diameters = config.wheel_separation, config.wheel_diameter
        return [
            WheelPair(
                left=left.strip(),
                right=right.strip(),
                separation=separations[min(index, len(separations) - 1)],
                diameter=diameters[min(index, len(diameters) - 1)],
            )
            for index, (left, right) in enumerate(zip(lefts, rights, strict=True))
        ]
