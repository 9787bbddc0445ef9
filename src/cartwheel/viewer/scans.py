"""Laser scans and point clouds, drawn where they were measured."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from cartwheel.codes.recording import SCAN_NOT_SHOWN
from cartwheel.geometry import Array, from_wxyz, matrix_from_quat
from cartwheel.graph import TopicInfo
from cartwheel.messages import nanoseconds
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.tap import Tap

SCAN = "sensor_msgs/msg/LaserScan"
CLOUD = "sensor_msgs/msg/PointCloud2"
MOST_POINTS = 20_000
"""Maximum points in a cloud; larger clouds are thinned."""
_RATE = 10.0
"""Update rate, Hz of wall time."""
_SNAPSHOTS = 20
_COLORS = ((224, 49, 49), (25, 113, 194), (47, 158, 68), (156, 54, 181))
_FLOAT32 = 7


class Scans(Panel):
    """Points in the scene for each enabled topic; it has no visible panel.

    A scan is drawn in the world relative to its link's pose at the scan's timestamp, as in rviz, so
    that fixed objects stay in place while the robot turns.
    """

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._topics: dict[str, TopicInfo] = {}
        self._taps: dict[str, Tap] = {}
        self._counts: dict[str, int] = {}
        self._clouds: dict[str, Any] = {}
        self._recent: deque[Snapshot] = deque(maxlen=_SNAPSHOTS)
        self._reported: set[str] = set()
        self._due = Every(_RATE)

    def leave(self) -> None:
        for topic in list(self._taps):
            self._drop(topic)
        self._recent.clear()

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        self._topics = {
            topic.name: topic
            for topic in topics
            if topic.type in (SCAN, CLOUD) and topic.publishers
        }

    def update(self, snapshot: Snapshot, now: float) -> None:
        self._recent.append(snapshot)
        self._choose()
        if not self._taps or not self._due(now):
            return
        for topic, tap in self._taps.items():
            if tap.count != self._counts[topic]:
                self._counts[topic] = tap.count
                self._draw(topic, tap.newest)

    def _choose(self) -> None:
        """Subscribes to the enabled topics; sensors without subscribers are not measured."""
        wanted = set()
        for seat in self.stage.seats.values():
            on = {SCAN: seat.display.scans, CLOUD: seat.display.clouds}
            shown = {name for name, topic in self._topics.items() if on[topic.type]}
            seat.hide("scans", {_node(name) for name in set(self._topics) - shown})
            wanted |= shown
        for topic in set(self._taps) - wanted:
            self._drop(topic)
        for topic in wanted - set(self._taps):
            self._taps[topic] = Tap(self.graph, topic)
            self._counts[topic] = 0

    def _drop(self, topic: str) -> None:
        self._taps.pop(topic).close()
        cloud = self._clouds.pop(topic, None)
        if cloud is not None:
            cloud.remove()

    def _draw(self, topic: str, message: Any) -> None:
        time_ns = nanoseconds(message.header.stamp)
        publisher = self._topics[topic].publishers[0].partition("/")[0]
        with_it = [
            recent
            for recent in self._recent
            if any(model.name == publisher for model in recent.scene.models)
        ]
        if not with_it:
            return
        snapshot = min(with_it, key=lambda recent: abs(recent.time_ns - time_ns))
        row = row_of_frame(snapshot.scene.links, publisher, message.header.frame_id)
        if row is None:
            self._tell(topic, message.header.frame_id, publisher)
            return
        found = points_of_scan(message) if hasattr(message, "ranges") else points_of(message)
        turn = matrix_from_quat(from_wxyz(snapshot.quaternions[row].tolist()))
        points = (found @ turn.T + snapshot.positions[row]).astype(np.float32)
        cloud = self._clouds.get(topic)
        if cloud is None:
            color = _COLORS[len(self._clouds) % len(_COLORS)]
            self._clouds[topic] = self.page.scene.add_point_cloud(
                _node(topic),
                points,
                color,
                point_size=0.03,
                point_shape="circle",
                point_shading="flat",
                precision="float32",
            )
        else:
            cloud.points = points

    def _tell(self, topic: str, frame: str, model: str) -> None:
        if topic not in self._reported:
            self._reported.add(topic)
            self.page.show(
                SCAN_NOT_SHOWN.diagnostic(
                    f'{topic} is not shown: model "{model}" has no link "{frame}"',
                    values={"topic": topic, "model": model, "frame": frame},
                )
            )


def _node(topic: str) -> str:
    return f"/scans{topic}"


def row_of_frame(links: Sequence[tuple[str, str]], model: str, frame: str) -> int | None:
    """The row of the link with a frame id, with or without a prefix; None if there is none.

    Args:
        links: Model and link of each row.
        model: Model name.
        frame: Frame id in the message.
    """
    bare = frame.rsplit("/", 1)[-1]
    for name in (frame, bare):
        if (model, name) in links:
            return links.index((model, name))
    return None


def points_of_scan(message: Any) -> Array:
    """End points of a LaserScan's rays in its frame, shape (n, 3), for rays with a hit."""
    ranges = np.asarray(message.ranges, dtype=float)
    angles = message.angle_min + np.arange(len(ranges)) * message.angle_increment
    hit = np.isfinite(ranges)
    flat = ranges[hit], angles[hit]
    return np.stack(
        [flat[0] * np.cos(flat[1]), flat[0] * np.sin(flat[1]), np.zeros(len(flat[0]))], axis=1
    )


def points_of(message: Any) -> Array:
    """Points of a PointCloud2 in its frame, shape (n, 3), at most `MOST_POINTS`."""
    offsets = {field.name: field.offset for field in message.fields if field.datatype == _FLOAT32}
    if not {"x", "y", "z"} <= set(offsets):
        return np.zeros((0, 3))
    layout = np.dtype(
        {
            "names": ["x", "y", "z"],
            "formats": [">f4" if message.is_bigendian else "<f4"] * 3,
            "offsets": [offsets[axis] for axis in "xyz"],
            "itemsize": message.point_step,
        }
    )
    rows = np.asarray(message.data, dtype=np.uint8).reshape(message.height, message.row_step)
    packed = np.ascontiguousarray(rows[:, : message.width * message.point_step])
    cloud = packed.reshape(-1).view(layout)
    cloud = cloud[:: max(1, math.ceil(len(cloud) / MOST_POINTS))]
    points: Array = np.stack([cloud["x"], cloud["y"], cloud["z"]], axis=1).astype(float)
    finite: Array = points[np.isfinite(points).all(axis=1)]
    return finite
