"""Transforms and joint states of a drive's wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import JointHandle

if TYPE_CHECKING:
    from cartwheel.component import Component

_NOTHING = np.zeros(0)


class WheelTransforms:
    """Current transforms from joints' parent links to their child links.

    Args:
        owner: Provides the frame prefix.
        joints: The joints, in the order of the transforms.
    """

    def __init__(self, owner: Component, joints: Sequence[JointHandle]) -> None:
        described = {joint.name: joint for joint in owner.part.description.joints}
        self._wheels = [
            (
                handle,
                owner.frame(described[handle.name].parent),
                owner.frame(described[handle.name].child),
            )
            for handle in joints
        ]
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")

    def at(self, time_ns: int) -> list[Any]:
        """Returns the current ``TransformStamped`` messages."""
        Vector3, Quaternion, Transform = self._Vector3, self._Quaternion, self._Transform
        TransformStamped = self._TransformStamped
        sent, of, head = [], None, None
        for joint, parent, child in self._wheels:
            if parent != of:
                # robot_state_publisher publishes transforms of the same wheels with the stamp of
                # our joint states. Ours is a nanosecond later, so that tf does not warn about
                # repeated data.
                of, head = parent, header(time_ns + 1, parent)
            where, turned = joint.child_place()
            moved = Transform(Vector3(*where), Quaternion(*turned))
            sent.append(TransformStamped(head, child, moved))
        return sent


class JointStates:
    """Publishes ``sensor_msgs/JointState`` messages.

    Args:
        owner: Provides namespace and frame prefix.
        joints: The joints, in the order of the message.
        topic: The topic.
        rate: Publish rate for listings, Hz.
        velocities: Include velocities.
        efforts: Include efforts.
        frame: Frame of the messages.
    """

    def __init__(
        self,
        owner: Component,
        joints: Sequence[JointHandle],
        *,
        topic: str = "joint_states",
        rate: float | None,
        velocities: bool = False,
        efforts: bool = False,
        frame: str = "",
    ) -> None:
        self._joints = owner.part.together(joints)
        self._names = [joint.name for joint in joints]
        self._velocities, self._efforts = velocities, efforts
        self._frame = owner.frame(frame) if frame else ""
        self._JointState = message_class("sensor_msgs/msg/JointState")
        self._publisher = owner.advertise(topic, "sensor_msgs/msg/JointState", rate=rate)

    def wanted(self) -> bool:
        """Whether the topic has subscribers."""
        return self._publisher.wanted

    def publish(self, time_ns: int) -> None:
        """Publishes the current state."""
        joints, JointState = self._joints, self._JointState
        velocities = joints.velocities() if self._velocities else _NOTHING
        efforts = joints.efforts() if self._efforts else _NOTHING
        self._publisher.publish(
            JointState(
                header(time_ns, self._frame), self._names, joints.positions(), velocities, efforts
            )
        )
