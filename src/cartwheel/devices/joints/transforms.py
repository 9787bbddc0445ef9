"""Transforms of joints, such as those of a drive's wheels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from cartwheel.devices.transforms import transform_stamped
from cartwheel.geometry import Pose
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

    def messages(self) -> list[Any]:
        """``TransformStamped`` messages of all joints, with their frames only."""
        still = Pose()
        return [
            transform_stamped(header(0, parent), child, still.position, still.orientation)
            for _, parent, child in self._joints
        ]

    def fields(self, first: int) -> Iterator[str | tuple[str, ...]]:
        """The fields of a ``TFMessage`` that `values` sets, for `Form`.

        Args:
            first: Index of the first of the messages.
        """
        paths = [f"transforms.{first + index}" for index in range(len(self._joints))]
        yield tuple(f"{path}.header.stamp" for path in paths)
        for path in paths:
            yield f"{path}.transform.translation"
            yield f"{path}.transform.rotation"

    def add(self, values: list[Any], time_ns: int) -> None:
        """Appends the current values of `fields`."""
        # robot_state_publisher publishes transforms of the same joints with the stamp of our joint
        # states. Ours is a nanosecond later, so that tf does not warn about repeated data.
        values.append(time_ns + 1)
        for joint, _, _ in self._joints:
            values += joint.child_place()
