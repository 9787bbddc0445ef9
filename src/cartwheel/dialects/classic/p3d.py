"""``libgazebo_ros_p3d.so`` and ``gz-sim-odometry-publisher-system``: the true pose."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import (
    Pose,
    quat_conjugate,
    quat_from_rpy,
    quat_multiply,
    quat_normalize,
    rotate,
    yaw_of,
)
from cartwheel.messages import header, message_class

_WORLD = {"world", "/world", "map", "/map"}


@dataclass(frozen=True, kw_only=True, slots=True)
class P3DParameters:
    body: str = tag("bodyName", "body_name", doc="Link whose pose is published.")
    topic: str = tag("topicName", "topic_name", default="odom", doc="Topic of the odometry.")
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        doc="Reference frame of pose and twist: a link, `world` or `map`.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        "xyz_offset",
        "xyz_offsets",
        default=(0.0, 0.0, 0.0),
        unit="m",
        doc="Position offset, expressed in the reference frame.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset",
        "rpyOffsets",
        "rpy_offset",
        "rpy_offsets",
        default=(0.0, 0.0, 0.0),
        unit="rad",
        doc="Rotation applied to the orientation, about the axes of the reference frame.",
    )
    noise: float = tag(
        "gaussianNoise",
        "gaussian_noise",
        default=0.0,
        unit="m/s and rad/s",
        doc="Standard deviation of the noise on the twist.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate. 0: every step.",
    )


class P3D(Plugin[P3DParameters]):
    """Publishes the ground-truth pose and twist of a link as Odometry.

    As in Gazebo, the twist is expressed in the reference frame instead of the link frame. If the
    reference frame is a link, Gazebo rotates the twist the wrong way; Cartwheel does not. Original
    plugin: ``gazebo_ros_p3d`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_p3d.so",)
    parameters: ClassVar[type] = P3DParameters
    in_link: ClassVar[bool] = False
    """Whether the twist is in the link frame instead of the reference frame."""
    in_world: ClassVar[bool] = False
    """Whether the frame only sets the frame ID, because the pose is relative to the world."""

    def configure(self) -> None:
        config, part = self.config, self.part
        self.check_not_negative("update_rate", "noise")
        body = config.body or config.frame
        self._link = part.link(body, origin=self.tag.origin)
        self._reference = None
        if config.frame not in _WORLD and not self.in_world:
            if part.description.link(config.frame) is not None:
                self._reference = part.link(config.frame)
            else:
                self.warn(
                    devices.FRAME_UNKNOWN,
                    f'<frameName> "{config.frame}" is not a link, so the pose in the world '
                    "is published with this frame ID (Gazebo publishes nothing)",
                    values={"frame": config.frame},
                )
        self._turn = quat_from_rpy(*config.rpy_offset)
        self._frame, self._child = self.frame(config.frame), self.frame(body)
        self._covariance = np.diag([config.noise**2] * 6).ravel()
        self._Odometry = message_class("nav_msgs/msg/Odometry")
        self._PoseWithCovariance = message_class("geometry_msgs/msg/PoseWithCovariance")
        self._TwistWithCovariance = message_class("geometry_msgs/msg/TwistWithCovariance")
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Twist = message_class("geometry_msgs/msg/Twist")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        rate = config.update_rate
        self._publisher = self.advertise(config.topic, "nav_msgs/msg/Odometry", rate=rate or None)
        part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        config = self.config
        place, turn = self._link.place()
        linear, angular = (np.array(v) for v in self._link.motion(local=False))
        if self._reference is not None:
            origin, turned = self._reference.place()
            moved, spun = self._reference.motion(local=False)
            pose = Pose(origin, turned).inverse() @ Pose(place, turn)
            place, turn = pose.position, pose.orientation
            back = quat_conjugate(turned)
            linear = np.array(rotate(back, (linear - np.array(moved)).tolist()))
            angular = np.array(rotate(back, (angular - np.array(spun)).tolist()))
        if self.in_link:
            linear, angular = (np.array(v) for v in self._link.motion(local=True))
        if any(config.xyz_offset):
            x, y, z = (a + b for a, b in zip(place, config.xyz_offset, strict=True))
            place = (x, y, z)
        if any(config.rpy_offset):
            turn = quat_normalize(quat_multiply(self._turn, turn))
        if config.noise > 0:
            drawn = self.part.random(f"p3d {self._publisher.topic}").normal(0.0, config.noise, 6)
            linear, angular = linear + drawn[:3], angular + drawn[3:]
        Vector3 = self._Vector3
        twist = self._Twist(Vector3(*linear.tolist()), Vector3(*angular.tolist()))
        pose_message = self._Pose(self._Point(*place), self._Quaternion(*turn))
        self._publisher.publish(
            self._Odometry(
                header(self.part.time_ns, self._frame),
                self._child,
                self._PoseWithCovariance(pose_message, self._covariance),
                self._TwistWithCovariance(twist, self._covariance),
            )
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class WorldOdometryParameters(P3DParameters):
    body: str = tag(
        "bodyName",
        "body_name",
        default="",
        doc="Link whose pose is published. Default: the link in `<frameName>`.",
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        doc="Frame ID of the messages. The pose is always relative to the world.",
    )


class WorldOdometry(P3D):
    """Publishes a link's ground-truth pose in the world, with the twist in the link frame.

    Tags and topics are otherwise the same as for ``libgazebo_ros_p3d.so``. Original plugin:
    ``gazebo_world_odometry`` in the package ``pal_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_world_odometry.so",)
    parameters: ClassVar[type] = WorldOdometryParameters
    in_world: ClassVar[bool] = True
    in_link: ClassVar[bool] = True


@dataclass(frozen=True, kw_only=True, slots=True)
class OdometryPublisherParameters:
    frame: str = tag(
        "odom_frame", default="", doc="Reference frame of the pose. Default: `<model>/odom`."
    )
    base_frame: str = tag(
        "robot_base_frame",
        default="",
        doc="Child frame of the odometry. Default: `<model>/base_footprint`.",
    )
    rate: float = tag(
        "odom_publish_frequency", default=50.0, unit="Hz", doc="Publish rate of all topics."
    )
    topic: str = tag(
        "odom_topic",
        default="",
        doc="Topic of the odometry. Default: `/model/<model>/odometry`.",
    )
    covariance_topic: str = tag(
        "odom_covariance_topic",
        default="",
        doc="Topic of the odometry with covariance. "
        "Default: `/model/<model>/odometry_with_covariance`.",
    )
    tf_topic: str = tag(
        "tf_topic",
        default="",
        doc="Topic of the TFMessage. Default: `/model/<model>/pose`.",
    )
    dimensions: Literal["2", "3"] = tag(
        "dimensions",
        default="2",
        doc="`2`: pose and twist are planar (x, y, yaw). `3`: they are three-dimensional.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyz_offset",
        default=(0.0, 0.0, 0.0),
        unit="m",
        doc="Position of the base frame in the model frame.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpy_offset",
        default=(0.0, 0.0, 0.0),
        unit="rad",
        doc="Roll, pitch and yaw of the base frame in the model frame.",
    )
    noise: float = tag(
        "gaussian_noise",
        default=0.0,
        unit="m/s and rad/s",
        doc="Standard deviation of the noise on the twist.",
    )


class OdometryPublisher(Plugin[OdometryPublisherParameters]):
    """Publishes the model's ground-truth pose in the world, with the twist in the model frame.

    Original plugin: ``OdometryPublisher`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-odometry-publisher-system",)
    parameters: ClassVar[type] = OdometryPublisherParameters

    def configure(self) -> None:
        config, part = self.config, self.part
        self.check_not_negative("rate", "noise")
        self._link = part.link(part.description.canonical_link)
        to_link = part.description.canonical_pose.inverse()
        offset = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        self._offset = to_link @ offset
        frame = config.frame or f"{part.name}/odom"
        base = config.base_frame or f"{part.name}/base_footprint"
        covariance = np.diag([config.noise**2] * 6).ravel()
        self._outputs = (
            self.add(
                Odometry(
                    self.scope,
                    OdometryConfig(
                        topic=gz_name(self, config.topic, "odometry"),
                        frame=frame,
                        base=base,
                        rate=config.rate,
                        transform=True,
                        tf_topic=gz_name(self, config.tf_topic, "pose"),
                    ),
                )
            ),
            self.add(
                Odometry(
                    self.scope,
                    OdometryConfig(
                        topic=gz_name(self, config.covariance_topic, "odometry_with_covariance"),
                        frame=frame,
                        base=base,
                        rate=config.rate,
                        transform=False,
                        pose_covariance=covariance,
                        twist_covariance=covariance,
                    ),
                )
            ),
        )
        part.schedule(config.rate, after=self._publish, active=self._wanted)

    def _wanted(self) -> bool:
        return any(odometry.wanted() for odometry in self._outputs)

    def _publish(self) -> None:
        pose = self._link.pose @ self._offset
        moved, spun = self._link.motion(local=False)
        arm = rotate(self._link.pose.orientation, self._offset.position)
        linear = np.array(moved) + np.cross(spun, arm)
        place, turn = pose.position, pose.orientation
        if self.config.dimensions == "2":
            place = (place[0], place[1], 0.0)
            half = yaw_of(turn) / 2
            turn = (0.0, 0.0, math.sin(half), math.cos(half))
        back = quat_conjugate(turn)
        local = [*rotate(back, linear.tolist()), *rotate(back, spun)]
        if self.config.noise > 0:
            random = self.part.random(f"odometry {self.tag.name}")
            local = (np.array(local) + random.normal(0.0, self.config.noise, 6)).tolist()
        if self.config.dimensions == "2":
            local[2] = local[3] = local[4] = 0.0
        for odometry in self._outputs:
            if odometry.wanted():
                odometry.publish(
                    self.part.time_ns, place, turn, local[:3], (local[3], local[4], local[5])
                )
