"""``libridgeback_ros_force_based_move.so``: a base that forces move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.odometry import UNKNOWN, Odometry, planar_motion
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Array, Pose

_TURNS = 1e-4
"""rad/s; the heading's variance is large above this rate."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceBasedMoveParameters:
    command_topic: str = tag("commandTopic", default="cmd_vel", doc="Topic of the Twist commands.")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = tag("odometryFrame", default="odom", doc="Frame ID of the odometry.")
    base_frame: str = tag(
        "robotBaseFrame",
        default="base_footprint",
        doc="Link whose pose the odometry reports. If no link has this name, the root link "
        "is used.",
    )
    rate: float = tag(
        "odometryRate",
        default=20.0,
        unit="Hz",
        doc="Publish rate of odometry and transform. 0 or less: neither is published.",
    )
    publish_tf: bool = tag(
        "publishOdometryTf", default=True, doc="Publish the transform of the odometry."
    )
    timeout: float = tag(
        "cmdVelTimeOut",
        "commandWatchdog",
        default=0.25,
        unit="s",
        doc="The robot stops after this time without a command.",
    )
    x_gain: float = tag(
        "x_velocity_p_gain", default=10000.0, unit="N s/m", doc="Force per linear velocity error."
    )
    y_gain: float = tag(
        "y_velocity_p_gain",
        default=10000.0,
        unit="N s/m",
        doc="Must equal `<x_velocity_p_gain>`, which is used for both directions.",
    )
    yaw_gain: float = tag(
        "yaw_velocity_p_gain",
        default=100.0,
        unit="N m s/rad",
        doc="Torque per angular velocity error.",
    )


class ForceBasedMove(Plugin[ForceBasedMoveParameters]):
    """Applies forces to make the robot follow Twist commands, and publishes odometry.

    The robot moves in the plane: it follows ``linear.x``, ``linear.y`` and ``angular.z``. The force
    and the torque act at the centre of mass and are the gains times the velocity errors. The
    odometry is relative to the robot's initial pose. Original packages:
    ``ridgeback_gazebo_plugins`` and ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libridgeback_ros_force_based_move.so",
        "libgazebo_ros_force_based_move.so",
        "librobotnik_force_based_move.so",
    )
    parameters: ClassVar[type] = ForceBasedMoveParameters
    _odometry: Odometry | None = None

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("x_gain", "y_gain", "yaw_gain")
        if config.y_gain != config.x_gain:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<y_velocity_p_gain> has no effect: <x_velocity_p_gain> is used in both directions",
                values={"parameter": "y_velocity_p_gain"},
            )
        known = part.description.link(config.base_frame) is not None
        self._base = part.link(config.base_frame if known else part.description.canonical_link)
        self._drive = part.body_drive(gains=(config.x_gain, config.yaw_gain), origin=origin)
        self._start: Pose | None = None
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        part.schedule(0, before=self._watch)
        if config.rate > 0:
            odometry = self._odometry = Odometry(
                self,
                topic=config.odometry_topic,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=config.rate,
                transform=config.publish_tf,
            )
            # The initial pose must not depend on when the first subscriber appears.
            part.schedule(
                config.rate,
                after=self._publish,
                active=lambda: self._start is None or odometry.wanted(),
            )
        self.reset()

    def reset(self) -> None:
        self._start = None
        self._received_ns: int | None = None
        self._stop()

    def close(self) -> None:
        if self._odometry is not None:
            self._odometry.close()
        super().close()

    def _stop(self) -> None:
        self._drive.command((0.0, 0.0, None), (None, None, 0.0))

    def _on_command(self, message: Any) -> None:
        x, y, turn = float(message.linear.x), float(message.linear.y), float(message.angular.z)
        self._received_ns = self.part.time_ns
        self._drive.command((x, y, None), (None, None, turn))

    def _watch(self) -> None:
        received_ns = self._received_ns
        if (
            received_ns is not None
            and (self.part.time_ns - received_ns) * 1e-9 > self.config.timeout
        ):
            self._received_ns = None
            self._stop()

    def _publish(self) -> None:
        place, turned, linear, angular = planar_motion(self._base)
        if self._start is None:
            self._start = Pose(place, turned)
        odometry = self._odometry
        if odometry is None or not odometry.wanted():
            return
        pose = self._start.inverse() @ Pose(place, turned)
        turns = abs(angular[2]) >= _TURNS
        odometry.pose_covariance = _covariance(UNKNOWN, turns=turns)
        odometry.twist_covariance = _covariance(1e-3, turns=turns)
        odometry.publish(self.part.time_ns, pose.position, pose.orientation, linear, angular)


def _covariance(height: float, *, turns: bool) -> Array:
    """Returns the covariance of a pose or a twist, shape (36,), as in the original plugin."""
    return np.diag([1e-3, 1e-3, height, UNKNOWN, UNKNOWN, 100.0 if turns else 0.01]).ravel()
