"""``librealsense_gazebo_plugin.so``: a colour camera, two infrared cameras, a depth camera."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

from cartwheel.codes import running
from cartwheel.component import Shared
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.devices.cameras.depth import DepthOptions
from cartwheel.devices.cameras.eye import Eye, EyeTopics, joined
from cartwheel.dialects.camera_base import CameraBase
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag, tags_of
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class RealSenseParameters:
    prefix: str = tag("prefix", default="", doc="Prefix of the four sensor names.")
    color_topic: str = tag("colorTopicName", default="color", doc="Topic of the colour images.")
    infrared1_topic: str = tag(
        "infrared1TopicName", default="infrared", doc="Topic of the first infrared images."
    )
    infrared2_topic: str = tag(
        "infrared2TopicName", default="infrared2", doc="Topic of the second infrared images."
    )
    depth_topic: str = tag(
        "depthTopicName", default="depth", doc="Topic of the depth images, in mm."
    )
    points_topic: str = tag(
        "pointCloudTopicName", default="points", doc="Topic of the PointCloud2 messages."
    )
    color_frame: str = tag(
        "colorOpticalframeName",
        default="",
        doc="Frame ID of the colour images. Default: the sensor's link.",
    )
    infrared1_frame: str = tag(
        "infrared1OpticalframeName",
        default="",
        doc="Frame ID of the first infrared images. Default: the sensor's link.",
    )
    infrared2_frame: str = tag(
        "infrared2OpticalframeName",
        default="",
        doc="Frame ID of the second infrared images. Default: the sensor's link.",
    )
    depth_frame: str = tag(
        "depthOpticalframeName",
        default="",
        doc="Frame ID of the depth images and points. Default: the sensor's link.",
    )
    color_rate: float = tag(
        "colorUpdateRate",
        default=0.0,
        unit="Hz",
        doc="Rate of the colour images, at most the sensor's. 0: the sensor's rate.",
    )
    infrared_rate: float = tag(
        "infraredUpdateRate",
        default=0.0,
        unit="Hz",
        doc="Rate of the infrared images, at most the sensor's. 0: the sensor's rate.",
    )
    depth_rate: float = tag(
        "depthUpdateRate",
        default=0.0,
        unit="Hz",
        doc="Rate of the depth images, at most the sensor's. 0: the sensor's rate.",
    )
    nearest: float = tag(
        "rangeMinDepth",
        default=0.0,
        unit="m",
        doc="Depths at or below this value are published as 0.",
    )
    furthest: float = tag(
        "rangeMaxDepth",
        default=65.535,
        unit="m",
        doc="Depths at or above this value are published as 0.",
    )
    points: bool = tag("pointCloud", default=False, doc="Publish point clouds.")
    points_nearest: float = tag(
        "pointCloudCutoff",
        default=0.0,
        unit="m",
        doc="Points with depths at or below this value are NaN.",
    )
    points_furthest: float = tag(
        "pointCloudCutoffMax",
        default=5.0,
        unit="m",
        doc="Points with depths at or above this value are NaN.",
    )
    color_info: str = tag(
        "colorCameraInfoTopicName",
        default="",
        doc="No effect: `camera_info` is in the namespace of the image topic.",
    )
    infrared1_info: str = tag(
        "infrared1CameraInfoTopicName",
        default="",
        doc="No effect: `camera_info` is in the namespace of the image topic.",
    )
    infrared2_info: str = tag(
        "infrared2CameraInfoTopicName",
        default="",
        doc="No effect: `camera_info` is in the namespace of the image topic.",
    )
    depth_info: str = tag(
        "depthCameraInfoTopicName",
        default="",
        doc="No effect: `camera_info` is in the namespace of the image topic.",
    )


class _Stream(CameraBase[RealSenseParameters]):
    """One of the four image streams."""

    parameters: ClassVar[type] = RealSenseParameters

    def __init__(
        self,
        part: Part,
        shared: Shared,
        tag: PluginTag,
        sensor: Sensor,
        *,
        topic: str,
        frame: str,
        rate: float,
        depth: DepthOptions | None,
    ) -> None:
        self._image_topic, self._stream_frame = topic, frame
        self._stream_rate, self._options = rate, depth
        super().__init__(part, shared, tag, sensor)

    def _asked_rate(self) -> float:
        return self._stream_rate

    def _open_eyes(self) -> Iterator[Eye]:
        assert self.sensor is not None
        lens = self.sensor.cameras[0]
        folder = self._image_topic.rpartition("/")[0]
        topics = EyeTopics(
            image="" if self._options is not None else self._image_topic,
            info=joined(folder, "camera_info"),
            base="",
            set_info=False,
            adjustable=False,
        )
        yield self._eye(
            lens, topics, frame=self._stream_frame, centre=(lens.width / 2, lens.height / 2)
        )

    def _depth_options(self) -> DepthOptions | None:
        return self._options


class RealSense(Plugin[RealSenseParameters]):
    """Publishes the colour, infrared and depth images of an Intel RealSense.

    The images come from the model's sensors ``<prefix>color``, ``<prefix>ired1``, ``<prefix>ired2``
    and ``<prefix>depth``. A missing sensor causes a warning. The plugin's name is the namespace of
    the topics. Each image topic has a ``camera_info`` topic in the same namespace. Depth images
    have the encoding 16UC1, in mm. A depth of 0 means that none was measured. Original plugin:
    ``realsense_gazebo_plugin`` by PAL Robotics.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librealsense_gazebo_plugin.so",)
    parameters: ClassVar[type] = RealSenseParameters
    _streams: tuple[_Stream, ...] = ()

    def configure(self) -> None:
        config = self.config
        base = self.tag.name
        depth = DepthOptions(
            depth=joined(base, config.depth_topic),
            points=joined(base, config.points_topic) if config.points else "",
            nearest=config.nearest,
            furthest=config.furthest,
            points_nearest=config.points_nearest,
            points_furthest=config.points_furthest,
            millimetres=True,
        )
        for name, topic, frame, rate, options in (
            ("color", config.color_topic, config.color_frame, config.color_rate, None),
            ("ired1", config.infrared1_topic, config.infrared1_frame, config.infrared_rate, None),
            ("ired2", config.infrared2_topic, config.infrared2_frame, config.infrared_rate, None),
            ("depth", config.depth_topic, config.depth_frame, config.depth_rate, depth),
        ):
            sensor = self._sensor(config.prefix + name)
            if sensor is None:
                continue
            stream = _Stream(
                self.part,
                self.shared,
                self._quiet_tag(),
                sensor,
                topic=joined(base, topic),
                frame=frame,
                rate=rate,
                depth=options,
            )
            self._streams += (stream,)

    def close(self) -> None:
        for stream in self._streams:
            stream.close()
        super().close()

    def _sensor(self, name: str) -> Sensor | None:
        for link in self.part.description.links:
            for sensor in link.sensors:
                if sensor.name == name:
                    self.part.read_sensors.add(name)
                    return sensor
        self.warn(
            running.UNKNOWN_SENSOR,
            f'the sensor "{name}" does not exist, so its images are not published',
            values={"name": name},
        )
        return None

    def _quiet_tag(self) -> PluginTag:
        """Returns the tag without unsupported elements, which have already been reported."""
        known = tags_of(RealSenseParameters) | {"robotNamespace", "ros"}
        element = self.tag.element
        children = tuple(child for child in element.children if child.tag in known)
        return replace(self.tag, element=replace(element, children=children))
