"""``libgazebo_ros_depth_camera.so`` and ``libgazebo_ros_openni_kinect.so``: colours and depths."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.plugins.camera import CameraParameters, RosCamera
from cartwheel.plugins.camera_depth import DepthOptions
from cartwheel.plugins.camera_eye import joined
from cartwheel.plugins.parameters import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class DepthCameraParameters(CameraParameters):
    image_topic: str = tag("imageTopicName", default="ir/image_raw", doc="Image of colours.")
    info_topic: str = tag(
        "cameraInfoTopicName", default="ir/camera_info", doc="CameraInfo of the image."
    )
    depth_topic: str = tag("depthImageTopicName", default="depth/image_raw", doc="Image of depths.")
    depth_info_topic: str = tag(
        "depthImageCameraInfoTopicName", default="depth/camera_info", doc="CameraInfo of depths."
    )
    points_topic: str = tag("pointCloudTopicName", default="points", doc="PointCloud2.")
    nearest: float = tag(
        "pointCloudCutoff", default=0.4, unit="m", doc="Depths up to this are nan."
    )
    furthest: float = tag(
        "pointCloudCutoffMax", default=math.inf, unit="m", doc="Depths from this on are nan."
    )
    millimetres: bool = tag(
        "useDepth16UC1Format", default=False, doc="Depths as 16UC1 in mm, 0 for nan."
    )
    baseline: float = tag("baseline", default=0.0, unit="m", doc="Accepted.")
    reflectance_topic: str = tag("reflectanceTopicName", default="", doc="Not published.")
    normals_topic: str = tag("normalsTopicName", default="", doc="Not published.")
    reduce_normals: int = tag("reduceNormals", default=50, doc="Of the normals.")


class DepthCamera(RosCamera[DepthCameraParameters]):
    """A camera that knows how far ahead each pixel is.

    Depths are along the optical axis. Points have x right, y down and z ahead, in the frame that
    ``<frameName>`` says: name an optical frame there. They are organised, one for each pixel, with
    its colour in ``rgb``. Neither reflectance nor normals, as in Gazebo 11.

    Source: gazebo_plugins, gazebo_ros_depth_camera; REP 103 and 118.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_depth_camera.so",)
    sensor_type: ClassVar[str] = "depth"
    parameters: ClassVar[type] = DepthCameraParameters

    def configure(self) -> None:
        super().configure()
        for name, written in (
            ("reflectanceTopicName", self.config.reflectance_topic),
            ("normalsTopicName", self.config.normals_topic),
        ):
            if written:
                self.warn(
                    devices.PLUGIN_PARAMETER_IGNORED,
                    f"<{name}> has no effect: Gazebo 11 does not publish it either",
                    values={"parameter": name},
                )

    def _depth_options(self) -> DepthOptions:
        base, config = self._base(), self.config
        return DepthOptions(
            depth=joined(base, config.depth_topic),
            info=joined(base, config.depth_info_topic),
            points=joined(base, config.points_topic),
            nearest=config.nearest,
            furthest=config.furthest,
            millimetres=config.millimetres,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class KinectParameters(DepthCameraParameters):
    furthest: float = tag(
        "pointCloudCutoffMax", default=5.0, unit="m", doc="Depths from this on are nan."
    )


class OpenniKinect(DepthCamera):
    """A depth camera that sees no further than 5 m where nothing else is said.

    Source: gazebo_plugins, gazebo_ros_openni_kinect.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_openni_kinect.so",)
    sensor_type: ClassVar[str] = "depth"
    parameters: ClassVar[type] = KinectParameters
