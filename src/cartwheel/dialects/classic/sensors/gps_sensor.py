"""``libgazebo_ros_gps_sensor.so``: publishes a ``gps`` sensor in ROS 2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.gps import Gps
from cartwheel.dialects.common_tags import sensor_frame_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.gps import read_gps


@dataclass(frozen=True, kw_only=True, slots=True)
class GpsSensorParameters:
    frame: str = sensor_frame_tag("frame_name")


class GpsSensor(SensorPlugin[GpsSensorParameters]):
    """Publishes the latitude, longitude, altitude and velocity that a ``gps`` sensor measures.

    The position is published on ``~/out`` (NavSatFix). The velocity is published on ``~/vel``
    (Vector3Stamped); its components point east, north and up. The world's
    ``<spherical_coordinates>`` define the geographic position of the world's origin. The noise in
    the sensor's ``<gps>`` is added to the position, in m, and to the velocity, in m/s. Original
    plugin: ``gazebo_ros_gps_sensor`` in the ROS 2 package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_gps_sensor.so",)
    sensor_type: ClassVar[str] = "gps"

    def configure(self) -> None:
        sensor = self.sensor
        name = self.tag.name or "gps"
        device = read_gps(
            self.part,
            sensor,
            "gps",
            topic="out" if self.remaps("out") else f"{name}/out",
            velocity_topic="vel" if self.remaps("vel") else f"{name}/vel",
            frame=self.config.frame or sensor.link,
        )
        self.add(Gps(self.scope, device))
