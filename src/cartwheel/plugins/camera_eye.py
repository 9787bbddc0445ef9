"""One lens of a camera with its topics: what it sees, and what is told of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes import devices
from cartwheel.description.model import CameraIntrinsics, Sensor
from cartwheel.graph import Publisher, ReconfigureParameter
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.camera_compressed import (
    COMPRESSED,
    DEPTH_PARAMETERS,
    CompressedImages,
)
from cartwheel.plugins.camera_formats import FORMATS, ImageFormat, Pixels
from cartwheel.plugins.camera_info import INFO, SET_INFO, Calibration
from cartwheel.plugins.camera_lens import Lens

_RATE = ReconfigureParameter(
    name="imager_rate",
    type="double",
    default=2.0,
    minimum=1.0,
    maximum=50.0,
    level=3,
    description="Images a second",
)
"""As gazebo_plugins' GazeboRosCamera.cfg has it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class EyeTopics:
    """Where an eye publishes."""

    image: str
    """"" is without images."""
    info: str
    base: str
    """Namespace of its services; "" is without those that need one."""
    set_info: bool = True
    """Whether ``set_camera_info`` is offered."""
    adjustable: bool = True
    """Whether ROS 1's dynamic_reconfigure is."""


class Eye:
    """Draws and publishes, when its plugin says so.

    Args:
        plugin: Whose it is.
        sensor: That has the lens.
        lens: As the description states it, with its pose in the sensor.
        bent: The same with its distortion.
        calibration: What is told of it.
        topics: Where.
        frame: Of the messages.
        rate: Hz, 0 is every step.
        on_rate: Called with another rate.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        sensor: Sensor,
        lens: CameraIntrinsics,
        *,
        bent: Lens,
        calibration: Calibration,
        topics: EyeTopics,
        frame: str,
        rate: float,
        on_rate: Callable[[float], None],
    ) -> None:
        self._plugin = plugin
        self.lens = bent
        self.calibration = calibration
        self.frame = frame
        self._noise = (lens.noise_mean, lens.noise_stddev)
        self._format = image_format(plugin, lens.format)
        self._camera = plugin.part.camera(
            sensor.name, sensor.link, sensor.pose @ lens.pose, bent.drawn
        )
        self._message = message_class("sensor_msgs/msg/Image")
        told = rate or None
        self._info = plugin.advertise(topics.info, INFO, rate=told, qos="sensor")
        self._image: Publisher | None = None
        self._compressed: CompressedImages | None = None
        if topics.image:
            self._image = plugin.advertise(
                topics.image, "sensor_msgs/msg/Image", rate=told, qos="sensor"
            )
        free = not topics.set_info or plugin.serve(
            joined(topics.base, "set_camera_info"), SET_INFO, calibration.set
        )
        adjustable = topics.adjustable and free
        if topics.image:
            self._compressed = CompressedImages(
                plugin, topics.image, self._format, rate=told, adjustable=adjustable
            )
        if adjustable:
            # Listed by Gazebo for every camera; of colours there are no depths to compress.
            plugin.advertise(f"{topics.image}/compressedDepth", COMPRESSED, qos="sensor")
            plugin.reconfigure(
                f"{topics.image}/compressedDepth", DEPTH_PARAMETERS, lambda _: None, preset=True
            )
        if adjustable and topics.base.strip("/"):
            plugin.reconfigure(
                topics.base,
                (_RATE,),
                lambda values: on_rate(float(values["imager_rate"])),
                initial={"imager_rate": rate},
            )

    @property
    def sees(self) -> bool:
        """Whether somebody wants its image."""
        return (self._image is not None and self._image.wanted) or (
            self._compressed is not None and self._compressed.wanted
        )

    @property
    def wanted(self) -> bool:
        return self.sees or self._info.wanted

    def picture(self) -> Pixels:
        """The image of now, RGB, shape (height, width, 3).

        Raises:
            SimulationError: No OpenGL, or opened before a fork.
        """
        return self._noisy(self.lens.image(self._plugin.part.render(self._camera)))

    def picture_with_depth(self) -> tuple[Pixels, NDArray[np.float32]]:
        """The same with the depths along the optical axis in m; inf where nothing is.

        Raises:
            SimulationError: No OpenGL, or opened before a fork.
        """
        pixels, depths = self._plugin.part.render_with_depth(self._camera)
        return self._noisy(self.lens.image(pixels)), self.lens.depths(depths)

    def publish_info(self, now: int) -> None:
        """Tells the calibration, where somebody reads it."""
        if self._info.wanted:
            self._info.publish(self.calibration.message(now))

    def publish(self, now: int, pixels: Pixels) -> None:
        """Publishes an image in every way that somebody reads."""
        moment = header(now, self.frame)
        if self._image is not None and self._image.wanted:
            self._image.publish(self._raw(moment, pixels))
        if self._compressed is not None and self._compressed.wanted:
            self._compressed.publish(moment, pixels)

    def _raw(self, moment: Any, pixels: Pixels) -> Any:
        form, lens = self._format, self.lens.intrinsics
        data = np.ascontiguousarray(form.encode(pixels)).reshape(-1)
        return self._message(
            header=moment,
            height=lens.height,
            width=lens.width,
            encoding=form.encoding,
            is_bigendian=0,
            step=lens.width * form.bytes_per_pixel,
            data=data.view(np.uint8),
        )

    def _noisy(self, pixels: Pixels) -> Pixels:
        """One random number for each pixel, the same for its three colours, as Gazebo has it."""
        mean, spread = self._noise
        if spread <= 0 and mean == 0:
            return pixels
        random = self._plugin.part.random(f"camera {self._camera.name}")
        noise = random.normal(mean, max(spread, 0.0), (*pixels.shape[:2], 1)) * 255
        noisy: Pixels = np.clip(pixels + noise, 0, 255).astype(np.uint8)
        return noisy


def joined(base: str, topic: str) -> str:
    """A topic under a namespace, unless it is a global one."""
    return f"{base}/{topic}" if base and not topic.startswith("/") else topic


def image_format(plugin: Plugin[Any], name: str) -> ImageFormat:
    """The format of that name; colours, and a word of it, where there is none."""
    known = FORMATS.get(name.strip().upper())
    if known is not None:
        return known
    # One of floats is of a depth camera's depths, which are floats whatever is said.
    if "FLOAT" not in name.upper():
        plugin.warn(
            devices.IMAGE_FORMAT_UNKNOWN,
            f'the image format "{name}" is not supported: R8G8B8 is used',
            hint=f"There are: {', '.join(FORMATS)}.",
            values={"format": name},
        )
    return FORMATS["R8G8B8"]
