"""``libgazebo_ros_ackermann_drive.so``: a car."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices, running
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Capsule, Cylinder, Sphere
from cartwheel.devices.drives.ackermann import AckermannDrive, AckermannDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import joint_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class AckermannParameters:
    front_left: str = joint_tag(
        "front_left_joint", role="other_joint", doc="Joint of the front left wheel."
    )
    front_right: str = joint_tag(
        "front_right_joint", role="other_joint", doc="Joint of the front right wheel."
    )
    rear_left: str = joint_tag("rear_left_joint", doc="Joint of the driven rear left wheel.")
    rear_right: str = joint_tag("rear_right_joint", doc="Joint of the driven rear right wheel.")
    steer_left: str = joint_tag(
        "left_steering_joint", role="steering", doc="Joint that steers the front left wheel."
    )
    steer_right: str = joint_tag(
        "right_steering_joint", role="steering", doc="Joint that steers the front right wheel."
    )
    steering_wheel: str = joint_tag(
        "steering_wheel_joint",
        optional=True,
        doc="Joint of the steering wheel, which turns in proportion to the steering angle. "
        "Ignored if the model has no joint with this name.",
    )
    max_steer: float = tag(
        "max_steer", default=0.6, unit="rad", doc="Maximum steering angle of the front wheels."
    )
    max_steering_angle: float = tag(
        "max_steering_angle",
        default=7.85,
        unit="rad",
        doc="Angle of the steering wheel when the front wheels are at `<max_steer>`.",
    )
    max_speed: float = tag("max_speed", default=20.0, unit="m/s", doc="Maximum commanded speed.")
    left_gain: tuple[float, float, float] | None = tag(
        "left_steering_pid_gain", default=None, doc="No effect: a position servo steers the wheel."
    )
    left_range: tuple[float, float] | None = tag(
        "left_steering_i_range", default=None, doc="No effect: a position servo steers the wheel."
    )
    right_gain: tuple[float, float, float] | None = tag(
        "right_steering_pid_gain", default=None, doc="No effect: a position servo steers the wheel."
    )
    right_range: tuple[float, float] | None = tag(
        "right_steering_i_range", default=None, doc="No effect: a position servo steers the wheel."
    )
    speed_gain: tuple[float, float, float] | None = tag(
        "linear_velocity_pid_gain", default=None, doc="No effect: velocity servos drive the wheels."
    )
    speed_range: tuple[float, float] | None = tag(
        "linear_velocity_i_range", default=None, doc="No effect: velocity servos drive the wheels."
    )
    update_rate: float = drive_tags.control_rate("update_rate", least=None)
    odometry_frame: str = drive_tags.odometry_frame("odometry_frame")
    base_frame: str = drive_tags.base_frame("robot_base_frame")
    publish_odom: bool = tag(
        "publish_odom", default=False, doc="Whether to publish the odometry on `odom`."
    )
    publish_odom_tf: bool = tag(
        "publish_odom_tf",
        default=False,
        doc="Whether to publish the transform from `<odometry_frame>` to the robot.",
    )
    publish_wheel_tf: bool = tag(
        "publish_wheel_tf",
        default=False,
        doc="Whether to publish the transforms of the wheel and steering joints.",
    )
    publish_distance: bool = tag(
        "publish_distance",
        default=False,
        doc="Whether to publish the travelled distance, in m, on `distance`.",
    )
    publish_steerangle: bool = tag(
        "publish_steerangle",
        default=False,
        doc="Whether to publish the mean steering angle of the front wheels, in rad, on "
        "`steerangle`.",
    )
    covariance_x: float = drive_tags.position_variance("covariance_x", 1e-5)
    covariance_y: float = drive_tags.position_variance("covariance_y", 1e-5)
    covariance_yaw: float = drive_tags.yaw_variance("covariance_yaw", 1e-3)


class ClassicAckermannDrive(Plugin[AckermannParameters]):
    """Drives the rear wheels and steers the front wheels of a car, as commanded by Twist messages.

    Commands are received on ``cmd_vel``. ``linear.x`` is the speed in m/s at the middle of the rear
    axle. ``angular.z`` is the steering angle in rad. While ``linear.x`` is negative, the sign of
    the steering angle is reversed. The odometry is the ground-truth pose in the world. The wheel
    radius, the wheel base and the track width are computed from the robot description. Original
    plugin: ``gazebo_ros_ackermann_drive`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ackermann_drive.so",)

    def configure(self) -> None:
        config = self.config
        radius, wheel_base, track = self._measure()
        names = (
            config.front_left, config.front_right, config.rear_left, config.rear_right,
            config.steer_left, config.steer_right,
        )  # fmt: skip
        # All joints must exist, including the front wheels, which the device does not command.
        for name in names:
            self.part.joint(name, origin=self.origin)
        wheel = self.part.description.joint(config.steering_wheel)
        joints = tuple(dict.fromkeys((*names, wheel.name) if wheel is not None else names))
        if config.left_gain or config.right_gain or config.speed_gain:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "PID gains have no effect: servos steer and drive within the joints' effort limits",
                severity="info",
            )
        covariance = drive_tags.covariance(config)
        odometry = OdometryConfig(
            topic="odom" if config.publish_odom else None,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=config.update_rate,
            transform=config.publish_odom_tf,
            joints=joints if config.publish_wheel_tf else (),
            pose_covariance=covariance,
            twist_covariance=covariance,
        )
        self.add(
            AckermannDrive(
                self.scope,
                AckermannDriveConfig(
                    left=(config.rear_left,),
                    right=(config.rear_right,),
                    steering_left=config.steer_left,
                    steering_right=config.steer_right,
                    radius=radius,
                    wheel_base=wheel_base,
                    driven_track=track,
                    steered_track=track,
                    max_steering=config.max_steer,
                    turn="steering angle",
                    speed_limits=Limits(velocity=(-config.max_speed, config.max_speed)),
                    turn_limits=Limits(),
                    steering_first=True,
                    steering_wheel=wheel.name if wheel is not None else None,
                    max_steering_wheel=config.max_steering_angle,
                    distance_topic="distance" if config.publish_distance else None,
                    angle_topic="steerangle" if config.publish_steerangle else None,
                    drive=DriveConfig(
                        command_topic="cmd_vel",
                        control_rate=config.update_rate,
                        odometry=odometry,
                    ),
                ),
            )
        )

    def _measure(self) -> tuple[float, float, float]:
        """Returns the wheel radius, the wheel base and the track, m, from the description.

        Raises:
            PluginError: One of them cannot be measured.
            UnknownNameError: A joint does not exist.
        """
        config = self.config
        description, origin = self.part.description, self.tag.origin
        poses = link_poses(description, {})
        centres = []
        for name in (config.front_left, config.front_right, config.rear_left, config.rear_right):
            joint = description.joint(name)
            link = description.link(joint.child) if joint is not None else None
            if link is None or not link.collisions:
                self.part.joint(name, origin=origin)
                raise PluginError(
                    f'the wheel of joint "{name}" has no collision, so its radius is unknown',
                    code=running.NOT_A_WHEEL,
                    origin=origin,
                    values={"joint": name},
                )
            collision = link.collisions[0]
            shape = collision.shape
            is_round = isinstance(shape, Cylinder | Sphere | Capsule)
            # The frame of a mesh can be anywhere, so the wheel is placed at its joint.
            place = collision.pose if is_round or joint is None else joint.pose
            centres.append(poses[link.name].apply(place.position))
        if not isinstance(shape, Cylinder | Sphere | Capsule):
            raise PluginError(
                f'the collision of the wheel of joint "{name}" is neither a cylinder nor a sphere, '
                "so its radius is unknown",
                code=running.NOT_A_WHEEL,
                origin=origin,
                values={"joint": name},
            )
        front_left, front_right, rear_left, rear_right = centres
        track = math.dist(front_left, front_right)
        front = [(a + b) / 2 for a, b in zip(front_left, front_right, strict=True)]
        rear = [(a + b) / 2 for a, b in zip(rear_left, rear_right, strict=True)]
        wheel_base = math.dist(front, rear)
        if wheel_base <= 0 or track <= 0:
            raise PluginError(
                "the wheel base and the track must be positive "
                f"(got {wheel_base:g} m and {track:g} m)",
                code=running.NOT_A_WHEEL,
                origin=origin,
            )
        return shape.radius, wheel_base, track
