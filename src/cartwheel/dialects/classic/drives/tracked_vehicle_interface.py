"""``libgazebo_ros_tracked_vehicle_interface.so``: ROS topics of a vehicle on tracks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.devices.drives.differential import DifferentialDrive
from cartwheel.devices.drives.drive import DriveConfig, Drives
from cartwheel.devices.drives.odometry import OdometryConfig, planar_covariance
from cartwheel.devices.drives.relay import Relay, RelayConfig
from cartwheel.devices.drives.tracked_vehicle import TrackedVehicle
from cartwheel.dialects import drive_tags
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.classic.drives.tracked_vehicle import (
    SimpleTrackedVehicle,
    WheelTrackedVehicle,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag

_VEHICLES = (SimpleTrackedVehicle, WheelTrackedVehicle)
_NAMES = frozenset(short_name(name) for vehicle in _VEHICLES for name in vehicle.filenames)


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackedVehicleInterfaceParameters:
    command_topic: str = tag(
        "commandROSTopic", default="cmd_vel_ros", doc="Topic of the Twist commands."
    )
    odometry_topic: str = drive_tags.odometry_topic("odometryTopic")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    update_rate: float = tag(
        "updateRate",
        default=100.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate of the odometry. If 0, it is published at every simulation step.",
    )
    source: Literal["world", "encoder"] = tag(
        "odometrySource",
        default="world",
        doc="Source of the odometry: `world` is the ground-truth pose in the world, and `encoder` "
        "is dead reckoning from the commanded speeds of the tracks.",
    )
    separation: float = tag(
        "wheelSeparation",
        "tracks_separation",
        default=0.34,
        unit="m",
        least=SMALLEST,
        doc="Distance between the left and the right tracks in the dead reckoning.",
    )
    publish_tf: bool = tag(
        "publishTf",
        default=True,
        doc="Whether to publish the odometry and its transform. If false, `<publishOdomTF>` has no "
        "effect.",
    )
    publish_odom_tf: bool = drive_tags.publish_transform("publishOdomTF", default=True)
    gazebo_topic: str = tag(
        "commandIGNTopic",
        default="cmd_vel_ign",
        doc="No effect: commands are passed to the tracked vehicle of the same model.",
    )
    speed_topic: str = tag(
        "trackSpeedTopic",
        default="track_speed",
        doc="No effect: the speeds are those of the tracked vehicle of the same model.",
    )


class TrackedVehicleInterface(Plugin[TrackedVehicleInterfaceParameters]):
    """Passes Twist messages to the tracked vehicle of the same model, and publishes odometry.

    The vehicle is that of `libSimpleTrackedVehiclePlugin.so` or of
    `libWheelTrackedVehiclePlugin.so`, which also has a topic of its own. Its tracks slip, so in a
    turn, odometry from the speeds of the tracks differs from the true motion. Original plugin:
    ``gazebo_ros_tracked_vehicle_interface`` in the package of the same name.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_tracked_vehicle_interface.so",)
    empty_is_model: ClassVar[bool] = True
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        if self.tag.element.find("ros") is None:
            self.under_model()
        self.add(
            Relay(
                self.scope,
                RelayConfig(
                    separation=config.separation,
                    odometry="commands" if config.source == "encoder" else "ground truth",
                    drive=DriveConfig(
                        command_topic=config.command_topic,
                        control_rate=0.0,
                        odometry=OdometryConfig(
                            topic=config.odometry_topic if config.publish_tf else None,
                            frame=config.odometry_frame,
                            base=config.base_frame,
                            rate=config.update_rate,
                            transform=config.publish_tf and config.publish_odom_tf,
                            pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
                        ),
                    ),
                ),
                self._vehicle,
            )
        )
        plugins = self.part.description.plugins
        if not any(short_name(each.filename) in _NAMES for each in plugins):
            self.warn(
                devices.PLUGIN_IDLE,
                "the model has no plugin for a tracked vehicle, so commands have no effect",
                hint=f'Add a plugin with the file name "{SimpleTrackedVehicle.filenames[0]}".',
            )

    def _vehicle(self) -> TrackedVehicle | DifferentialDrive | None:
        """The vehicle, which may be created after this plugin."""
        for each in self.shared.get(Drives).all:
            if (
                each.part is self.part
                and isinstance(each.scope.owner, _VEHICLES)
                and isinstance(each, TrackedVehicle | DifferentialDrive)
            ):
                return each
        return None
