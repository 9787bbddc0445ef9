"""``libgazebo_ros_ackermann_drive.so`` and ``gz-sim-ackermann-steering-system``: car drives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices, running
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Capsule, Cylinder, Sphere
from cartwheel.devices.drives.limiter import Limiter
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig, planar_covariance
from cartwheel.devices.drives.reckoning import AxleReckoning
from cartwheel.dialects.gz.drive_tags import (
    GzLimitedParameters,
    gz_name,
    gz_odometry,
    report_limits,
    separate_limits,
)
from cartwheel.dialects.steered_drive import SteeredDrive
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import Quat, Vec3
from cartwheel.messages import message_class


def wheel_angles(steer: float, base: float, track: float) -> tuple[float, float]:
    """Returns the angles of the left and right steered wheels in rad, by Ackermann geometry.

    The axes of all four wheels intersect at the centre of the turn.

    Args:
        steer: Angle of a virtual wheel midway between the steered wheels, rad, positive to the
            left.
        base: Distance between the axles, m.
        track: Distance between the steered wheels, m.
    """
    tangent = math.tan(steer)
    half = track / 2 / base * tangent
    return math.atan2(tangent, 1 - half), math.atan2(tangent, 1 + half)


@dataclass(frozen=True, kw_only=True, slots=True)
class AckermannParameters:
    front_left: str = tag(
        "front_left_joint", default="front_left_joint", doc="Joint of the front left wheel."
    )
    front_right: str = tag(
        "front_right_joint", default="front_right_joint", doc="Joint of the front right wheel."
    )
    rear_left: str = tag(
        "rear_left_joint",
        default="rear_left_joint",
        doc="Joint of the driven rear left wheel.",
    )
    rear_right: str = tag(
        "rear_right_joint",
        default="rear_right_joint",
        doc="Joint of the driven rear right wheel.",
    )
    steer_left: str = tag(
        "left_steering_joint",
        default="left_steering_joint",
        doc="Joint that steers the front left wheel.",
    )
    steer_right: str = tag(
        "right_steering_joint",
        default="right_steering_joint",
        doc="Joint that steers the front right wheel.",
    )
    steering_wheel: str = tag(
        "steering_wheel_joint",
        default="steering_wheel_joint",
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
        "left_steering_i_range", default=None, doc="No effect."
    )
    right_gain: tuple[float, float, float] | None = tag(
        "right_steering_pid_gain", default=None, doc="No effect: a position servo steers the wheel."
    )
    right_range: tuple[float, float] | None = tag(
        "right_steering_i_range", default=None, doc="No effect."
    )
    speed_gain: tuple[float, float, float] | None = tag(
        "linear_velocity_pid_gain", default=None, doc="No effect: velocity servos drive the wheels."
    )
    speed_range: tuple[float, float] | None = tag(
        "linear_velocity_i_range", default=None, doc="No effect."
    )
    update_rate: float = tag(
        "update_rate",
        default=100.0,
        unit="Hz",
        doc="Rate of the control loop and of the topics. 0: every step.",
    )
    odometry_frame: str = tag("odometry_frame", default="odom", doc="Frame ID of the odometry.")
    base_frame: str = tag(
        "robot_base_frame",
        default="base_footprint",
        doc="Link whose pose the odometry reports. If no link has this name, the root link "
        "is used.",
    )
    publish_odom: bool = tag("publish_odom", default=False, doc="Publish the odometry on `odom`.")
    publish_odom_tf: bool = tag(
        "publish_odom_tf",
        default=False,
        doc="Publish the transform from the odometry frame to the base link.",
    )
    publish_wheel_tf: bool = tag(
        "publish_wheel_tf",
        default=False,
        doc="Publish the transforms of the wheel and steering joints.",
    )
    publish_distance: bool = tag(
        "publish_distance",
        default=False,
        doc="Publish the distance travelled, in m, on `distance`.",
    )
    publish_steerangle: bool = tag(
        "publish_steerangle",
        default=False,
        doc="Publish the mean steering angle of the front wheels, in rad, on `steerangle`.",
    )
    covariance_x: float = tag(
        "covariance_x", default=1e-5, unit="m²", doc="Variance of the odometry in x."
    )
    covariance_y: float = tag(
        "covariance_y", default=1e-5, unit="m²", doc="Variance of the odometry in y."
    )
    covariance_yaw: float = tag(
        "covariance_yaw", default=1e-3, unit="rad²", doc="Variance of the odometry in yaw."
    )


class AckermannDrive(SteeredDrive):
    """Drives the rear wheels and steers the front wheels of a car from Twist commands.

    Commands are received on ``cmd_vel``. ``linear.x`` is the speed in m/s at the middle of the rear
    axle. ``angular.z`` is the steering angle in rad. Its sign is inverted while ``linear.x`` is
    negative. The odometry is the ground-truth pose in the world. Wheel radius, wheel base and track
    are read from the robot description. Original plugin: ``gazebo_ros_ackermann_drive`` in the
    package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ackermann_drive.so",)
    parameters: ClassVar[type] = AckermannParameters

    def configure(self) -> None:
        config: AckermannParameters = self.config
        origin, part = self.tag.origin, self.part
        self._measure()
        names = [config.front_left, config.front_right, config.rear_left, config.rear_right]
        names += [config.steer_left, config.steer_right]
        joints = {name: part.joint(name, origin=origin) for name in names}
        self._steered = [joints[config.steer_left], joints[config.steer_right]]
        self._forks = [
            part.servo(name, max_effort=None, origin=origin)
            for name in (config.steer_left, config.steer_right)
        ]
        self._motors = [
            part.velocity_motor(name, max_effort=None, origin=origin)
            for name in (config.rear_left, config.rear_right)
        ]
        self._wheel = None
        if part.description.joint(config.steering_wheel) is not None:
            self._wheel = part.servo(config.steering_wheel, max_effort=None, origin=origin)
            joints[config.steering_wheel] = part.joint(config.steering_wheel)
        if config.left_gain or config.right_gain or config.speed_gain:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "PID gains have no effect: servos steer and drive within the joints' effort limits",
                severity="info",
            )
        rate = config.update_rate
        covariance = planar_covariance(
            config.covariance_x, config.covariance_y, config.covariance_yaw
        )
        self.odometry = self.add(
            Odometry(
                self.scope,
                OdometryConfig(
                    topic="odom" if config.publish_odom else None,
                    frame=config.odometry_frame,
                    base=config.base_frame,
                    rate=rate,
                    transform=config.publish_odom_tf,
                    joints=tuple(joints) if config.publish_wheel_tf else (),
                    pose_covariance=covariance,
                    twist_covariance=covariance,
                ),
            )
        )
        self._Float = message_class("std_msgs/msg/Float32")
        self._distance = (
            self.advertise("distance", "std_msgs/msg/Float32", rate=rate)
            if config.publish_distance
            else None
        )
        self._angle = (
            self.advertise("steerangle", "std_msgs/msg/Float32", rate=rate)
            if config.publish_steerangle
            else None
        )
        self._run(command_topic="cmd_vel", base=config.base_frame, control_rate=rate, rate=rate)

    def _measure(self) -> None:
        """Reads the wheel radius, track and wheel base from the description."""
        config: AckermannParameters = self.config
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
            round_one = isinstance(shape, Cylinder | Sphere | Capsule)
            # The frame of a mesh can be anywhere, so the wheel is placed at its joint.
            place = collision.pose if round_one or joint is None else joint.pose
            centres.append(poses[link.name].apply(place.position))
        if not isinstance(shape, Cylinder | Sphere | Capsule):
            raise PluginError(
                f'the collision of the wheel of joint "{name}" is neither a cylinder nor a sphere, '
                "so its radius is unknown",
                code=running.NOT_A_WHEEL,
                origin=origin,
                values={"joint": name},
            )
        self._radius = shape.radius
        front_left, front_right, rear_left, rear_right = centres
        self._track = math.dist(front_left, front_right)
        front = [(a + b) / 2 for a, b in zip(front_left, front_right, strict=True)]
        rear = [(a + b) / 2 for a, b in zip(rear_left, rear_right, strict=True)]
        self._wheel_base = math.dist(front, rear)
        if self._wheel_base <= 0 or self._track <= 0:
            raise PluginError(
                "the wheel base and the track must be positive "
                f"(got {self._wheel_base:g} m and {self._track:g} m)",
                code=running.NOT_A_WHEEL,
                origin=origin,
            )

    def reset(self) -> None:
        super().reset()
        self._travelled = 0.0
        self._last_position: tuple[float, float] | None = None

    def _turn_wheels(self, seconds: float) -> None:  # noqa: ARG002
        config: AckermannParameters = self.config
        speed = min(max(self._forward, -config.max_speed), config.max_speed)
        steer = self._turn * math.copysign(1.0, self._forward)
        steer = min(max(steer, -config.max_steer), config.max_steer)
        angles = wheel_angles(steer, self._wheel_base, self._track)
        for fork, angle in zip(self._forks, angles, strict=True):
            fork.command_position(angle)
        half = self._track / 2 / self._wheel_base * math.tan(steer)
        for motor, share in zip(self._motors, (1 - half, 1 + half), strict=True):
            motor.command(speed * share / self._radius)
        if self._wheel is not None:
            wheel = steer * config.max_steering_angle / config.max_steer
            self._wheel.command_position(wheel)
        if self._distance is not None:
            x, y, _ = self._base.place()[0]
            if self._last_position is not None:
                self._travelled += math.dist(self._last_position, (x, y))
            self._last_position = (x, y)

    def _wanted(self) -> bool:
        own = (self._distance, self._angle)
        return super()._wanted() or any(p is not None and p.wanted for p in own)

    def _publish(self) -> None:
        super()._publish()
        if self._distance is not None and self._distance.wanted:
            self._distance.publish(self._Float(self._travelled))
        if self._angle is not None and self._angle.wanted:
            left, right = self._steered
            self._angle.publish(self._Float((left.position + right.position) / 2))


@dataclass(frozen=True, kw_only=True, slots=True)
class GzAckermannParameters(GzLimitedParameters):
    left_joint: tuple[str, ...] = tag(
        "left_joint",
        default=("left_joint",),
        doc="Joint of a driven left wheel. Repeat the tag for each wheel.",
    )
    right_joint: tuple[str, ...] = tag(
        "right_joint",
        default=("right_joint",),
        doc="Joint of a driven right wheel. Repeat the tag for each wheel.",
    )
    steer_left: str = tag(
        "left_steering_joint",
        default="left_steering_joint",
        doc="Joint that steers the front left wheel.",
    )
    steer_right: str = tag(
        "right_steering_joint",
        default="right_steering_joint",
        doc="Joint that steers the front right wheel.",
    )
    wheel_separation: float = tag(
        "wheel_separation", default=1.0, unit="m", doc="Distance between the left and right wheels."
    )
    kingpin_width: float = tag(
        "kingpin_width", default=0.8, unit="m", doc="Distance between the steering axes."
    )
    wheel_base: float = tag(
        "wheel_base", default=1.0, unit="m", doc="Distance between the front and rear axles."
    )
    steering_limit: float = tag(
        "steering_limit", default=0.5, unit="rad", doc="Maximum steering angle."
    )
    wheel_radius: float = tag("wheel_radius", default=0.2, unit="m", doc="Radius of all wheels.")
    steer_gain: float = tag(
        "steer_p_gain", default=1.0, doc="No effect: a position servo steers the wheels."
    )
    sub_topic: str = tag(
        "sub_topic",
        default="",
        doc="Topic of the Twist commands, relative to `/model/<model>`. Used if `<topic>` "
        "is not set.",
    )
    steering_only: bool = tag("steering_only", default=False, doc="Not supported.")
    actuators: bool = tag("use_actuator_msg", default=False, doc="Not supported.")


class GzAckermann(SteeredDrive):
    """Drives and steers a car from Twist commands and publishes odometry from its wheels.

    ``linear.x`` is the speed in m/s, and ``angular.z`` the yaw rate in rad/s. The odometry is
    computed from the rotation of the driven wheels. Original plugin: ``AckermannSteering`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-ackermann-steering-system",)
    parameters: ClassVar[type] = GzAckermannParameters

    def configure(self) -> None:
        config: GzAckermannParameters = self.config
        origin, part = self.tag.origin, self.part
        self.check_lengths(
            wheel_base=config.wheel_base,
            wheel_separation=config.wheel_separation,
            kingpin_width=config.kingpin_width,
            wheel_radius=config.wheel_radius,
            steering_limit=config.steering_limit,
        )
        for flag, what in (
            (config.steering_only, "steering_only"),
            (config.actuators, "use_actuator_msg"),
        ):
            if flag:
                self.warn(
                    devices.PLUGIN_PARAMETER_IGNORED,
                    f"<{what}> has no effect: the car is driven by Twist messages",
                    values={"parameter": what},
                )
        report_limits(self, config)
        self._linear = Limiter(separate_limits(config, "linear"))
        self._angular = Limiter(separate_limits(config, "angular"))
        self._driven = [
            [(part.joint(name, origin=origin), part.velocity_motor(name, max_effort=None))
             for name in names]
            for names in (config.left_joint, config.right_joint)
        ]  # fmt: skip
        self._forks = [
            part.servo(name, max_effort=None, origin=origin)
            for name in (config.steer_left, config.steer_right)
        ]
        left, right = (side[0][0] for side in self._driven)
        self._reckoning = AxleReckoning(
            left, right, radius=config.wheel_radius, separation=config.wheel_separation
        )
        self.odometry = self.add(Odometry(self.scope, gz_odometry(self, config)))
        topic = config.topic or (
            f"/model/{part.name}/{config.sub_topic}" if config.sub_topic else ""
        )
        self._run(
            command_topic=gz_name(self, topic, "cmd_vel"),
            base="",
            control_rate=100.0,
            rate=config.rate,
        )

    def reset(self) -> None:
        super().reset()
        self._linear.reset()
        self._angular.reset()
        self._reckoning.begin()

    def _turn_wheels(self, seconds: float) -> None:
        config: GzAckermannParameters = self.config
        speed = self._linear.step(self._forward, seconds or 0.01)
        turn = self._angular.step(self._turn, seconds or 0.01)
        # A wheel in the middle of the front axle is perpendicular to the line to the turn's centre.
        steer = math.atan2(turn * config.wheel_base, abs(speed))
        steer = math.copysign(steer, turn * speed) if speed else 0.0
        steer = min(max(steer, -config.steering_limit), config.steering_limit)
        angles = wheel_angles(steer, config.wheel_base, config.kingpin_width)
        for fork, angle in zip(self._forks, angles, strict=True):
            fork.command_position(angle)
        half = config.wheel_separation / 2 / config.wheel_base * math.tan(steer)
        for side, share in zip(self._driven, (1 - half, 1 + half), strict=True):
            for _, motor in side:
                motor.command(speed * share / config.wheel_radius)
        self._reckoning.read(seconds)

    def _motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        return self._reckoning.motion()
