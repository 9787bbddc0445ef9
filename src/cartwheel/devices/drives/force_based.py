"""A drive without wheels that applies forces proportional to the velocity error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.body_velocity import BodyVelocity, BodyVelocityConfig
from cartwheel.devices.drives.odometry import (
    UNKNOWN,
    Odometry,
    OdometryConfig,
    base_of,
)
from cartwheel.geometry import Array, Pose

_TURNING = 1e-4
"""Yaw rate above which the heading's variance is large, rad/s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceBasedDriveConfig:
    command_topic: str
    """Topic of the Twist commands."""
    timeout: float
    """Time after which the model stops without a command, s."""
    force_gain: float
    """Force per linear velocity error, N s/m."""
    torque_gain: float
    """Torque per angular velocity error, N m s/rad."""
    odometry: OdometryConfig | None
    """The odometry, whose covariances depend on the motion. Its base is the link whose pose is
    published, or the root link if no link has this name. None: nothing is published."""


class ForceBasedDrive(Component):
    """Moves a model in the plane by forces, and publishes its pose relative to the initial pose.

    Raises:
        PluginError: The model cannot move, or has no mass.
    """

    def __init__(self, scope: Scope, config: ForceBasedDriveConfig) -> None:
        super().__init__(scope)
        self._start: Pose | None = None
        self.add(
            BodyVelocity(
                scope,
                BodyVelocityConfig(
                    topic=config.command_topic,
                    timeout=config.timeout,
                    gains=(config.force_gain, config.torque_gain),
                ),
            )
        )
        if config.odometry is None:
            return
        self._base = base_of(self, config.odometry)
        self._odometry = self.add(Odometry(scope, config.odometry))
        # The initial pose must not depend on when the first subscriber appears.
        self.part.schedule(
            config.odometry.rate,
            after=self._publish,
            active=lambda: self._start is None or self._odometry.wanted(),
        )

    def reset(self) -> None:
        super().reset()
        self._start = None

    def _publish(self) -> None:
        position, orientation, linear, angular = self._base.planar_motion()
        if self._start is None:
            self._start = Pose(position, orientation)
        if not self._odometry.wanted():
            return
        pose = self._start.inverse() @ Pose(position, orientation)
        turning = abs(angular[2]) >= _TURNING
        self._odometry.pose_covariance = covariance(z=UNKNOWN, turning=turning)
        self._odometry.twist_covariance = covariance(z=1e-3, turning=turning)
        self._odometry.publish(self.part.time_ns, pose.position, pose.orientation, linear, angular)


def covariance(*, z: float, turning: bool) -> Array:
    """Returns the covariance of a pose or a twist, shape (36,).

    Args:
        z: Variance in z, m² or m²/s².
        turning: Whether the robot turns, which makes its heading uncertain.
    """
    return np.diag([1e-3, 1e-3, z, UNKNOWN, UNKNOWN, 100.0 if turning else 0.01]).ravel()
