"""``libgazebo_ros_camera.so``: raw and compressed images with their calibration."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar

from cartwheel.codes import devices
from cartwheel.description.model import CameraIntrinsics, Sensor
from cartwheel.description.sdf.sensors import MOST_BENT
from cartwheel.devices.cameras.camera import Camera as CameraDevice
from cartwheel.devices.cameras.camera import CameraConfig
from cartwheel.devices.cameras.depth_camera import DepthConfig
from cartwheel.devices.cameras.imager import ImagerConfig, topic_in
from cartwheel.devices.cameras.info import CalibrationConfig, Rectified
from cartwheel.devices.cameras.lens import Distortion
from cartwheel.dialects.common_tags import sensor_frame_tag, sensor_rate_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.camera import read_camera, read_lens
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.tags import tag, vector

_NINE = 9


def _distortion_tag(name: str, ros2_name: str, doc: str) -> Any:
    return tag(name, ros2_name, default=0.0, most=MOST_BENT, doc=doc)


def _projection_tag(name: str) -> Any:
    element = name.removeprefix("P_")
    doc = f"Element {element} of the projection matrix P (ROS 2 tag). Default: {element} in K."
    return tag(name, default=None, unit="px", doc=doc)


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraParameters:
    camera_name: str = tag(
        "cameraName",
        "camera_name",
        default="",
        role="namespace",
        doc="Namespace of the topics. Default: the sensor's name, or no namespace if the "
        "`<plugin>` contains tags with capital letters, such as `<imageTopicName>`.",
    )
    image_topic: str = tag(
        "imageTopicName", default="image_raw", role="topic", doc="Topic of the images."
    )
    info_topic: str = tag(
        "cameraInfoTopicName", default="camera_info", doc="Topic of the CameraInfo messages."
    )
    frame: str = sensor_frame_tag("frameName", "frame_name")
    update_rate: float = sensor_rate_tag("updateRate", "update_rate", what="Frame rate")
    hack_baseline: float = tag(
        "hackBaseline",
        "hack_baseline",
        default=0.0,
        unit="m",
        doc="Distance from the left camera of a stereo pair to this camera, for the projection "
        "matrix P.",
    )
    focal_length: float = tag(
        "focalLength",
        "focal_length",
        default=0.0,
        unit="px",
        doc="Focal length in the camera matrix K. If 0, it is computed from the field of view.",
    )
    cx: float = tag(
        "Cx",
        "cx",
        default=0.0,
        unit="px",
        doc="x coordinate of the principal point; if 0, (width + 1) / 2.",
    )
    cy: float = tag(
        "Cy",
        "cy",
        default=0.0,
        unit="px",
        doc="y coordinate of the principal point; if 0, (height + 1) / 2.",
    )
    cx_prime: float = tag("CxPrime", "cx_prime", default=0.0, unit="px", doc="No effect.")
    k1: float = _distortion_tag(
        "distortionK1",
        "distortion_k1",
        "Radial distortion coefficient k1. The sensor's `<distortion>` takes precedence.",
    )
    k2: float = _distortion_tag(
        "distortionK2", "distortion_k2", "Radial distortion coefficient k2."
    )
    k3: float = _distortion_tag(
        "distortionK3", "distortion_k3", "Radial distortion coefficient k3."
    )
    t1: float = _distortion_tag(
        "distortionT1", "distortion_t1", "Tangential distortion coefficient t1."
    )
    t2: float = _distortion_tag(
        "distortionT2", "distortion_t2", "Tangential distortion coefficient t2."
    )
    auto_distortion: bool = tag(
        "autoDistortion",
        "auto_distortion",
        default=False,
        doc="No effect: the distortion is always rendered.",
    )
    border_crop: bool = tag(
        "borderCrop",
        "border_crop",
        default=True,
        doc="No effect: the image has no black borders.",
    )
    rectification: str = tag(
        "rectification_matrix",
        default="",
        doc="Rectification matrix R: nine numbers, row by row (ROS 2 tag). Default: identity.",
    )
    p_fx: float | None = _projection_tag("P_fx")
    p_fy: float | None = _projection_tag("P_fy")
    p_cx: float | None = _projection_tag("P_cx")
    p_cy: float | None = _projection_tag("P_cy")
    p_tx: float | None = tag(
        "Tx",
        default=None,
        doc="Element Tx of the projection matrix P (ROS 2 tag). Default: -fx times "
        "`<hackBaseline>`.",
    )
    p_ty: float = tag("Ty", default=0.0, doc="Element Ty of the projection matrix P (ROS 2 tag).")
    trigger_topic: str = tag(
        "triggerTopicName",
        default="image_trigger",
        doc="Topic of the Empty messages that trigger an image.",
    )
    triggered: bool = tag(
        "triggered", default=False, doc="Whether to publish an image only after a trigger message."
    )


P = TypeVar("P", bound=CameraParameters)


class RosCamera(SensorPlugin[P]):
    """Base class of the camera plugins in gazebo_plugins."""

    empty_is_model: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "camera"
    always_triggered: ClassVar[bool] = False
    """Whether images are triggered without the tag ``<triggered>``."""

    def configure(self) -> None:
        self.sensor = sensor = read_camera(self, self.sensor)
        device = CameraConfig(
            name=sensor.name,
            link=sensor.link,
            pose=sensor.pose,
            rate=slowest(self.config.update_rate, sensor.update_rate),
            imagers=tuple(self._imagers(sensor)),
            depth=self._depth(),
            trigger_topics=self._trigger_topics(),
        )
        self.add(CameraDevice(self.scope, device))

    def _depth(self) -> DepthConfig | None:
        """Returns the depth topics, or None if only images are published."""
        return None

    @property
    def is_ros2(self) -> bool:
        """Whether the tag is written for gazebo_plugins in ROS 2."""
        tags = [child.tag for child in self.tag.element.children]
        return "ros" in tags or (
            any("_" in name for name in tags) and all(name.islower() for name in tags)
        )

    def _base(self) -> str:
        """Namespace of all topics. Default: the sensor's name in ROS 2, none in ROS 1."""
        if self.config.camera_name:
            return self.config.camera_name
        written_for_ros1 = not self.is_ros2 and any(
            child.tag != child.tag.lower() for child in self.tag.element.children
        )
        return "" if written_for_ros1 else self.sensor.name

    def _lenses(self) -> Sequence[tuple[CameraIntrinsics, str]]:
        """Returns each lens with the namespace of its topics."""
        base = self._base()
        if self.sensor.type not in ("multicamera", "multi_camera"):
            return [(self.sensor.cameras[0], base)]
        lenses = []
        for index, lens in enumerate(self.sensor.cameras):
            side = lens.name or str(index)
            if not self.is_ros2:
                side = next((word for word in ("left", "right") if word in lens.name), side)
            lenses.append((lens, topic_in(base, side)))
        return lenses

    def _imagers(self, sensor: Sensor) -> Iterator[ImagerConfig]:
        config, lenses = self.config, self._lenses()
        configured = Distortion(
            k1=config.k1, k2=config.k2, p1=config.t1, p2=config.t2, k3=config.k3
        )
        rectified = self._rectified()
        for each, base in lenses:
            left = len(lenses) > 1 and "left" in each.name
            lens, distortion, image_format = read_lens(self, each, configured)
            yield ImagerConfig(
                intrinsics=lens,
                distortion=distortion,
                format=image_format,
                calibration=CalibrationConfig(
                    focal_length=config.focal_length,
                    centre=(config.cx, config.cy),
                    baseline=0.0 if left else config.hack_baseline,
                    rectified=rectified,
                ),
                frame=config.frame or sensor.link,
                image_topic=topic_in(base, config.image_topic),
                info_topic=topic_in(base, config.info_topic),
                namespace=base,
                # Gazebo lists compressedDepth for every camera in ROS 1.
                adjustable=not self.is_ros2,
            )

    def _rectified(self) -> Rectified:
        config = self.config
        rotation = None
        if config.rectification:
            element = self.tag.element.find("rectification_matrix") or self.tag.element
            rotation = vector(replace(element, text=config.rectification), _NINE)
        return Rectified(
            rotation=rotation,
            fx=config.p_fx,
            fy=config.p_fy,
            cx=config.p_cx,
            cy=config.p_cy,
            tx=config.p_tx,
            ty=config.p_ty,
        )

    def _trigger_topics(self) -> tuple[str, ...]:
        config = self.config
        if not (self.always_triggered or config.triggered):
            return ()
        # In ROS 2 all lenses share one trigger.
        bases = [self._base()] if self.is_ros2 else [base for _, base in self._lenses()]
        return tuple(topic_in(base, config.trigger_topic) for base in bases)


@dataclass(frozen=True, kw_only=True, slots=True)
class DepthByTypeParameters(CameraParameters):
    min_depth: float = tag(
        "min_depth",
        default=0.4,
        unit="m",
        doc="For sensors of type `depth`: depths at or below this value are published as -inf.",
    )
    max_depth: float = tag(
        "max_depth",
        default=math.inf,
        unit="m",
        doc="For sensors of type `depth`: depths at or above this value are published as inf.",
    )


class Camera(RosCamera[DepthByTypeParameters]):
    """Publishes the images of a camera sensor, and its calibration as CameraInfo messages.

    The camera looks along the x axis of the sensor. Images are rendered only while one of the
    topics has subscribers. The topics are in the namespace ``<cameraName>``. Each camera of a
    ``multicamera`` sensor has separate topics, such as ``<cameraName>/left/image_raw``. For a
    ``depth`` sensor, the plugin also publishes depth images and point clouds.

    The messages on ``image_raw/compressed`` are JPEG or PNG images. The service ``set_camera_info``
    replaces the published CameraInfo but does not change the image. With a ``<plugin>`` for ROS 1,
    dynamic_reconfigure can change ``imager_rate`` and the compression parameters. The ``<plugin>``
    is treated as written for ROS 2 if it contains ``<ros>``, or if all its tags are lower case and
    one contains ``_``, and otherwise as written for ROS 1.

    Images are distorted with the coefficients in the sensor's ``<distortion>``. Without this tag,
    they are distorted with the coefficients in the plugin's tags. The CameraInfo messages contain
    the same coefficients.

    Original plugin: ``gazebo_ros_camera`` (with ``gazebo_ros_camera_utils``) in the package
    ``gazebo_plugins``, for ROS 1 and ROS 2.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_camera.so",
        "libgazebo_ros_multicamera.so",
    )

    def _depth(self) -> DepthConfig | None:
        if self.sensor.type not in ("depth", "depth_camera", "rgbd_camera"):
            return None
        base, config = self._base(), self.config
        return DepthConfig(
            depth_topic=topic_in(base, "depth/image_raw"),
            info_topic=topic_in(base, "depth/camera_info"),
            points_topic=topic_in(base, "points"),
            nearest=config.min_depth,
            furthest=config.max_depth,
            beyond="inf",
            compressed=True,
        )


class TriggeredCamera(Camera):
    """Publishes one camera image for each message on ``<cameraName>/image_trigger``.

    The tags and topics are the same as those of ``libgazebo_ros_camera.so``. Original plugins:
    ``gazebo_ros_triggered_camera`` and ``gazebo_ros_triggered_multicamera`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_triggered_camera.so",
        "libgazebo_ros_triggered_multicamera.so",
    )
    always_triggered: ClassVar[bool] = True


@dataclass(frozen=True, kw_only=True, slots=True)
class ProsilicaParameters(CameraParameters):
    poll_service: str = tag(
        "pollServiceName",
        default="request_image",
        doc="No effect: the camera always publishes continuously.",
    )


class Prosilica(RosCamera[ProsilicaParameters]):
    """Publishes the images of a Prosilica camera continuously (in streaming mode).

    The topics are the same as those of ``libgazebo_ros_camera.so``. If the parameter
    ``trigger_mode`` is ``polled``, Cartwheel reports a warning, and the camera still publishes
    continuously. Original plugin: ``gazebo_ros_prosilica`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_prosilica.so",)

    def configure(self) -> None:
        super().configure()
        scope = f"{self.namespace}/{self._base()}"
        if self.graph.parameters.search("trigger_mode", scope) == "polled":
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                'the parameter trigger_mode "polled" has no effect because the camera publishes '
                "continuously",
                values={"parameter": "trigger_mode"},
            )
