"""The image of one lens of a camera, with its calibration and topics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.component import Component
from cartwheel.description.model import CameraIntrinsics, Pinhole
from cartwheel.devices.cameras.compressed import (
    COMPRESSED,
    DEPTH_PARAMETERS,
    CompressedImages,
)
from cartwheel.devices.cameras.formats import ImageFormat, Pixels
from cartwheel.devices.cameras.info import INFO, SET_INFO, Calibration, CalibrationConfig
from cartwheel.devices.cameras.lens import Distortion, Lens
from cartwheel.geometry import Pose
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
"""Name and limits. Source: GazeboRosCamera.cfg in gazebo_plugins."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ImagerConfig:
    """Lens, calibration and topics of an `Imager`."""

    intrinsics: CameraIntrinsics
    """Image size, field of view, noise, and the pose of the lens in the camera."""
    distortion: Distortion
    """Distortion of the lens, which replaces that of the intrinsics."""
    format: ImageFormat
    calibration: CalibrationConfig
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    image_topic: str
    """Topic of the images; empty if only depths are published."""
    info_topic: str
    """Topic of the CameraInfo."""
    pinhole: Pinhole | None = None
    """Focal lengths and principal point of the image; None: those of the field of view."""
    namespace: str = ""
    """Namespace of the services; empty if no service needs one."""
    set_info: bool = True
    """Whether the service ``set_camera_info`` is offered."""
    adjustable: bool = True
    """Whether the frame rate and the compression can be changed with ROS 1's dynamic_reconfigure.
    The topic ``<image_topic>/compressedDepth`` is then listed too."""


class Imager:
    """Renders and publishes the images of one lens when its camera requests it.

    Args:
        owner: The camera.
        config: Lens and topics.
        name: Name of the camera.
        link: Link of the camera.
        pose: Pose of the camera in its link.
        rate: Hz; 0 for every step.
        on_rate: Called with a new rate.
    """

    def __init__(
        self,
        owner: Component,
        config: ImagerConfig,
        *,
        name: str,
        link: str,
        pose: Pose,
        rate: float,
        on_rate: Callable[[float], None],
    ) -> None:
        intrinsics = config.intrinsics
        self._owner = owner
        self.lens = Lens(intrinsics, config.distortion, config.pinhole)
        self.frame = owner.frame(config.frame)
        self.calibration = Calibration(self.lens, self.frame, config.calibration)
        self._noise = (intrinsics.noise_mean, intrinsics.noise_stddev)
        self._format = config.format
        self._camera = owner.part.camera(name, link, pose @ intrinsics.pose, self.lens.rendered)
        self._message = message_class("sensor_msgs/msg/Image")
        listed_rate = rate or None
        self._info = owner.advertise(config.info_topic, INFO, rate=listed_rate, qos="sensor")
        self._image: Publisher | None = None
        self._compressed: CompressedImages | None = None
        image = config.image_topic
        if image:
            self._image = owner.advertise(
                image, "sensor_msgs/msg/Image", rate=listed_rate, qos="sensor"
            )
        free = not config.set_info or owner.serve(
            topic_in(config.namespace, "set_camera_info"), SET_INFO, self.calibration.set
        )
        adjustable = config.adjustable and free
        if image:
            self._compressed = CompressedImages(
                owner, image, self._format, rate=listed_rate, adjustable=adjustable
            )
        if adjustable:
            # This topic is only listed: colour images have no depths to publish.
            owner.advertise(f"{image}/compressedDepth", COMPRESSED, qos="sensor")
            owner.reconfigure(
                f"{image}/compressedDepth", DEPTH_PARAMETERS, lambda _: None, preset=True
            )
        if adjustable and config.namespace.strip("/"):
            owner.reconfigure(
                config.namespace,
                (_RATE,),
                lambda values: on_rate(float(values["imager_rate"])),
                initial={"imager_rate": rate},
            )

    @property
    def needs_rendering(self) -> bool:
        """Whether the image has subscribers, so that it must be rendered."""
        return (self._image is not None and self._image.wanted) or (
            self._compressed is not None and self._compressed.wanted
        )

    @property
    def wanted(self) -> bool:
        """Whether the image or the calibration has subscribers."""
        return self.needs_rendering or self._info.wanted

    def render(self) -> Pixels:
        """Renders the current image: RGB, shape (height, width, 3).

        Raises:
            SimulationError: OpenGL is not available, or was opened before a fork.
        """
        return self._with_noise(self.lens.image(self._owner.part.render(self._camera)))

    def render_with_depth(self) -> tuple[Pixels, NDArray[np.float32]]:
        """Renders the image and the depths along the optical axis in m; inf where nothing is hit.

        Raises:
            SimulationError: OpenGL is not available, or was opened before a fork.
        """
        pixels, depths = self._owner.part.render_with_depth(self._camera)
        return self._with_noise(self.lens.image(pixels)), self.lens.depths(depths)

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

    def _with_noise(self, pixels: Pixels) -> Pixels:
        """Adds noise: one random number for each pixel, the same for all colours."""
        mean, stddev = self._noise
        if stddev <= 0 and mean == 0:
            return pixels
        random = self._owner.part.random(f"camera {self._camera.name}")
        noise = random.normal(mean, max(stddev, 0.0), (*pixels.shape[:2], 1))
        noise *= 255
        # Rounding down first gives the same values, and integers take a third of the time.
        np.floor(noise, out=noise)
        np.clip(noise, -255, 255, out=noise)
        noisy = pixels + noise.astype(np.int16)
        np.clip(noisy, 0, 255, out=noisy)
        return noisy.astype(np.uint8)


def topic_in(namespace: str, topic: str) -> str:
    """Returns a topic in a namespace, unless the topic is global."""
    return f"{namespace}/{topic}" if namespace and not topic.startswith("/") else topic
