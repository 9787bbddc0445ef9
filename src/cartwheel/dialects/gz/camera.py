"""Cameras in gz-sim, which need no plugin."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import CameraIntrinsics, Pinhole, Sensor
from cartwheel.description.sdf.sensors import NARROWEST
from cartwheel.devices.cameras.camera import Camera, CameraConfig
from cartwheel.devices.cameras.depth_camera import DepthConfig
from cartwheel.devices.cameras.imager import ImagerConfig
from cartwheel.devices.cameras.info import CalibrationConfig, Rectified
from cartwheel.dialects.gz.bridge_file import gz_spelling
from cartwheel.dialects.gz.sensor_tags import GzSensor
from cartwheel.dialects.sdf.camera import read_camera, read_lens
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.tags import tag

_DEPTHS = ("depth_camera", "depth")
_COLOURED_DEPTHS = ("rgbd_camera", "rgbd")
_SHORTEST = 1e-3
"""Minimum focal length, pixels; with a shorter one, an image shows a single point."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GzCameraParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the images, or the prefix of several topics, as described above. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>`, followed by `/image` "
        "for a camera and by `/depth_image` for a depth camera.",
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
        doc="Topic of the CameraInfo messages. Default: `camera_info` in the namespace of the "
        "image topic.",
    )
    triggered: bool = tag(
        "camera/triggered",
        default=False,
        doc="Whether to publish an image only after a trigger message.",
    )
    nearest: float = tag(
        "camera/depth_camera/clip/near",
        default=0.0,
        unit="m",
        doc="Depths at or below this value are published as -inf.",
    )
    furthest: float = tag(
        "camera/depth_camera/clip/far",
        default=math.inf,
        unit="m",
        doc="Depths at or above this value are published as inf.",
    )
    trigger_topic: str = tag(
        "camera/trigger_topic",
        default="",
        doc="Topic of the Empty messages that trigger an image. Default: `<topic>/trigger`.",
    )


class GzCamera(GzSensor[GzCameraParameters]):
    """Publishes images, depth images and point clouds of gz-sim's camera sensors.

    A ``camera`` sensor publishes images on ``<topic>``. A ``depth_camera`` sensor publishes depth
    images on ``<topic>`` and point clouds on ``<topic>/points``. An ``rgbd_camera`` sensor
    publishes images on ``<topic>/image``, depth images on ``<topic>/depth_image`` and point clouds
    on ``<topic>/points``.

    The focal lengths and the principal point in ``<lens><projection>``, or else in
    ``<lens><intrinsics>``, replace ``<horizontal_fov>``. The skew is ignored.

    Depths are measured along the optical axis, and are inf for pixels without a surface. In the
    frame of the points, x points forward, y left and z up, as in gz-sim.

    The sensor corresponds to ``CameraSensor``, ``DepthCameraSensor`` and ``RgbdCameraSensor`` in
    gz-sensors. The message types are the same as in ros_gz_bridge.
    """

    empty_is_model: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "camera"
    serves: ClassVar[tuple[str, ...]] = ("camera", *_COLOURED_DEPTHS, *_DEPTHS)

    def configure(self) -> None:
        config, sensor = self.config, read_camera(self, self.sensor, pinhole=True)
        topic = self.topic(_last(sensor))
        trigger = gz_spelling(config.trigger_topic) or f"{topic}/trigger"
        device = CameraConfig(
            name=sensor.name,
            link=sensor.link,
            pose=sensor.pose,
            rate=slowest(sensor.update_rate),
            imagers=(self._imager(sensor, topic),),
            depth=self._depth(sensor, topic),
            trigger_topics=(trigger,) if config.triggered else (),
        )
        self.add(Camera(self.scope, device))

    def _imager(self, sensor: Sensor, topic: str) -> ImagerConfig:
        around = topic if sensor.type in _COLOURED_DEPTHS else topic.rpartition("/")[0]
        camera = sensor.cameras[0]
        stated = self._usable(camera.pinhole, camera.width, "intrinsics")
        rendered = self._usable(camera.projection, camera.width, "projection") or stated
        calibration = _calibration(camera, stated, rendered)
        if rendered is not None:
            view = _view(rendered, camera.width)
            camera = dataclasses.replace(camera, horizontal_fov=view)
        lens, distortion, image_format = read_lens(self, camera)
        return ImagerConfig(
            intrinsics=lens,
            pinhole=rendered,
            distortion=distortion,
            format=image_format,
            calibration=calibration,
            frame=self.frame_id,
            image_topic=_image_topic(sensor, topic),
            info_topic=gz_spelling(self.config.info_topic)
            or (f"{around}/camera_info" if around else "camera_info"),
            set_info=False,
            adjustable=False,
        )

    def _usable(self, pinhole: Pinhole | None, width: int, setting: str) -> Pinhole | None:
        """A pinhole, if its focal lengths are possible. Otherwise, it is reported."""
        if pinhole is None:
            return None
        shortest = min(pinhole.fx, pinhole.fy)
        if shortest >= _SHORTEST and _view(pinhole, width) >= NARROWEST:
            return pinhole
        self.warn(
            devices.SENSOR_SETTING_IGNORED,
            f"<{setting}> has no effect: the focal lengths {pinhole.fx:g} and {pinhole.fy:g} are "
            "not possible",
            values={"setting": setting},
        )
        return None

    def _depth(self, sensor: Sensor, topic: str) -> DepthConfig | None:
        if sensor.type == "camera":
            return None
        return DepthConfig(
            depth_topic=topic if sensor.type in _DEPTHS else f"{topic}/depth_image",
            points_topic=f"{topic}/points",
            nearest=self.config.nearest,
            furthest=self.config.furthest,
            beyond="inf",
            optical=False,
        )


def _last(sensor: Sensor) -> str:
    """The end of the default topic; empty if the topic is the prefix of several topics."""
    if sensor.type in _COLOURED_DEPTHS:
        return ""
    return "depth_image" if sensor.type in _DEPTHS else "image"


def _image_topic(sensor: Sensor, topic: str) -> str:
    """The topic of the images; empty for a sensor without images."""
    if sensor.type in _COLOURED_DEPTHS:
        return f"{topic}/image"
    return "" if sensor.type in _DEPTHS else topic


def _view(pinhole: Pinhole, width: int) -> float:
    """The horizontal field of view of an image whose principal point is its middle, rad."""
    return 2 * math.atan(width / (2 * pinhole.fx))


def _calibration(
    camera: CameraIntrinsics, stated: Pinhole | None, rendered: Pinhole | None
) -> CalibrationConfig:
    """What the CameraInfo states: the intrinsics in K, and what is rendered in P.

    Source: `CameraSensor::UpdateLensIntrinsicsAndProjection`.
    """
    centre = (camera.width / 2, camera.height / 2)
    if rendered is None:
        return CalibrationConfig(centre=centre)
    focal = camera.width / (2 * math.tan(camera.horizontal_fov / 2))
    return CalibrationConfig(
        pinhole=stated or Pinhole(fx=focal, fy=focal, cx=centre[0], cy=centre[1]),
        rectified=Rectified(
            fx=rendered.fx,
            fy=rendered.fy,
            cx=rendered.cx,
            cy=rendered.cy,
            tx=rendered.tx,
            ty=rendered.ty,
        ),
    )
