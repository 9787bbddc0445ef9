"""``gz-sim-diff-drive-system``: gz-sim's differential drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.limiter import Limiter
from cartwheel.devices.drives.odometry import Odometry
from cartwheel.dialects.gz.drive_tags import (
    GzLimitedParameters,
    gz_name,
    gz_odometry,
    report_limits,
    separate_limits,
)
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_drive import WheelDrive, WheelPair
from cartwheel.errors import PluginError

CONTROL_RATE = 100.0
"""Rate of the control loop, which applies the limits, Hz."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GzDiffDriveParameters(GzLimitedParameters):
    left_joint: tuple[str, ...] = tag(
        "left_joint",
        default=("left_joint",),
        doc="Joint of a left wheel. Repeat the tag for each wheel.",
    )
    right_joint: tuple[str, ...] = tag(
        "right_joint",
        default=("right_joint",),
        doc="Joint of a right wheel. Repeat the tag for each wheel.",
    )
    wheel_separation: float = tag(
        "wheel_separation", default=1.0, unit="m", doc="Distance between the left and right wheels."
    )
    wheel_radius: float = tag("wheel_radius", default=0.2, unit="m", doc="Radius of all wheels.")


class GzDiffDrive(WheelDrive):
    """Drives left and right wheels from Twist commands and publishes odometry from their rotation.

    The wheel torque is limited only by the effort limits of the joints. Original plugin:
    ``DiffDrive`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-diff-drive-system",)
    parameters: ClassVar[type] = GzDiffDriveParameters

    def configure(self) -> None:
        config: GzDiffDriveParameters = self.config
        if len(config.left_joint) != len(config.right_joint):
            raise PluginError(
                f"the numbers of <left_joint> ({len(config.left_joint)}) and <right_joint> "
                f"({len(config.right_joint)}) differ",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                values={"left": len(config.left_joint), "right": len(config.right_joint)},
            )
        report_limits(self, config)
        self._linear = Limiter(separate_limits(config, "linear"))
        self._angular = Limiter(separate_limits(config, "angular"))
        self._wanted_speed = (0.0, 0.0)
        pairs = [
            WheelPair(
                left=left,
                right=right,
                separation=config.wheel_separation,
                diameter=2 * config.wheel_radius,
            )
            for left, right in zip(config.left_joint, config.right_joint, strict=True)
        ]
        self._take_wheels(pairs, torque=None)
        self.odometry = self.add(Odometry(self.scope, gz_odometry(self, config)))
        self._run_wheels(
            command_topic=gz_name(self, config.topic, "cmd_vel"),
            base="",
            encoded=True,
            control_rate=CONTROL_RATE,
            rate=config.rate,
        )

    def reset(self) -> None:
        self._wanted_speed = (0.0, 0.0)
        self._linear.reset()
        self._angular.reset()
        super().reset()

    def _aim(self, forward: float, turn: float) -> None:
        self._wanted_speed = (forward, turn)

    def _turn_wheels(self, seconds: float) -> None:
        forward, turn = self._wanted_speed
        period = 1 / CONTROL_RATE
        super()._aim(self._linear.step(forward, period), self._angular.step(turn, period))
        super()._turn_wheels(seconds)
