"""What a drive tells of its wheels: transforms and joint states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import JointHandle

if TYPE_CHECKING:
    from cartwheel.plugins.base import Plugin

_NOTHING = np.zeros(0)


class WheelTransforms:
    """Transforms of joints' child links in their parents, where the joints are turned to.

    Args:
        plugin: Whose frames count.
        joints: In the order of the transforms.
    """

    def __init__(self, plugin: Plugin[Any], joints: Sequence[JointHandle]) -> None:
        made = {joint.name: joint for joint in plugin.part.description.joints}
        self._wheels = [
            (handle, plugin.frame(made[handle.name].parent), plugin.frame(made[handle.name].child))
            for handle in joints
        ]
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")

    def at(self, time_ns: int) -> list[Any]:
        """``TransformStamped`` of the present state."""
        Vector3, Quaternion, Transform = self._Vector3, self._Quaternion, self._Transform
        TransformStamped = self._TransformStamped
        sent, of, head = [], None, None
        for joint, parent, child in self._wheels:
            if parent != of:
                # robot_state_publisher makes transforms of the same wheels, stamped as our
                # joint states: a nanosecond apart, neither is repeated data to tf.
                of, head = parent, header(time_ns + 1, parent)
            where, turned = joint.child_place()
            moved = Transform(Vector3(*where), Quaternion(*turned))
            sent.append(TransformStamped(head, child, moved))
        return sent


class JointStates:
    """Publishes ``sensor_msgs/JointState`` of joints.

    Args:
        plugin: Whose namespace counts.
        joints: In the order of the message.
        topic: Where.
        rate: Hz, for listings.
        velocities: Whether they are told.
        efforts: Whether they are told.
        frame: Of the messages.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        joints: Sequence[JointHandle],
        *,
        topic: str = "joint_states",
        rate: float | None,
        velocities: bool = False,
        efforts: bool = False,
        frame: str = "",
    ) -> None:
        self._joints = plugin.part.together(joints)
        self._names = [joint.name for joint in joints]
        self._velocities, self._efforts = velocities, efforts
        self._frame = plugin.frame(frame) if frame else ""
        self._JointState = message_class("sensor_msgs/msg/JointState")
        self._publisher = plugin.advertise(topic, "sensor_msgs/msg/JointState", rate=rate)

    def wanted(self) -> bool:
        """Whether anybody reads it."""
        return self._publisher.wanted

    def publish(self, time_ns: int) -> None:
        """Publishes the present state."""
        joints, JointState = self._joints, self._JointState
        velocities = joints.velocities() if self._velocities else _NOTHING
        efforts = joints.efforts() if self._efforts else _NOTHING
        self._publisher.publish(
            JointState(
                header(time_ns, self._frame), self._names, joints.positions(), velocities, efforts
            )
        )
