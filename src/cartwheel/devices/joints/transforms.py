"""Transforms of joints, such as those of a drive's wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cartwheel.messages import header, message_class

if TYPE_CHECKING:
    from cartwheel.component import Component


class JointTransforms:
    """Current transforms from joints' parent links to their child links.

    Args:
        owner: Provides the robot and the frame prefix.
        joints: Names of the joints, in the order of the transforms.
    """

    def __init__(self, owner: Component, joints: Sequence[str]) -> None:
        described = {joint.name: joint for joint in owner.part.description.joints}
        self._joints = [
            (
                owner.part.joint(name, origin=owner.origin),
                owner.frame(described[name].parent),
                owner.frame(described[name].child),
            )
            for name in joints
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
        for joint, parent, child in self._joints:
            if parent != of:
                # robot_state_publisher publishes transforms of the same joints with the stamp of
                # our joint states. Ours is a nanosecond later, so that tf does not warn about
                # repeated data.
                of, head = parent, header(time_ns + 1, parent)
            where, turned = joint.child_place()
            moved = Transform(Vector3(*where), Quaternion(*turned))
            sent.append(TransformStamped(head, child, moved))
        return sent
