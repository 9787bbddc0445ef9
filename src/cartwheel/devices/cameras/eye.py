"""One lens of a camera, with its images, calibration and topics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.description.model import CameraIntrinsics, Sensor
from cartwheel.devices.cameras.compressed import (
    COMPRESSED,
    DEPTH_PARAMETERS,
    CompressedImages,
)
from cartwheel.devices.cameras.formats import FORMATS, ImageFormat, Pixels
from cartwheel.devices.cameras.info import INFO, SET_INFO, Calibration
from cartwheel.devices.cameras.lens import Lens
from cartwheel.graph import Publisher, ReconfigureParameter
from cartwheel.messages import header, message_class

_RATE = ReconfigureParameter(
    name="imager_rate",
    type="double",
    default=2.0,
    minimum=1.0,
    maximum=50.0,
    level=3,
    description="Frame rate, Hz",
)
"""From GazeboRosCamera.cfg in gazebo_plugins."""


@dataclass(frozen=True, kw_only=True, slots=True)
class EyeTopics:
    """Topics and services of a lens."""

    image: str
    """Empty if no images are published."""
    info: str
    base: str
    """Namespace of the services; empty if no service needs one."""
    set_info: bool = True
    """Whether ``set_camera_info`` is offered."""
    adjustable: bool = True
    """Whether ROS 1's dynamic_reconfigure is offered."""


class Eye:
    """Renders and publishes the images of one lens when its plugin requests it.

    Args:
        owner: The publishing plugin.
        sensor: The sensor of the lens.
        lens: Intrinsics from the description, with the pose of the lens in the sensor.
        bent: The lens with its distortion.
        calibration: The published CameraInfo.
        topics: Topics and services.
        frame: Frame ID of the messages.
        rate: Hz; 0 for every step.
        on_rate: Called with a new rate.
    """

    def __init__(
        self,
        owner: Component,
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
        self._owner = owner
        self.lens = bent
        self.calibration = calibration
        self.frame = frame
        self._noise = (lens.noise_mean, lens.noise_stddev)
        self._format = image_format(owner, lens.format)
        self._camera = owner.part.camera(
            sensor.name, sensor.link, sensor.pose @ lens.pose, bent.drawn
        )
        self._message = message_class("sensor_msgs/msg/Image")
        listed_rate = rate or None
        self._info = owner.advertise(topics.info, INFO, rate=listed_rate, qos="sensor")
        self._image: Publisher | None = None
        self._compressed: CompressedImages | None = None
        if topics.image:
            self._image = owner.advertise(
                topics.image, "sensor_msgs/msg/Image", rate=listed_rate, qos="sensor"
            )
        free = not topics.set_info or owner.serve(
            joined(topics.base, "set_camera_info"), SET_INFO, calibration.set
        )
        adjustable = topics.adjustable and free
        if topics.image:
            self._compressed = CompressedImages(
                owner, topics.image, self._format, rate=listed_rate, adjustable=adjustable
            )
        if adjustable:
            # Gazebo lists this topic for every camera; colour images have no depths to publish.
            owner.advertise(f"{topics.image}/compressedDepth", COMPRESSED, qos="sensor")
            owner.reconfigure(
                f"{topics.image}/compressedDepth", DEPTH_PARAMETERS, lambda _: None, preset=True
            )
        if adjustable and topics.base.strip("/"):
            owner.reconfigure(
                topics.base,
                (_RATE,),
                lambda values: on_rate(float(values["imager_rate"])),
                initial={"imager_rate": rate},
            )

    @property
    def sees(self) -> bool:
        """Whether the image has subscribers."""
        return (self._image is not None and self._image.wanted) or (
            self._compressed is not None and self._compressed.wanted
        )

    @property
    def wanted(self) -> bool:
        return self.sees or self._info.wanted

    def picture(self) -> Pixels:
        """Renders the current image: RGB, shape (height, width, 3).

        Raises:
            SimulationError: OpenGL is not available, or was opened before a fork.
        """
        return self._noisy(self.lens.image(self._owner.part.render(self._camera)))

    def picture_with_depth(self) -> tuple[Pixels, NDArray[np.float32]]:
        """Renders the image and the depths along the optical axis in m; inf where nothing is hit.

        Raises:
            SimulationError: OpenGL is not available, or was opened before a fork.
        """
        pixels, depths = self._owner.part.render_with_depth(self._camera)
        return self._noisy(self.lens.image(pixels)), self.lens.depths(depths)

    def publish_info(self, now: int) -> None:
        """Publishes the calibration if it has subscribers."""
        if self._info.wanted:
            self._info.publish(self.calibration.message(now))

    def publish(self, now: int, pixels: Pixels) -> None:
        """Publishes an image in each encoding that has subscribers."""
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
        """Adds noise: one random number for each pixel, the same for all colours, as in Gazebo."""
        mean, spread = self._noise
        if spread <= 0 and mean == 0:
            return pixels
        random = self._owner.part.random(f"camera {self._camera.name}")
        noise = random.normal(mean, max(spread, 0.0), (*pixels.shape[:2], 1)) * 255
        noisy: Pixels = np.clip(pixels + noise, 0, 255).astype(np.uint8)
        return noisy


def joined(base: str, topic: str) -> str:
    """Returns a topic under a namespace, unless the topic is global."""
    return f"{base}/{topic}" if base and not topic.startswith("/") else topic


def image_format(owner: Component, name: str) -> ImageFormat:
    """Returns the format with this name; colour, with a warning, if it is not supported."""
    known = FORMATS.get(name.strip().upper())
    if known is not None:
        return known
    # Float formats belong to depth cameras, whose depths are always floats.
    if "FLOAT" not in name.upper():
        owner.warn(
            devices.IMAGE_FORMAT_UNKNOWN,
            f'the image format "{name}" is not supported, so R8G8B8 is used',
            hint=f"Supported formats: {', '.join(FORMATS)}.",
            values={"format": name},
        )
    return FORMATS["R8G8B8"]
