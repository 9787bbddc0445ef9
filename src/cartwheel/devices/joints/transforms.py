"""Transforms of joints, such as those of a drive's wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cartwheel.devices.transforms import transform_classes
from cartwheel.messages import header

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
        self._classes = transform_classes()

    def at(self, time_ns: int) -> list[Any]:
        """Returns the current ``TransformStamped`` messages."""
        TransformStamped, Transform, Vector3, Quaternion = self._classes
        sent, of, head = [], None, None
        for joint, parent, child in self._joints:
            if parent != of:
                # robot_state_publisher publishes transforms of the same joints with the stamp of
                # our joint states. Ours is a nanosecond later, so that tf does not warn about
                # repeated data.
                of, head = parent, header(time_ns + 1, parent)
            place, turn = joint.child_place()
            # This is `transform_stamped` inlined: it runs for each wheel at the rate of odometry.
            moved = Transform(Vector3(*place), Quaternion(*turn))
            sent.append(TransformStamped(head, child, moved))
        return sent
