"""``gz-sim-mecanum-drive-system``: four mecanum wheels, which also move the robot sideways."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.mecanum import (
    MecanumDrive,
    MecanumDriveConfig,
    MecanumWheelsConfig,
)
from cartwheel.dialects.common_tags import joints_tag, size_tag
from cartwheel.dialects.gz.drive_tags import (
    GzCommonLimits,
    common_limits,
    gz_drive,
    report_limits,
)
from cartwheel.dialects.plugin import Plugin


@dataclass(frozen=True, kw_only=True, slots=True)
class MecanumParameters(GzCommonLimits):
    front_left: tuple[str, ...] = joints_tag(
        "front_left_joint",
        doc="Joint of the front left wheel. Repeat the tag for additional wheels.",
    )
    front_right: tuple[str, ...] = joints_tag(
        "front_right_joint",
        doc="Joint of the front right wheel. Repeat the tag for additional wheels.",
    )
    back_left: tuple[str, ...] = joints_tag(
        "back_left_joint", doc="Joint of the back left wheel. Repeat the tag for additional wheels."
    )
    back_right: tuple[str, ...] = joints_tag(
        "back_right_joint",
        doc="Joint of the back right wheel. Repeat the tag for additional wheels.",
    )
    wheel_base: float = size_tag(
        "wheelbase",
        default=1.0,
        role="wheel_base",
        wheels=("front_left", "back_left"),
        doc="Distance between the front and back axles.",
    )
    wheel_separation: float = size_tag(
        "wheel_separation",
        default=1.0,
        role="wheel_separation",
        wheels=("front_left", "front_right"),
        doc="Distance between the left and right wheels.",
    )
    wheel_radius: float = size_tag(
        "wheel_radius",
        default=0.2,
        role="wheel_radius",
        wheels=("front_left", "front_right", "back_left", "back_right"),
        doc="Radius of all wheels.",
    )


class GzMecanumDrive(Plugin[MecanumParameters]):
    """Drives four mecanum wheels as commanded by Twist messages, and publishes odometry.

    If the friction of the wheels' collisions models the rollers, contact forces move the robot.
    This is the case if the collisions contain ``<fdir1 gz:expressed_in="...">`` and different
    values of ``<mu>`` and ``<mu2>``. Otherwise, a velocity controller applies a force to the robot,
    as with ``libgazebo_ros_planar_move.so``, and the wheels turn at the corresponding speeds.

    The odometry is computed from the rotation of the wheels. Original plugin: ``MecanumDrive`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-mecanum-drive-system",)

    def configure(self) -> None:
        config = self.config
        report_limits(self, config)
        limits = common_limits(config)
        self.add(
            MecanumDrive(
                self.scope,
                MecanumDriveConfig(
                    front_left=config.front_left,
                    front_right=config.front_right,
                    back_left=config.back_left,
                    back_right=config.back_right,
                    wheels=MecanumWheelsConfig(
                        radius=config.wheel_radius,
                        reach=(config.wheel_base + config.wheel_separation) / 2,
                        limits=(limits, limits, limits),
                        subtracts="distances",
                    ),
                    drive=gz_drive(self, config),
                ),
            )
        )
