"""``libridgeback_ros_force_based_move.so``: a base that is pushed to its velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.geometry import Array, Pose
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.odometry import UNKNOWN, Odometry, planar_motion
from cartwheel.plugins.parameters import tag

_TURNS = 1e-4
"""rad/s; what turns faster knows little of its heading."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceBasedMoveParameters:
    command_topic: str = tag("commandTopic", default="cmd_vel", doc="Twist.")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Odometry.")
    odometry_frame: str = tag("odometryFrame", default="odom", doc="Frame of the odometry.")
    base_frame: str = tag(
        "robotBaseFrame",
        default="base_footprint",
        doc="Link whose pose is told; the root link where there is none of that name.",
    )
    rate: float = tag(
        "odometryRate", default=20.0, unit="Hz", doc="Of what is told; 0 or less is none of it."
    )
    publish_tf: bool = tag("publishOdometryTf", default=True, doc="Publish odometry's transform.")
    timeout: float = tag(
        "cmdVelTimeOut",
        "commandWatchdog",
        default=0.25,
        unit="s",
        doc="After that long without a command it stands.",
    )
    x_gain: float = tag(
        "x_velocity_p_gain", default=10000.0, unit="N s/m", doc="Force for a missing speed."
    )
    y_gain: float = tag(
        "y_velocity_p_gain",
        default=10000.0,
        unit="N s/m",
        doc="The same sideways; has to be as much.",
    )
    yaw_gain: float = tag(
        "yaw_velocity_p_gain", default=100.0, unit="N m s/rad", doc="Torque for missing turning."
    )


class ForceBasedMove(Plugin[ForceBasedMoveParameters]):
    """Pushes the robot along, sideways and around as Twist says, with forces as of a spring.

    The force is the gain times what is missing of the velocity, at the centre of mass. The odometry
    begins where the robot does. Source: ridgeback_gazebo_plugins; hector_gazebo_plugins.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libridgeback_ros_force_based_move.so",
        "libgazebo_ros_force_based_move.so",
        "librobotnik_force_based_move.so",
    )
    parameters: ClassVar[type] = ForceBasedMoveParameters
    _told: Odometry | None = None

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("x_gain", "y_gain", "yaw_gain")
        if config.y_gain != config.x_gain:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<y_velocity_p_gain> has no effect: that of x is used in both directions",
                values={"parameter": "y_velocity_p_gain"},
            )
        known = part.description.link(config.base_frame) is not None
        self._base = part.link(config.base_frame if known else part.description.canonical_link)
        self._drive = part.body_drive(gains=(config.x_gain, config.yaw_gain), origin=origin)
        self._start: Pose | None = None
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        part.schedule(0, before=self._watch)
        if config.rate > 0:
            told = self._told = Odometry(
                self,
                topic=config.odometry_topic,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=config.rate,
                transform=config.publish_tf,
            )
            # Where it begins is known at its first turn, whoever listens.
            part.schedule(
                config.rate,
                after=self._publish,
                active=lambda: self._start is None or told.wanted(),
            )
        self.reset()

    def reset(self) -> None:
        self._start = None
        self._heard_ns: int | None = None
        self._stand()

    def close(self) -> None:
        if self._told is not None:
            self._told.close()
        super().close()

    def _stand(self) -> None:
        self._drive.command((0.0, 0.0, None), (None, None, 0.0))

    def _on_command(self, message: Any) -> None:
        x, y, turn = float(message.linear.x), float(message.linear.y), float(message.angular.z)
        self._heard_ns = self.part.time_ns
        self._drive.command((x, y, None), (None, None, turn))

    def _watch(self) -> None:
        heard = self._heard_ns
        if heard is not None and (self.part.time_ns - heard) * 1e-9 > self.config.timeout:
            self._heard_ns = None
            self._stand()

    def _publish(self) -> None:
        place, turned, linear, angular = planar_motion(self._base)
        if self._start is None:
            self._start = Pose(place, turned)
        told = self._told
        if told is None or not told.wanted():
            return
        pose = self._start.inverse() @ Pose(place, turned)
        turns = abs(angular[2]) >= _TURNS
        told.pose_covariance = _covariance(UNKNOWN, turns=turns)
        told.twist_covariance = _covariance(1e-3, turns=turns)
        told.publish(self.part.time_ns, pose.position, pose.orientation, linear, angular)


def _covariance(height: float, *, turns: bool) -> Array:
    """Shape (36,), of a pose or a twist, as the original tells it."""
    return np.diag([1e-3, 1e-3, height, UNKNOWN, UNKNOWN, 100.0 if turns else 0.01]).ravel()
