"""``libgazebo_ros_depth_camera.so`` and ``libgazebo_ros_openni_kinect.so``: depth cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.cameras.depth_camera import DepthConfig
from cartwheel.devices.cameras.imager import topic_in
from cartwheel.dialects.classic.sensors.camera import CameraParameters, RosCamera
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class DepthCameraParameters(CameraParameters):
    image_topic: str = tag(
        "imageTopicName", default="ir/image_raw", doc="Topic of the colour images."
    )
    info_topic: str = tag(
        "cameraInfoTopicName",
        default="ir/camera_info",
        doc="Topic of the CameraInfo messages for the colour images.",
    )
    depth_topic: str = tag(
        "depthImageTopicName", default="depth/image_raw", doc="Topic of the depth images."
    )
    depth_info_topic: str = tag(
        "depthImageCameraInfoTopicName",
        default="depth/camera_info",
        doc="Topic of the CameraInfo messages for the depth images.",
    )
    points_topic: str = tag(
        "pointCloudTopicName", default="points", doc="Topic of the point clouds (PointCloud2)."
    )
    nearest: float = tag(
        "pointCloudCutoff",
        default=0.4,
        unit="m",
        doc="Depths at or below this value are published as NaN.",
    )
    furthest: float = tag(
        "pointCloudCutoffMax",
        default=math.inf,
        unit="m",
        doc="Depths at or above this value are published as NaN.",
    )
    millimetres: bool = tag(
        "useDepth16UC1Format",
        default=False,
        doc="Whether to publish depth images with the encoding 16UC1: integers in mm, with 0 "
        "instead of NaN.",
    )
    baseline: float = tag("baseline", default=0.0, unit="m", doc="No effect.")
    reflectance_topic: str = tag(
        "reflectanceTopicName", default="", doc="No effect, as in Gazebo 11."
    )
    normals_topic: str = tag("normalsTopicName", default="", doc="No effect, as in Gazebo 11.")
    reduce_normals: int = tag(
        "reduceNormals", default=50, doc="No effect: normals are not published."
    )


class DepthCamera(RosCamera[DepthCameraParameters]):
    """Publishes colour images, depth images and point clouds from a depth camera.

    Depths are measured along the optical axis. In the frame of the points, x points right, y down
    and z forward, so ``<frameName>`` should be an optical frame. The point cloud is organised: it
    contains one point for each pixel, with the pixel's colour in ``rgb``. Reflectance and normals
    are not published, as in Gazebo 11.

    Original plugin: ``gazebo_ros_depth_camera`` in the package ``gazebo_plugins``. See also REP 103
    and REP 118.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_depth_camera.so",)
    sensor_type: ClassVar[str] = "depth"

    def configure(self) -> None:
        super().configure()
        for name, written in (
            ("reflectanceTopicName", self.config.reflectance_topic),
            ("normalsTopicName", self.config.normals_topic),
        ):
            if written:
                self.warn_ignored(name, "Gazebo 11 does not publish it either")

    def _depth(self) -> DepthConfig:
        base, config = self._base(), self.config
        return DepthConfig(
            depth_topic=topic_in(base, config.depth_topic),
            info_topic=topic_in(base, config.depth_info_topic),
            points_topic=topic_in(base, config.points_topic),
            nearest=config.nearest,
            furthest=config.furthest,
            millimetres=config.millimetres,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class KinectParameters(DepthCameraParameters):
    furthest: float = tag(
        "pointCloudCutoffMax",
        default=5.0,
        unit="m",
        doc="Depths at or above this value are published as NaN.",
    )


class OpenniKinect(DepthCamera):
    """Publishes colour images, depth images and point clouds of a Kinect, by default up to 5 m.

    The tags and topics are the same as those of ``libgazebo_ros_depth_camera.so``. Original plugin:
    ``gazebo_ros_openni_kinect`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_openni_kinect.so",)
    parameters: ClassVar[type] = KinectParameters
