"""Cameras in gz-sim, which need no plugin."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.cameras.depth import DepthOptions
from cartwheel.devices.cameras.eye import Eye, EyeTopics
from cartwheel.dialects.camera_base import CameraBase
from cartwheel.dialects.gz.sensor_tags import default_topic
from cartwheel.dialects.tags import tag

_DEPTHS = ("depth_camera", "depth")


@dataclass(frozen=True, kw_only=True, slots=True)
class GzCameraParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the images; see above. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>`, followed by `/image` for "
        "a camera and by `/depth_image` for a depth camera.",
    )
    frame: str = tag(
        "camera/optical_frame_id",
        "gz_frame_id",
        "ignition_frame_id",
        "frame_id",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    info_topic: str = tag(
        "camera/camera_info_topic",
        default="",
        doc="Topic of the CameraInfo. Default: `camera_info` in the namespace of the image topic.",
    )
    triggered: bool = tag(
        "camera/triggered", default=False, doc="Publish an image only after a trigger message."
    )
    nearest: float = tag(
        "camera/depth_camera/clip/near",
        default=0.0,
        unit="m",
        doc="Depths at or below this value are -inf.",
    )
    furthest: float = tag(
        "camera/depth_camera/clip/far",
        default=math.inf,
        unit="m",
        doc="Depths at or above this value are inf.",
    )
    trigger_topic: str = tag(
        "camera/trigger_topic",
        default="",
        doc="Topic of the Empty messages that trigger an image. Default: `<topic>/trigger`.",
    )


class GzCamera(CameraBase[GzCameraParameters]):
    """Publishes the images of gz-sim's ``camera``, ``depth_camera`` and ``rgbd_camera`` sensors.

    A ``camera`` publishes images on ``<topic>``. A ``depth_camera`` publishes depths on ``<topic>``
    and points on ``<topic>/points``. An ``rgbd_camera`` publishes images on ``<topic>/image``,
    depths on ``<topic>/depth_image`` and points on ``<topic>/points``.

    Depths are measured along the optical axis, and are inf where nothing is hit. Points have x
    forward, y left and z up, as in gz-sim.

    Original sensors: ``CameraSensor``, ``DepthCameraSensor`` and ``RgbdCameraSensor`` in
    gz-sensors. The message types are the same as in ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzCameraParameters
    serves: ClassVar[tuple[str, ...]] = ("camera", "rgbd_camera", *_DEPTHS)

    def _topic(self) -> str:
        assert self.sensor is not None
        last = {"camera": "image", "rgbd_camera": ""}.get(self.sensor.type, "depth_image")
        return self.config.topic or default_topic(self.part, self.sensor, last).rstrip("/")

    def _open_eyes(self) -> Iterator[Eye]:
        sensor, config, topic = self.sensor, self.config, self._topic()
        assert sensor is not None
        around = topic if sensor.type == "rgbd_camera" else topic.rpartition("/")[0]
        image = {"camera": topic, "rgbd_camera": f"{topic}/image"}.get(sensor.type, "")
        info = config.info_topic or (f"{around}/camera_info" if around else "camera_info")
        lens = sensor.cameras[0]
        yield self._eye(
            lens,
            EyeTopics(image=image, info=info, base="", set_info=False, adjustable=False),
            frame=config.frame,
            centre=(lens.width / 2, lens.height / 2),
        )

    def _trigger_topics(self) -> list[str]:
        config = self.config
        return [config.trigger_topic or f"{self._topic()}/trigger"] if config.triggered else []

    def _depth_options(self) -> DepthOptions | None:
        assert self.sensor is not None
        kind, topic = self.sensor.type, self._topic()
        if kind == "camera":
            return None
        return DepthOptions(
            depth=topic if kind in _DEPTHS else f"{topic}/depth_image",
            points=f"{topic}/points",
            nearest=self.config.nearest,
            furthest=self.config.furthest,
            beyond="inf",
            optical=False,
        )
