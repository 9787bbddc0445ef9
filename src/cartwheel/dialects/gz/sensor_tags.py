"""Sensors without a plugin, which gz-sim's systems publish by type, and their tags."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any, ClassVar, TypeVar

from cartwheel.description.model import PluginTag, Sensor
from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.dialects.gz.bridge_file import gz_spelling, gz_topic
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.noise import read_vector_noise
from cartwheel.dialects.tags import tag

C = TypeVar("C")

SYSTEMS = {
    "gz-sim-sensors-system": (
        "camera",
        "depth",
        "depth_camera",
        "rgbd",
        "rgbd_camera",
        "thermal",
        "thermal_camera",
        "wideanglecamera",
        "wide_angle_camera",
        "segmentation",
        "segmentation_camera",
        "boundingbox",
        "boundingbox_camera",
        "gpu_lidar",
        "gpu_ray",
        "lidar",
        "ray",
    ),
    "gz-sim-imu-system": ("imu",),
    "gz-sim-contact-system": ("contact",),
    "gz-sim-navsat-system": ("navsat", "gps"),
    "gz-sim-magnetometer-system": ("magnetometer",),
    "gz-sim-altimeter-system": ("altimeter",),
    "gz-sim-logical-camera-system": ("logical_camera",),
    "gz-sim-air-pressure-system": ("air_pressure",),
    "gz-sim-air-speed-system": ("air_speed",),
    "gz-sim-forcetorque-system": ("force_torque",),
}
"""Sensor types that each system enables, in both spellings of sdformat. A system has no other
effect: Cartwheel's plugins serve the types themselves.
"""

CLASSES = {
    "gz-sim-sensors-system": "Sensors",
    "gz-sim-imu-system": "Imu",
    "gz-sim-contact-system": "Contact",
    "gz-sim-navsat-system": "NavSat",
    "gz-sim-magnetometer-system": "Magnetometer",
    "gz-sim-altimeter-system": "Altimeter",
    "gz-sim-logical-camera-system": "LogicalCamera",
    "gz-sim-air-pressure-system": "AirPressure",
    "gz-sim-air-speed-system": "AirSpeed",
    "gz-sim-forcetorque-system": "ForceTorque",
}
"""The classes of these systems, in the namespace ``gz::sim::systems``."""
RAYS_ON_CPU = frozenset({"lidar", "ray"})
"""Lidars that no system publishes up to Jetty."""
_CONTROL = ("gz_ros2_control-system", "ign_ros2_control-system")
_NEW_TYPES = {
    "rgbd",
    "rgbd_camera",
    "thermal",
    "thermal_camera",
    "segmentation",
    "segmentation_camera",
    "boundingbox",
    "boundingbox_camera",
    "gpu_lidar",
    "lidar",
    "navsat",
    "air_pressure",
    "air_speed",
}
"""Types that Gazebo Classic does not have."""
_NEW_TAGS = ("topic", "gz_frame_id", "ignition_frame_id")


def topic_tag(message: str, last: str) -> Any:
    """Returns the field for the topic of a sensor's messages; `last` ends the default topic."""
    return tag(
        "topic",
        default="",
        doc=f"Topic of the {message} messages. Default: "
        f"`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/{last}`.",
    )


def frame_tag(*more: str, default: str = "the sensor's link") -> Any:
    """Returns the field for the frame ID of gz-sim's sensors, with `more` spellings of the tag."""
    return tag(
        "gz_frame_id",
        "ignition_frame_id",
        *more,
        default="",
        doc=f"Frame ID of the messages. Default: {default}.",
    )


def publishes(sensor: Sensor, systems: Iterable[str]) -> bool:
    """Whether a sensor without a plugin publishes.

    It publishes if its system is loaded, or if the sensor or its model is written for gz-sim, whose
    world then loads the systems of sensors. Gazebo Classic's sensors publish nothing to ROS without
    a plugin.

    Args:
        sensor: A sensor without a plugin.
        systems: Short names of the plugins in the world and in the model.
    """
    if any(sensor.type in SYSTEMS.get(system, ()) for system in systems):
        return True
    if any(is_of_gz(system) for system in systems):
        return any(sensor.type in types for types in SYSTEMS.values())
    return sensor.type in _NEW_TYPES or any(sensor.element.find(tag) for tag in _NEW_TAGS)


def is_of_gz(plugin: str) -> bool:
    """Whether only gz-sim has a plugin with this short name."""
    return plugin.startswith("gz-sim-") or plugin in _CONTROL


def own_tag(sensor: Sensor, known: Iterable[str]) -> PluginTag:
    """Returns the sensor's element as the tag of the plugin that publishes it.

    Only children that the plugin reads are kept.
    """
    tops = {name.split("/")[0] for name in known}
    element = sensor.element
    children = tuple(
        dataclasses.replace(child, text=gz_spelling(child.text)) if child.tag == "topic" else child
        for child in element.children
        if child.tag in tops
    )
    return PluginTag(
        name=sensor.name,
        filename="",
        element=type(element)(tag="sensor", children=children, origin=element.origin),
        origin=sensor.origin,
    )


class GzSensor(SensorPlugin[C]):
    """Base class of the plugins that serve sensors without a ``<plugin>``.

    The parameters have the fields `topic` and `frame`.
    """

    filenames: ClassVar[tuple[str, ...]] = ()

    def topic(self, last: str) -> str:
        """Returns the topic; by default Gazebo's scoped name, ending in `last`."""
        part, sensor = self.part, self.sensor
        scope = ("world", part.world.name, "model", part.name, "link", sensor.link)
        default = gz_topic("/".join((*scope, "sensor", sensor.name, last)))
        config: Any = self.config
        return config.topic or default

    @property
    def frame_id(self) -> str:
        """The frame ID of the messages; by default the sensor's link."""
        config: Any = self.config
        return config.frame or self.sensor.link

    def noise(self, what: str, *paths: str) -> VectorNoiseConfig:
        """Returns the noise of a measurement.

        Args:
            what: Name of the measurement, for the random sequence.
            paths: Element of each quantity, below which is its ``<noise>``.

        Raises:
            PluginError: A number is not allowed.
        """
        return read_vector_noise(
            self.part,
            self.sensor,
            f"{what} {self.sensor.link} {self.sensor.name}",
            [self.sensor.element.find(f"{path}/noise") for path in paths],
        )
