"""A drive that passes its commands to another drive, and publishes odometry for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from cartwheel.component import Scope
from cartwheel.devices.drives.differential import DifferentialDrive
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.kinematics import axle_motion
from cartwheel.devices.drives.reckoning import DeadReckoning, Motion
from cartwheel.devices.drives.tracked_vehicle import TrackedVehicle


@dataclass(frozen=True, kw_only=True, slots=True)
class RelayConfig:
    separation: float
    """Distance between the left and the right side in the dead reckoning, m."""
    odometry: Literal["ground truth", "commands"]
    """Source of the odometry: the pose in the world, or dead reckoning from the commanded speeds of
    both sides."""
    drive: DriveConfig


class Relay(Drive):
    """Passes its commands to another drive, and publishes odometry.

    Args:
        scope: The robot and the names of topics.
        config: Odometry and topics.
        target: Returns the other drive, which may be created later; None if there is none.
    """

    def __init__(
        self,
        scope: Scope,
        config: RelayConfig,
        target: Callable[[], TrackedVehicle | DifferentialDrive | None],
    ) -> None:
        super().__init__(scope)
        self._config = config
        self._target = target
        self._is_true = config.odometry == "ground truth"
        self._reckoning = DeadReckoning()
        self.run(config.drive)

    def reset(self) -> None:
        super().reset()
        self._reckoning.restart()

    def command(self, forward: float, sideways: float, turn: float) -> None:
        target = self._target()
        if target is not None:
            target.receive(forward, sideways, turn)

    def can_idle(self) -> bool:
        return self._is_true

    def update(self, seconds: float) -> None:
        target = None if self._is_true else self._target()
        if target is not None:
            left, right = (speed * seconds for speed in target.sides)
            distance, angle = axle_motion(left, right, self._config.separation)
            self._reckoning.go(distance, angle, seconds)

    def motion(self) -> Motion:
        return self._base.planar_motion() if self._is_true else self._reckoning.motion()
