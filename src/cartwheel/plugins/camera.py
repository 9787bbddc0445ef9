"""``libgazebo_ros_camera.so``: images, their calibration, and JPEGs of them."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.errors import Diagnostic, PluginError, SimulationError
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.parameters import tag

_JPEG_QUALITY = 80
_ENCODINGS = {
    "R8G8B8": ("rgb8", 3),
    "RGB_INT8": ("rgb8", 3),
    "B8G8R8": ("bgr8", 3),
    "BGR_INT8": ("bgr8", 3),
    "L8": ("mono8", 1),
    "L_INT8": ("mono8", 1),
}


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraParameters:
    camera_name: str = tag(
        "cameraName", "camera_name", default="", doc="Namespace of its topics; the sensor's name."
    )
    image_topic: str = tag("imageTopicName", default="image_raw", doc="Image.")
    info_topic: str = tag("cameraInfoTopicName", default="camera_info", doc="CameraInfo.")
    frame: str = tag(
        "frameName", "frame_name", default="", doc="Frame of the messages; the link's when empty."
    )
    update_rate: float = tag(
        "updateRate", "update_rate", default=0.0, unit="Hz", doc="0 is the sensor's own."
    )
    hack_baseline: float = tag(
        "hackBaseline", "hack_baseline", default=0.0, unit="m", doc="Of a stereo pair, in P."
    )
    focal_length: float = tag(
        "focalLength", "focal_length", default=0.0, unit="px", doc="0 is that of the field of view."
    )
    cx: float = tag("Cx", "cx", default=0.0, unit="px", doc="0 is (width + 1) / 2.")
    cy: float = tag("Cy", "cy", default=0.0, unit="px", doc="0 is (height + 1) / 2.")
    cx_prime: float = tag("CxPrime", "cx_prime", default=0.0, unit="px", doc="Accepted.")
    k1: float = tag("distortionK1", "distortion_k1", default=0.0, doc="Radial, told in D.")
    k2: float = tag("distortionK2", "distortion_k2", default=0.0, doc="Radial, told in D.")
    k3: float = tag("distortionK3", "distortion_k3", default=0.0, doc="Radial, told in D.")
    t1: float = tag("distortionT1", "distortion_t1", default=0.0, doc="Tangential, told in D.")
    t2: float = tag("distortionT2", "distortion_t2", default=0.0, doc="Tangential, told in D.")


class Camera(Plugin[CameraParameters]):
    """Publishes what a camera sensor sees, and draws only what somebody reads.

    The sensor looks along its x axis. Source: gazebo_plugins, gazebo_ros_camera and
    gazebo_ros_camera_utils.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_camera.so",)
    parameters: ClassVar[type] = CameraParameters
    for_sensor: ClassVar[bool] = True

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        if not sensor.cameras:
            raise PluginError(f'sensor "{sensor.name}" has no <camera>', origin=sensor.origin)
        lens = self._lens = sensor.cameras[0]
        if lens.format not in _ENCODINGS:
            raise PluginError(
                f'image format "{lens.format}" is not supported',
                origin=sensor.origin,
                hint=f"There are: {', '.join(_ENCODINGS)}.",
            )
        if lens.k1 or lens.k2 or lens.k3 or lens.p1 or lens.p2:
            self.warn("<distortion> has no effect on the image yet: it is drawn undistorted")
        self._encoding, self._channels = _ENCODINGS[lens.format]
        self._camera = self.part.camera(sensor.name, sensor.link, sensor.pose @ lens.pose, lens)
        self._frame = config.frame or sensor.link
        self._Image = message_class("sensor_msgs/msg/Image")
        self._CompressedImage = message_class("sensor_msgs/msg/CompressedImage")
        rates = [rate for rate in (config.update_rate, sensor.update_rate) if rate > 0]
        rate = min(rates, default=0.0)
        base = config.camera_name or sensor.name
        image = f"{base}/{config.image_topic}"
        told = rate or None
        self._image = self.advertise(image, "sensor_msgs/msg/Image", rate=told, qos="sensor")
        self._compressed = self.advertise(
            f"{image}/compressed", "sensor_msgs/msg/CompressedImage", rate=told, qos="sensor"
        )
        self._info = self.advertise(
            f"{base}/{config.info_topic}", "sensor_msgs/msg/CameraInfo", rate=told, qos="sensor"
        )
        self._blind = False
        self.part.schedule(rate, after=self._publish, active=self._wanted)

    def _wanted(self) -> bool:
        return self._image.wanted or self._compressed.wanted or self._info.wanted

    def _publish(self) -> None:
        now = self.part.time_ns
        if self._info.wanted:
            self._info.publish(self._calibration(now))
        if self._blind or not (self._image.wanted or self._compressed.wanted):
            return
        try:
            pixels = self.part.render(self._camera)
        except SimulationError as error:
            # Said once; everything but images goes on.
            self._blind = True
            self.part.report(
                Diagnostic(severity="warning", message=str(error), origin=self.tag.origin)
            )
            return
        pixels = self._noisy(pixels)
        if self._image.wanted:
            self._image.publish(self._raw(now, pixels))
        if self._compressed.wanted:
            self._compressed.publish(self._jpeg(now, pixels))

    def _noisy(self, pixels: Any) -> Any:
        lens = self._lens
        if lens.noise_stddev <= 0 and lens.noise_mean == 0:
            return pixels
        random = self.part.random(f"camera {self._camera.name}")
        noise = random.normal(lens.noise_mean, lens.noise_stddev, pixels.shape) * 255
        return np.clip(pixels + noise, 0, 255).astype(np.uint8)

    def _raw(self, now: int, pixels: Any) -> Any:
        if self._encoding == "bgr8":
            pixels = pixels[..., ::-1]
        elif self._encoding == "mono8":
            pixels = (pixels @ np.array([0.299, 0.587, 0.114])).round().astype(np.uint8)
        height, width = self._lens.height, self._lens.width
        return self._Image(
            header=header(now, self._frame),
            height=height,
            width=width,
            encoding=self._encoding,
            is_bigendian=0,
            step=width * self._channels,
            data=np.ascontiguousarray(pixels).reshape(-1),
        )

    def _jpeg(self, now: int, pixels: Any) -> Any:
        from PIL import Image

        buffer = io.BytesIO()
        Image.fromarray(pixels).save(buffer, format="JPEG", quality=_JPEG_QUALITY)
        return self._CompressedImage(
            header=header(now, self._frame),
            format="rgb8; jpeg compressed bgr8",
            data=np.frombuffer(buffer.getvalue(), dtype=np.uint8),
        )

    def _calibration(self, now: int) -> Any:
        """The pinhole's numbers, with Gazebo's centre at (w + 1) / 2 and its stereo term."""
        lens, config = self._lens, self.config
        focal = config.focal_length or lens.width / (2 * math.tan(lens.horizontal_fov / 2))
        cx = config.cx or (lens.width + 1) / 2
        cy = config.cy or (lens.height + 1) / 2
        return message_class("sensor_msgs/msg/CameraInfo")(
            header=header(now, self._frame),
            height=lens.height,
            width=lens.width,
            distortion_model="plumb_bob",
            d=np.array([config.k1, config.k2, config.t1, config.t2, config.k3]),
            k=np.array([focal, 0, cx, 0, focal, cy, 0, 0, 1]),
            r=np.eye(3).ravel(),
            p=np.array([focal, 0, cx, -focal * config.hack_baseline, 0, focal, cy, 0, 0, 0, 1, 0]),
            binning_x=0,
            binning_y=0,
            roi=message_class("sensor_msgs/msg/RegionOfInterest")(
                x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
            ),
        )
