"""``libgazebo_ros_planar_move.so``, ``gz-sim-velocity-control-system``: drives without wheels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.odometry import (
    NO_COVARIANCE,
    Odometry,
    planar_covariance,
    planar_motion,
)
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.simulation.limits import FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarMoveParameters:
    command_topic: str = tag(
        "commandTopic", "command_topic", default="cmd_vel", doc="Topic of the Twist commands."
    )
    odometry_topic: str = tag(
        "odometryTopic", "odometry_topic", default="odom", doc="Topic of the odometry."
    )
    odometry_frame: str = tag(
        "odometryFrame", "odometry_frame", default="odom", doc="Frame ID of the odometry."
    )
    base_frame: str = tag(
        "robotBaseFrame",
        "robot_base_frame",
        default="base_footprint",
        doc="Link whose pose the odometry reports. If no link has this name, the root link "
        "is used.",
    )
    rate: float = tag(
        "odometryRate",
        "publish_rate",
        default=20.0,
        unit="Hz",
        doc="Publish rate of odometry and transform. 0 or less: neither is published.",
    )
    update_rate: float = tag(
        "update_rate",
        default=20.0,
        unit="Hz",
        doc="No effect: the velocity is controlled at every step.",
    )
    timeout: float = tag(
        "cmdTimeout",
        "cmd_timeout",
        default=-1.0,
        unit="s",
        doc="The robot stops after this time without a command. Negative: no timeout.",
    )
    publish_odom: bool = tag("publish_odom", default=True, doc="Publish the odometry.")
    publish_odom_tf: bool = tag(
        "publish_odom_tf", default=True, doc="Publish the transform of the odometry."
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


class PlanarMove(Plugin[PlanarMoveParameters]):
    """Moves the robot in the plane from Twist commands and publishes odometry.

    No wheels are needed: a servo pushes the whole robot with a force of at most five times its
    weight, so walls stop it. The odometry is the ground-truth pose. Original plugin:
    ``gazebo_ros_planar_move`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_planar_move.so",)
    parameters: ClassVar[type] = PlanarMoveParameters

    def configure(self) -> None:
        config = self.config
        part = self.part
        self._base = self.link_or_root(config.base_frame)
        self._drive = part.body_drive(origin=self.tag.origin)
        ros2 = self.tag.element.find("ros") is not None
        covariance = planar_covariance(
            config.covariance_x, config.covariance_y, config.covariance_yaw
        )
        publishes = config.rate > 0
        self._odometry = self.keep(
            Odometry(
                self,
                topic=config.odometry_topic if publishes and config.publish_odom else None,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=config.rate,
                transform=publishes and config.publish_odom_tf,
                pose_covariance=covariance,
                twist_covariance=covariance if ros2 else NO_COVARIANCE,
            )
        )
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        if config.timeout >= 0:
            part.schedule(0, before=self._watch)
        if publishes:
            part.schedule(config.rate, after=self._publish, active=self._odometry.wanted)
        self.reset()

    def reset(self) -> None:
        self._heard_ns: int | None = None
        self._drive.command((0.0, 0.0, None), (None, None, 0.0))

    def _on_command(self, message: Any) -> None:
        linear, angular = message.linear, message.angular
        self._heard_ns = self.part.time_ns
        self._drive.command(
            (float(linear.x), float(linear.y), None), (None, None, float(angular.z))
        )

    def _watch(self) -> None:
        if self._heard_ns is None:
            return
        if (self.part.time_ns - self._heard_ns) * 1e-9 > self.config.timeout:
            self._heard_ns = None
            self._drive.command((0.0, 0.0, None), (None, None, 0.0))

    def _publish(self) -> None:
        self._odometry.publish(self.part.time_ns, *planar_motion(self._base))


@dataclass(frozen=True, kw_only=True, slots=True)
class VelocityControlParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the Twist commands. Default: `/model/<model>/cmd_vel`.",
    )
    initial_linear: tuple[float, float, float] | None = tag(
        "initial_linear",
        default=None,
        unit="m/s",
        most=FARTHEST,
        doc="Initial linear velocity.",
    )
    initial_angular: tuple[float, float, float] | None = tag(
        "initial_angular",
        default=None,
        unit="rad/s",
        most=FARTHEST,
        doc="Initial angular velocity.",
    )


class VelocityControl(Plugin[VelocityControlParameters]):
    """Holds the model at the commanded linear and angular velocity, expressed in the model frame.

    All six degrees of freedom are controlled. Without an initial velocity, the model moves freely
    until the first command. Original plugin: ``VelocityControl`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-velocity-control-system",)
    parameters: ClassVar[type] = VelocityControlParameters

    def configure(self) -> None:
        if self.tag.element.find("link_name"):
            raise PluginError(
                "<link_name> is not supported because only whole models are moved",
                code=devices.PLUGIN_PARAMETER_UNSUPPORTED,
                origin=self.place_of("link_name"),
                values={"parameter": "link_name"},
            )
        self._drive = self.part.body_drive(origin=self.tag.origin)
        topic = gz_name(self, self.config.topic, "cmd_vel")
        self.subscribe(topic, "geometry_msgs/msg/Twist", self._on_command)
        self.reset()

    def reset(self) -> None:
        linear, angular = self.config.initial_linear, self.config.initial_angular
        if linear is None and angular is None:
            self._drive.release()
        else:
            self._hold(linear or (0.0, 0.0, 0.0), angular or (0.0, 0.0, 0.0))

    def _on_command(self, message: Any) -> None:
        linear, angular = message.linear, message.angular
        self._hold((linear.x, linear.y, linear.z), (angular.x, angular.y, angular.z))

    def _hold(self, linear: tuple[float, ...], angular: tuple[float, ...]) -> None:
        self._drive.command(linear, angular, level=False)
