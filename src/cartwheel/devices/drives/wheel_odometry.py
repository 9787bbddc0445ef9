"""Odometry from dead reckoning, published by a component that is updated at a higher rate."""

from __future__ import annotations

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.periodic import Periodic


class WheelOdometry(Component):
    """Publishes an estimated pose when it is due.

    Args:
        scope: Where the topics are advertised.
        config: Topics, frames and the publish rate.
        reckoning: The estimate, which the owner updates.
    """

    def __init__(self, scope: Scope, config: OdometryConfig, reckoning: DeadReckoning) -> None:
        super().__init__(scope)
        self.reckoning = reckoning
        self.periodic = Periodic(config.rate)
        """Determines when the odometry is due. Until then, `publish` need not be called."""
        self._odometry = self.add(Odometry(scope, config))

    def start(self, time_ns: int) -> None:
        """Restarts at the origin, at rest."""
        self.reckoning.restart()
        self.periodic.start(time_ns)

    def publish(self, time_ns: int) -> None:
        """Publishes the odometry if it is due and has subscribers."""
        if self.periodic.due(time_ns) and self._odometry.wanted():
            self._odometry.publish(time_ns, *self.reckoning.motion())
