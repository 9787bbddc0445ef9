"""Odometry: the message and the transform from the odometry frame to the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry_frame import OdometryFrame
from cartwheel.devices.joints.transforms import JointTransforms
from cartwheel.devices.transforms import TF_MESSAGE, transform_stamped
from cartwheel.geometry import Array, Pose, Quat, Vec3
from cartwheel.messages import Form, header, zero
from cartwheel.simulation.handles import LinkHandle

NO_COVARIANCE = np.zeros(36)
UNKNOWN = 1e12
"""Variance of the degrees of freedom that planar odometry does not estimate."""


def planar_covariance(x: float, y: float, yaw: float) -> Array:
    """Returns the covariance of a planar pose (m², rad²) or twist (m²/s², rad²/s²), shape (36,)."""
    return np.diag([x, y, UNKNOWN, UNKNOWN, UNKNOWN, yaw]).ravel()


@dataclass(frozen=True, kw_only=True, slots=True)
class OdometryConfig:
    """Topics, frames and covariances of an odometry."""

    topic: str | None
    """Topic of the odometry; None: not published."""
    frame: str
    """Reference frame of the pose."""
    base: str
    """Frame whose pose and twist are published."""
    rate: float = 0.0
    """Publish rate, Hz; 0: every step."""
    transform: bool = True
    """Publish the transform from the odometry frame to the robot."""
    tf_topic: str = "/tf"
    """Topic of the transforms."""
    joints: tuple[str, ...] = ()
    """Joints whose transforms are published with the transform of the robot."""
    pose_covariance: Array = field(default_factory=lambda: NO_COVARIANCE)
    """Shape (36,)."""
    twist_covariance: Array = field(default_factory=lambda: NO_COVARIANCE)
    """Shape (36,)."""


def base_of(component: Component, config: OdometryConfig) -> LinkHandle:
    """The link that is the base, or the root link: a base frame need not be a link."""
    known = component.part.description.link(config.base) is not None
    return component.link_or_root(config.base if known else "")


class Odometry(Component):
    """Publishes ``nav_msgs/Odometry`` and the transform from the odometry frame to the robot."""

    def __init__(self, scope: Scope, config: OdometryConfig) -> None:
        super().__init__(scope)
        self._frame, self._base = self.frame(config.frame), self.frame(config.base)
        self._joints = JointTransforms(self, config.joints) if config.joints else None
        self.pose_covariance = config.pose_covariance
        self.twist_covariance = config.twist_covariance
        rate = config.rate or None
        self._odometry = (
            self.advertise(config.topic, "nav_msgs/msg/Odometry", rate=rate)
            if config.topic
            else None
        )
        self._tf = (
            self.advertise(config.tf_topic, "tf2_msgs/msg/TFMessage", rate=rate)
            if config.transform or config.joints
            else None
        )
        if self._tf is not None:
            self.part.transformed.add(self._tf.topic)
        self._child = self.keep(OdometryFrame(self, config.base)) if config.transform else None
        self._form = self._odometry_form()
        self._tf_form = self._transforms_form()

    def _odometry_form(self) -> Form:
        return Form(
            self._odometry_template,
            "header.stamp",
            "pose.pose.position",
            "pose.pose.orientation",
            "pose.covariance",
            "twist.twist.linear",
            "twist.twist.angular",
            "twist.covariance",
        )

    def _odometry_template(self) -> Any:
        template = zero("nav_msgs/msg/Odometry")
        template.header.frame_id, template.child_frame_id = self._frame, self._base
        return template

    def _transforms_form(self) -> Form:
        fields: list[str | tuple[str, ...]] = []
        if self._child is not None:
            fields += ("header.stamp", "transform.translation", "transform.rotation")
            fields = [f"transforms.0.{field}" for field in fields]
        if self._joints is not None:
            fields += self._joints.fields(0 if self._child is None else 1)
        return Form(self._transforms_template, *fields)

    def _transforms_template(self) -> Any:
        template = zero(TF_MESSAGE)
        if self._child is not None:
            still, moment = Pose(), header(0, self._frame)
            template.transforms.append(
                transform_stamped(moment, self._child.name, still.position, still.orientation)
            )
        if self._joints is not None:
            template.transforms += self._joints.messages()
        return template

    def wanted(self) -> bool:
        """Whether one of the topics has subscribers."""
        if self._odometry is not None and self._odometry.wanted:
            return True
        return self._tf is not None and self._tf.wanted

    def publish(
        self,
        time_ns: int,
        place: Vec3,
        turn: Quat,
        linear: Sequence[float],
        angular: Sequence[float],
    ) -> None:
        """Publishes on the topics that have subscribers.

        Args:
            time_ns: Time of the state.
            place: Position of the base in the odometry frame, m.
            turn: Orientation of the base in the odometry frame.
            linear: Velocity, usually in the base frame, m/s, shape (3,).
            angular: Angular velocity, usually in the base frame, rad/s, shape (3,).
        """
        # The hottest path of all messages.
        tf, odometry = self._tf, self._odometry
        if tf is not None and tf.wanted:
            child, joints = self._child, self._joints
            values: list[Any] = []
            if child is not None:
                moved = (place, turn) if child.coincides else child.place(place, turn)
                values = [time_ns, *moved]
            if joints is not None:
                joints.add(values, time_ns)
            tf.publish_values(self._tf_form, tuple(values))
        if odometry is not None and odometry.wanted:
            odometry.publish_values(
                self._form,
                (
                    time_ns,
                    place,
                    turn,
                    self.pose_covariance,
                    linear,
                    angular,
                    self.twist_covariance,
                ),
            )
