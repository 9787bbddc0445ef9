"""The frame below ``odom``, so that all transforms of a robot stay one tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cartwheel.description.kinematics import fixed_chain, link_poses
from cartwheel.geometry import IDENTITY, Pose, Quat, Vec3, quat_multiply, rotate
from cartwheel.graph import StaticTransforms
from cartwheel.messages import header, message_class

if TYPE_CHECKING:
    from cartwheel.plugins.base import Plugin


class OdometryFrame:
    """Which frame a drive moves in ``odom``, and where it is.

    A drive tells where its base link is. robot_state_publisher tells where each link is in
    its parent; so a base link that is fixed below the root would have two parents, and tf
    would lose one of them. The transform told is that of the root then, to the same effect,
    and the fixed ones between the two go to ``/tf_static``.

    Args:
        plugin: Of the drive.
        base: The base link, or any other name of a frame.
    """

    def __init__(self, plugin: Plugin[Any], base: str) -> None:
        description = plugin.part.description
        chain = [joint for joint in fixed_chain(description, base) if joint.parent != "world"]
        self._graph = plugin.graph
        self._sent: list[Any] = []
        self.child = plugin.frame(base)
        """``child_frame_id`` of the transform."""
        self._to_root: Pose | None = None
        self._turned = False
        if not chain:
            return
        self.child = plugin.frame(chain[0].parent)
        poses = link_poses(description, {})
        to_root = poses[base].inverse() @ poses[chain[0].parent]
        # Bits are kept where the two coincide.
        self._to_root = None if to_root == Pose() else to_root
        self._turned = to_root.orientation != IDENTITY
        for joint in chain:
            between = poses[joint.parent].inverse() @ poses[joint.child]
            self._sent.append(
                message_class("geometry_msgs/msg/TransformStamped")(
                    header=header(0, plugin.frame(joint.parent)),
                    child_frame_id=plugin.frame(joint.child),
                    transform=message_class("geometry_msgs/msg/Transform")(
                        translation=message_class("geometry_msgs/msg/Vector3")(*between.position),
                        rotation=message_class("geometry_msgs/msg/Quaternion")(
                            *between.orientation
                        ),
                    ),
                )
            )
        StaticTransforms.of(self._graph).put(self, self._sent)

    def place(self, position: Vec3, orientation: Quat) -> tuple[Vec3, Quat]:
        """Where `child` is, given where the base link is.

        An orientation that is the same is the very same tuple.
        """
        if self._to_root is None:
            return position, orientation
        # As poses multiply, without making any: it is asked for each message.
        x, y, z = position
        dx, dy, dz = rotate(orientation, self._to_root.position)
        if self._turned:
            orientation = quat_multiply(orientation, self._to_root.orientation)
        return (x + dx, y + dy, z + dz), orientation

    def close(self) -> None:
        """The robot leaves the world."""
        if self._sent:
            StaticTransforms.of(self._graph).remove(self)
