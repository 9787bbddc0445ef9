"""A drive without wheels that moves a model in the plane and publishes its ground-truth pose."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.body_velocity import BodyVelocity, BodyVelocityConfig
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig, base_of


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarDriveConfig:
    command_topic: str
    """Topic of the Twist commands."""
    timeout: float | None = None
    """Time after which the model stops without a command, s. None: never."""
    sideways: bool = True
    """Whether the sideways velocity of the commands is followed."""
    gains: tuple[float, float] | None = None
    """Force per velocity error and torque per yaw rate error; see `BodyVelocityConfig`."""
    pushed: tuple[str, ...] = ()
    """Links at whose centre of mass the force acts; see `BodyVelocityConfig`."""
    odometry: OdometryConfig | None
    """The odometry. Its base is the link whose pose is published, or the root link if no link has
    this name. None: nothing is published."""


class PlanarDrive(Component):
    """Moves a model in the plane from Twist commands and publishes odometry.

    Raises:
        PluginError: The model cannot move, or has no mass.
    """

    def __init__(self, scope: Scope, config: PlanarDriveConfig) -> None:
        super().__init__(scope)
        body = BodyVelocityConfig(
            topic=config.command_topic,
            timeout=config.timeout,
            sideways=config.sideways,
            gains=config.gains,
            pushed=config.pushed,
        )
        self.add(BodyVelocity(scope, body))
        if config.odometry is not None:
            self._base = base_of(self, config.odometry)
            self._odometry = self.add(Odometry(scope, config.odometry))
            rate = config.odometry.rate
            self.part.schedule(rate, after=self._publish, topics=self._odometry.publishers)

    def _publish(self) -> None:
        self._odometry.publish(self.part.time_ns, *self._base.planar_motion())
