"""Poses of frames, from the transforms on ``/tf`` and ``/tf_static``."""

from __future__ import annotations

from typing import Any

from cartwheel.geometry import Pose
from cartwheel.graph.graph import Graph

_KIND = "tf2_msgs/msg/TFMessage"
_DEEPEST = 100
"""Maximum number of transforms from a frame to the root. A deeper tree is treated as a cycle."""


class Frames:
    """Stores the last transform of each frame. Call it on the owner's thread.

    Args:
        graph: Graph on which the transforms are published.
        node: Subscriber's name, for listings.
    """

    def __init__(self, graph: Graph, node: str) -> None:
        self._parents: dict[str, tuple[str, Pose]] = {}
        self._heard = [
            graph.subscribe(topic, self._on_transforms, type_name=_KIND, node=node)
            for topic in ("/tf", "/tf_static")
        ]

    def close(self) -> None:
        """Unsubscribes."""
        for subscription in self._heard:
            subscription.close()

    def forget(self) -> None:
        """Deletes all transforms, after a reset."""
        self._parents.clear()

    def pose(self, frame: str, reference: str) -> Pose | None:
        """Pose of a frame relative to its ancestor `reference`, or None without a connection."""
        pose = Pose()
        for _ in range(_DEEPEST):
            if frame == reference:
                return pose
            if frame not in self._parents:
                return None
            frame, step = self._parents[frame]
            pose = step @ pose
        return None

    def _on_transforms(self, message: Any) -> None:
        for sent in message.transforms:
            place, turn = sent.transform.translation, sent.transform.rotation
            pose = Pose((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
            self._parents[sent.child_frame_id.lstrip("/")] = (
                sent.header.frame_id.lstrip("/"),
                pose,
            )
