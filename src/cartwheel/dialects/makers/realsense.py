"""``librealsense_gazebo_plugin.so``: a colour camera, two infrared cameras, a depth camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.description.model import Sensor
from cartwheel.devices.cameras.camera import Camera, CameraConfig
from cartwheel.devices.cameras.depth_camera import DepthConfig
from cartwheel.devices.cameras.imager import ImagerConfig, topic_in
from cartwheel.devices.cameras.info import CalibrationConfig
from cartwheel.dialects.common_tags import sensor_rate_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.camera import read_camera, read_lens
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.tags import tag


def _frame_tag(name: str, *, of: str) -> Any:
    return tag(name, default="", doc=f"Frame ID of {of}. Default: the sensor's link.")


def _info_tag(name: str) -> Any:
    return tag(
        name,
        default="",
        doc="No effect: the topic is always `camera_info`, in the namespace of the image topic.",
    )


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
    color_frame: str = _frame_tag("colorOpticalframeName", of="the colour images")
    infrared1_frame: str = _frame_tag("infrared1OpticalframeName", of="the first infrared images")
    infrared2_frame: str = _frame_tag("infrared2OpticalframeName", of="the second infrared images")
    depth_frame: str = _frame_tag("depthOpticalframeName", of="the depth images and points")
    color_rate: float = sensor_rate_tag("colorUpdateRate", what="Rate of the colour images")
    infrared_rate: float = sensor_rate_tag("infraredUpdateRate", what="Rate of the infrared images")
    depth_rate: float = sensor_rate_tag("depthUpdateRate", what="Rate of the depth images")
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
    points: bool = tag("pointCloud", default=False, doc="Whether to publish point clouds.")
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
    color_info: str = _info_tag("colorCameraInfoTopicName")
    infrared1_info: str = _info_tag("infrared1CameraInfoTopicName")
    infrared2_info: str = _info_tag("infrared2CameraInfoTopicName")
    depth_info: str = _info_tag("depthCameraInfoTopicName")


class RealSense(Plugin[RealSenseParameters]):
    """Publishes the colour, infrared and depth images of an Intel RealSense camera.

    The images come from the model's sensors ``<prefix>color``, ``<prefix>ired1``, ``<prefix>ired2``
    and ``<prefix>depth``. If one of these sensors is missing, Cartwheel reports it. The plugin's
    name is the namespace of the topics. Each image topic has a ``camera_info`` topic in the same
    namespace. Depth images have the encoding 16UC1, with depths in mm; 0 means that no depth was
    measured. Original plugin: ``realsense_gazebo_plugin`` by PAL Robotics.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librealsense_gazebo_plugin.so",)
    empty_is_model: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        base = self.tag.name
        depth = DepthConfig(
            depth_topic=topic_in(base, config.depth_topic),
            points_topic=topic_in(base, config.points_topic) if config.points else "",
            nearest=config.nearest,
            furthest=config.furthest,
            points_nearest=config.points_nearest,
            points_furthest=config.points_furthest,
            millimetres=True,
        )
        for name, topic, frame, rate, depths in (
            ("color", config.color_topic, config.color_frame, config.color_rate, None),
            ("ired1", config.infrared1_topic, config.infrared1_frame, config.infrared_rate, None),
            ("ired2", config.infrared2_topic, config.infrared2_frame, config.infrared_rate, None),
            ("depth", config.depth_topic, config.depth_frame, config.depth_rate, depth),
        ):
            sensor = self._sensor(config.prefix + name)
            if sensor is not None:
                image = topic_in(base, topic)
                self._add_camera(sensor, image, frame=frame, rate=rate, depth=depths)

    def _add_camera(
        self, sensor: Sensor, topic: str, *, frame: str, rate: float, depth: DepthConfig | None
    ) -> None:
        sensor = read_camera(self, sensor)
        lens, distortion, image_format = read_lens(self, sensor.cameras[0])
        imager = ImagerConfig(
            intrinsics=lens,
            distortion=distortion,
            format=image_format,
            calibration=CalibrationConfig(centre=(lens.width / 2, lens.height / 2)),
            frame=frame or sensor.link,
            image_topic="" if depth is not None else topic,
            info_topic=topic_in(topic.rpartition("/")[0], "camera_info"),
            set_info=False,
            adjustable=False,
        )
        device = CameraConfig(
            name=sensor.name,
            link=sensor.link,
            pose=sensor.pose,
            rate=slowest(rate, sensor.update_rate),
            imagers=(imager,),
            depth=depth,
        )
        self.add(Camera(self.scope, device))

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
