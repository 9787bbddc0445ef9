"""``librealsense_gazebo_plugin.so``: a camera of colours, two of infrared, and one of depths."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.camera_base import CameraBase
from cartwheel.plugins.camera_depth import DepthOptions
from cartwheel.plugins.camera_eye import Eye, EyeTopics, joined
from cartwheel.plugins.parameters import tag, tags_of
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class RealSenseParameters:
    prefix: str = tag("prefix", default="", doc="Before the names of its sensors.")
    color_topic: str = tag("colorTopicName", default="color", doc="Image of colours.")
    infrared1_topic: str = tag("infrared1TopicName", default="infrared", doc="Image.")
    infrared2_topic: str = tag("infrared2TopicName", default="infrared2", doc="Image.")
    depth_topic: str = tag("depthTopicName", default="depth", doc="Image of depths, in mm.")
    points_topic: str = tag("pointCloudTopicName", default="points", doc="PointCloud2.")
    color_frame: str = tag(
        "colorOpticalframeName", default="", doc="Of the messages; the link's when empty."
    )
    infrared1_frame: str = tag("infrared1OpticalframeName", default="", doc="The same.")
    infrared2_frame: str = tag("infrared2OpticalframeName", default="", doc="The same.")
    depth_frame: str = tag("depthOpticalframeName", default="", doc="The same, and the points'.")
    color_rate: float = tag(
        "colorUpdateRate", default=0.0, unit="Hz", doc="No more than the sensor's; 0 is that."
    )
    infrared_rate: float = tag("infraredUpdateRate", default=0.0, unit="Hz", doc="The same.")
    depth_rate: float = tag("depthUpdateRate", default=0.0, unit="Hz", doc="The same.")
    nearest: float = tag("rangeMinDepth", default=0.0, unit="m", doc="Depths up to this are 0.")
    furthest: float = tag(
        "rangeMaxDepth", default=65.535, unit="m", doc="Depths from this on are 0."
    )
    points: bool = tag("pointCloud", default=False, doc="Publish points.")
    points_nearest: float = tag(
        "pointCloudCutoff", default=0.0, unit="m", doc="Points up to this are nan."
    )
    points_furthest: float = tag(
        "pointCloudCutoffMax", default=5.0, unit="m", doc="Points from this on are nan."
    )
    color_info: str = tag(
        "colorCameraInfoTopicName", default="", doc="Has no effect: it is beside the image."
    )
    infrared1_info: str = tag("infrared1CameraInfoTopicName", default="", doc="The same.")
    infrared2_info: str = tag("infrared2CameraInfoTopicName", default="", doc="The same.")
    depth_info: str = tag("depthCameraInfoTopicName", default="", doc="The same.")


class _Stream(CameraBase[RealSenseParameters]):
    """One of the four."""

    parameters: ClassVar[type] = RealSenseParameters

    def __init__(
        self,
        part: Part,
        graph: Any,
        tag: PluginTag,
        sensor: Sensor,
        *,
        topic: str,
        frame: str,
        rate: float,
        depth: DepthOptions | None,
    ) -> None:
        self._image_topic, self._told_frame = topic, frame
        self._told_rate, self._options = rate, depth
        super().__init__(part, graph, tag, sensor)

    def _asked_rate(self) -> float:
        return self._told_rate

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
            lens, topics, frame=self._told_frame, centre=(lens.width / 2, lens.height / 2)
        )

    def _depth_options(self) -> DepthOptions | None:
        return self._options


class RealSense(Plugin[RealSenseParameters]):
    """Publishes what the four sensors of an Intel RealSense see, under the plugin's own name.

    They are the model's sensors ``<prefix>color``, ``ired1``, ``ired2`` and ``depth``; one that is
    missing is told. ``camera_info`` is beside each image. Depths are 16UC1 in mm, 0 where there is
    none. Source: pal-robotics, realsense_gazebo_plugin.
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
                self.graph,
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
            f'the sensor "{name}" does not exist, so this camera publishes nothing of it',
            values={"name": name},
        )
        return None

    def _quiet_tag(self) -> PluginTag:
        """The tag without unknown elements, which were reported."""
        known = tags_of(RealSenseParameters) | {"robotNamespace", "ros"}
        element = self.tag.element
        children = tuple(child for child in element.children if child.tag in known)
        return replace(self.tag, element=replace(element, children=children))
