"""Plots IMU data."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from cartwheel.geometry import rpy_from_quat
from cartwheel.graph import Mailbox, TopicInfo
from cartwheel.messages import nanoseconds
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape, of_type
from cartwheel.viewer.stage import Stage

IMU = "sensor_msgs/msg/Imu"
WINDOW = 10.0
"""Plotted time span, s of simulation time."""
_RATE = 6.0
_POINTS = 160
_AXIS = {
    "stroke": "#5c6670",
    "font": "11px sans-serif",
    "gap": 4,
    "ticks": {"show": False},
    "grid": {"stroke": "#e6e9ed", "width": 1},
}
_COLORS = ("#d9480f", "#2b8a3e", "#1864ab")


class ImuPanel(Panel):
    """Angular velocity, linear acceleration and orientation over the last seconds."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._topic = ""
        self._box: Mailbox | None = None
        self._rows: deque[tuple[float, ...]] = deque()
        self._due = Every(_RATE)
        self._note = self.gui.add_html(_note("No IMU topic is published."))
        self._plots = [
            self._plot("angular velocity, rad/s", ("x", "y", "z"), least=0.2),
            self._plot("linear acceleration, m/s²", ("x", "y", "z"), least=1.0),
            self._plot("orientation, degrees", ("roll", "pitch", "yaw"), least=5.0),
        ]

    def watch(self) -> None:
        if self._topic and self._box is None:
            self._box = self.graph.mailbox(self._topic, size=4000, node="viewer")

    def leave(self) -> None:
        if self._box is not None:
            self._box.close()
            self._box = None

    def show_topics(self, topics: Sequence[TopicInfo]) -> None:
        topic = next(iter(of_type(topics, IMU)), "")
        if topic == self._topic:
            return
        self.leave()
        self._topic = topic
        self._rows.clear()
        self._note.content = _note(escape(topic) or "No IMU topic is published.")
        for heading, plot in self._plots:
            heading.visible = plot.visible = bool(topic)
        if self.page.clients:
            self.watch()

    def update(self, snapshot: Snapshot, now: float) -> None:  # noqa: ARG002
        if self._box is None or not self._due(now):
            return
        messages = self._box.drain()
        if not messages:
            return
        for message in messages:
            row = row_of(message)
            if self._rows and row[0] < self._rows[-1][0]:
                self._rows.clear()  # the simulation was reset
            self._rows.append(row)
        while self._rows[-1][0] - self._rows[0][0] > WINDOW:
            self._rows.popleft()
        table = thin(np.array(self._rows), _POINTS)
        for i, (_, plot) in enumerate(self._plots):
            columns = table[:, 1 + 3 * i : 4 + 3 * i]
            plot.data = (table[:, 0].copy(), *(columns[:, k].copy() for k in range(3)))

    def _plot(self, title: str, names: tuple[str, str, str], *, least: float) -> tuple[Any, Any]:
        """A heading and its plot; hidden, because not every robot has an IMU."""
        # The minimum scale is `least`, so that noise of 1e-6 does not fill the plot at rest.
        start = np.zeros(2)
        key = "".join(
            f'<span style="color:{color};margin-left:0.5rem">{name}</span>'
            for name, color in zip(names, _COLORS, strict=True)
        )
        heading = self.gui.add_html(f'<div class="cw"><b>{title}</b>{key}</div>', visible=False)
        plot = self.gui.add_uplot(
            (start, start, start, start),
            (
                {"label": "s"},
                *(
                    {"label": name, "stroke": color, "width": 1.5}
                    for name, color in zip(names, _COLORS, strict=True)
                ),
            ),
            scales={
                "x": {"time": False},
                "y": {
                    "range": {
                        "min": {"soft": -least, "mode": 1, "pad": 0.1},
                        "max": {"soft": least, "mode": 1, "pad": 0.1},
                    }
                },
            },
            axes=({**_AXIS, "size": 24, "space": 60}, {**_AXIS, "size": 38, "space": 18}),
            legend={"show": False},
            height=96,
            padding=(6, 8, 0, 0),
            visible=False,
        )
        return heading, plot


def row_of(message: Any) -> tuple[float, ...]:
    """Time in s, angular velocity, linear acceleration, roll, pitch and yaw in degrees."""
    stamp, q = message.header.stamp, message.orientation
    w, a = message.angular_velocity, message.linear_acceleration
    rpy = (math.degrees(angle) for angle in rpy_from_quat((q.x, q.y, q.z, q.w)))
    return (nanoseconds(stamp) / 1e9, w.x, w.y, w.z, a.x, a.y, a.z, *rpy)


def thin(table: Any, points: int) -> Any:
    """About `points` rows, including the last one: a plot needs no more rows than pixels."""
    stride = max(1, math.ceil(len(table) / points))
    return table[::-1][::stride][::-1]


def _note(text: str) -> str:
    return f'<div class="cw cw-dim">{text}</div>'
