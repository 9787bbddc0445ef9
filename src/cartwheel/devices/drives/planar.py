"""A drive without wheels that moves a model in the plane and publishes its ground-truth pose."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.body_velocity import BodyVelocity, BodyVelocityConfig
from cartwheel.devices.drives.odometry import (
    NO_COVARIANCE,
    Odometry,
    OdometryConfig,
    planar_covariance,
    planar_motion,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarDriveConfig:
    command_topic: str
    """Topic of the Twist commands."""
    timeout: float | None = None
    """Time after which the model stops without a command, s. None: never."""
    odometry_topic: str | None
    """Topic of the odometry. None: not published."""
    odometry_frame: str
    """Reference frame of the odometry."""
    base: str
    """Link whose pose is published; the root link if no link has this name."""
    rate: float
    """Publish rate, Hz. 0 or less: nothing is published."""
    transform: bool
    """Publish the transform of the odometry."""
    pose_variances: tuple[float, float, float]
    """Variances of x and y, m², and yaw, rad²."""
    twist_variances: tuple[float, float, float] | None = None
    """Variances of the velocities, m²/s² and rad²/s². None: the covariance is zero."""


class PlanarDrive(Component):
    """Moves a model in the plane from Twist commands and publishes odometry.

    Raises:
        PluginError: The model cannot move, or has no mass.
    """

    def __init__(self, scope: Scope, config: PlanarDriveConfig) -> None:
        super().__init__(scope)
        self._base = self.link_or_root(config.base)
        self.add(
            BodyVelocity(
                scope, BodyVelocityConfig(topic=config.command_topic, timeout=config.timeout)
            )
        )
        publishes = config.rate > 0
        self._odometry = self.add(
            Odometry(
                scope,
                OdometryConfig(
                    topic=config.odometry_topic if publishes else None,
                    frame=config.odometry_frame,
                    base=config.base,
                    rate=config.rate,
                    transform=publishes and config.transform,
                    pose_covariance=planar_covariance(*config.pose_variances),
                    twist_covariance=(
                        NO_COVARIANCE
                        if config.twist_variances is None
                        else planar_covariance(*config.twist_variances)
                    ),
                ),
            )
        )
        if publishes:
            self.part.schedule(config.rate, after=self._publish, active=self._odometry.wanted)

    def _publish(self) -> None:
        self._odometry.publish(self.part.time_ns, *planar_motion(self._base))
