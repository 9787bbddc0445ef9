"""A drive with its own tags, which uses Cartwheel's differential drive."""

from dataclasses import dataclass

from cartwheel.devices.drives.differential import (
    DifferentialDrive,
    DifferentialDriveConfig,
    WheelPair,
)
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.plugin import Plugin, tag


@dataclass(frozen=True, kw_only=True)
class TwoWheelsParameters:
    left: str = tag("left", role="left_wheel", doc="Joint of the left wheel.")
    right: str = tag("right", role="right_wheel", doc="Joint of the right wheel.")
    track: float = tag("track", unit="m", role="wheel_separation", least=0.01, doc="Track.")
    tyre: float = tag("tyre", unit="m", role="wheel_diameter", least=0.01, doc="Tyre diameter.")


class TwoWheels(Plugin[TwoWheelsParameters]):
    """Drives a robot as commanded by Twist messages, and publishes its odometry."""

    filenames = ("libtwo_wheels.so",)

    def configure(self) -> None:
        radius = self.config.tyre / 2
        wheels = WheelPair(
            left=self.config.left,
            right=self.config.right,
            separation=self.config.track,
            left_radius=radius,
            right_radius=radius,
        )
        odometry = OdometryConfig(topic="odom", frame="odom", base="base_link", rate=50.0)
        drive = DriveConfig(command_topic="cmd_vel", control_rate=50.0, odometry=odometry)
        config = DifferentialDriveConfig(pairs=(wheels,), max_torque=5.0, drive=drive)
        self.add(DifferentialDrive(self.scope, config))
