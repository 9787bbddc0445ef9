"""``gz-sim-diff-drive-system``: gz-sim's differential drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.differential import DifferentialDriveConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import joints_tag
from cartwheel.dialects.gz.drive_tags import (
    CONTROL_RATE,
    GzLimitedParameters,
    gz_drive,
    report_limits,
    separate_limits,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, wheel_pairs
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class GzDiffDriveParameters(GzLimitedParameters):
    left_joint: tuple[str, ...] = joints_tag(
        "left_joint", role="left_wheel", doc="Joint of a left wheel. Repeat the tag for each wheel."
    )
    right_joint: tuple[str, ...] = joints_tag(
        "right_joint",
        role="right_wheel",
        doc="Joint of a right wheel. Repeat the tag for each wheel.",
    )
    wheel_separation: float = drive_tags.wheel_separation("wheel_separation", default=1.0)
    wheel_radius: float = tag(
        "wheel_radius", default=0.2, unit="m", role="wheel_radius", doc="Radius of all wheels."
    )


class GzDiffDrive(Plugin[GzDiffDriveParameters]):
    """Drives left and right wheels as commanded by Twist messages, and publishes odometry.

    The odometry is computed from the rotation of the wheels. Only the effort limits of the joints
    limit the torque of the wheels, and their velocity limits the speed. Original plugin:
    ``DiffDrive`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-diff-drive-system",)

    def configure(self) -> None:
        config = self.config
        if len(config.left_joint) != len(config.right_joint):
            raise PluginError(
                f"the numbers of <left_joint> ({len(config.left_joint)}) and <right_joint> "
                f"({len(config.right_joint)}) differ",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                values={"left": len(config.left_joint), "right": len(config.right_joint)},
            )
        report_limits(self, config)
        joints = list(zip(config.left_joint, config.right_joint, strict=True))
        pairs = wheel_pairs(self, joints, [config.wheel_separation], [2 * config.wheel_radius])
        add_differential_drive(
            self,
            DifferentialDriveConfig(
                pairs=pairs,
                linear=separate_limits(config, "linear"),
                angular=separate_limits(config, "angular"),
                limit_period=1 / CONTROL_RATE,
                odometry="positions",
                drive=gz_drive(self, config),
            ),
        )
