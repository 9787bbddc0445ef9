"""The child frame of ``odom``, chosen so that a robot's transforms form a single tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cartwheel.description.kinematics import fixed_chain, link_poses
from cartwheel.devices.transforms import transform_stamped
from cartwheel.geometry import IDENTITY, Pose, Quat, Vec3, quat_multiply, rotate
from cartwheel.messages import header

if TYPE_CHECKING:
    from cartwheel.component import Component


class OdometryFrame:
    """Child frame of a drive's transform, and its pose in ``odom``.

    A drive publishes the pose of its base link, and robot_state_publisher publishes the pose of
    each link relative to its parent. A base link that is fixed to the root link would therefore
    have two parents, and tf would ignore one of them. In this case the drive publishes the
    transform of the root link, which is equivalent, and the fixed transforms between the two links
    on ``/tf_static``.

    Args:
        owner: The drive.
        base: The base link, or any other frame name.
    """

    def __init__(self, owner: Component, base: str) -> None:
        description = owner.part.description
        chain = [joint for joint in fixed_chain(description, base) if joint.parent != "world"]
        self._graph = owner.graph
        self._sent: list[Any] = []
        self.name = owner.frame(base)
        """``child_frame_id`` of the transform."""
        self.coincides = True
        """Whether `place` returns the pose of the base link unchanged."""
        self._to_root = Pose()
        self._turned = False
        if not chain:
            return
        self.name = owner.frame(chain[0].parent)
        poses = link_poses(description, {})
        to_root = poses[base].inverse() @ poses[chain[0].parent]
        # If both frames coincide, the pose is passed on bit for bit.
        self.coincides, self._to_root = to_root == Pose(), to_root
        self._turned = to_root.orientation != IDENTITY
        for joint in chain:
            between = poses[joint.parent].inverse() @ poses[joint.child]
            moment, child = header(0, owner.frame(joint.parent)), owner.frame(joint.child)
            self._sent.append(
                transform_stamped(moment, child, between.position, between.orientation)
            )
        self._graph.static_transforms.put(self, self._sent)

    def place(self, position: Vec3, orientation: Quat) -> tuple[Vec3, Quat]:
        """Returns the pose of `child` for a pose of the base link.

        An unchanged orientation is returned as the same object.
        """
        if self.coincides:
            return position, orientation
        # The product of two poses, without creating objects: this runs for each message.
        x, y, z = position
        dx, dy, dz = rotate(orientation, self._to_root.position)
        if self._turned:
            orientation = quat_multiply(orientation, self._to_root.orientation)
        return (x + dx, y + dy, z + dz), orientation

    def close(self) -> None:
        """Removes the static transforms."""
        if self._sent:
            self._graph.static_transforms.remove(self)
