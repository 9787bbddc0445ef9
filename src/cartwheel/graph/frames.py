"""Where frames are, as the transforms on ``/tf`` and ``/tf_static`` say."""

from __future__ import annotations

from typing import Any

from cartwheel.geometry import Pose
from cartwheel.graph.graph import Graph

_KIND = "tf2_msgs/msg/TFMessage"
_DEEPEST = 100
"""Transforms from a frame to the root; what is deeper goes round in a circle."""


class Frames:
    """Keeps the last transform to each frame; for the owner's thread.

    Args:
        graph: Whose transforms are heard.
        node: Who hears them, for listings.
    """

    def __init__(self, graph: Graph, node: str) -> None:
        self._parents: dict[str, tuple[str, Pose]] = {}
        self._heard = [
            graph.subscribe(topic, self._on_transforms, type_name=_KIND, node=node)
            for topic in ("/tf", "/tf_static")
        ]

    def close(self) -> None:
        """Hears no more."""
        for subscription in self._heard:
            subscription.close()

    def forget(self) -> None:
        """After a reset: nothing is known yet."""
        self._parents.clear()

    def pose(self, frame: str, reference: str) -> Pose | None:
        """A frame in another one that it hangs on; None where no transforms lead there."""
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
