"""Performance metrics of the simulation and its sensors."""

from __future__ import annotations

import time
from dataclasses import dataclass

from cartwheel.description.model import Sensor
from cartwheel.graph import Graph
from cartwheel.messages import header, message_class
from cartwheel.simulation import Simulation
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.world.entry import scoped

RATE = 5.0
"""Publish rate, Hz of simulation time."""
_CAMERAS = ("camera", "depth", "depth_camera", "rgbd_camera", "multicamera", "wideanglecamera")


@dataclass(frozen=True, slots=True)
class _Mark:
    """Counters at one time."""

    wall: float
    time_ns: int
    sent: dict[tuple[str, str], int]
    """Messages by node and topic."""


class Metrics:
    """``performance_metrics``: the real-time factor, and the rate of each sensor.

    Measured between two messages, and only while there are subscribers. Source: Gazebo 11,
    gazebo_ros_api_plugin.
    """

    def __init__(
        self, simulation: Simulation, graph: Graph, node: str, *, prefix: str = "/gazebo"
    ) -> None:
        self._simulation = simulation
        self._graph = graph
        self._publisher = graph.advertise(
            f"{prefix}/performance_metrics",
            "gazebo_msgs/msg/PerformanceMetrics",
            node=node,
            rate=RATE,
        )
        self._last: _Mark | None = None
        self._task = simulation.schedule(RATE, after=self._publish, active=self._wanted)

    def close(self) -> None:
        """Removes the topic."""
        self._simulation.unschedule(self._task)
        self._publisher.close()

    def _wanted(self) -> bool:
        if self._publisher.wanted:
            return True
        self._last = None
        return False

    def _publish(self) -> None:
        sent = {(each.node, each.topic): each.sent for each in self._graph.publishers()}
        mark = _Mark(time.perf_counter(), self._simulation.time_ns, sent)
        last, self._last = self._last, mark
        if last is None or last.time_ns >= mark.time_ns:
            return
        wall = max(mark.wall - last.wall, 1e-9)
        simulated = (mark.time_ns - last.time_ns) / NANOSECONDS
        kind = message_class("gazebo_msgs/msg/SensorPerformanceMetric")
        sensors = []
        for name, sensor, nodes in self._sensors():
            counts = [
                count - last.sent.get(key, 0) for key, count in sent.items() if key[0] in nodes
            ]
            count = max(counts, default=0)
            frames = count / wall if sensor.type in _CAMERAS else 0.0
            sensors.append(kind(name, count / simulated, count / wall, frames))
        self._publisher.publish(
            message_class("gazebo_msgs/msg/PerformanceMetrics")(
                header(mark.time_ns, ""), simulated / wall, sensors
            )
        )

    def _sensors(self) -> list[tuple[str, Sensor, set[str]]]:
        """Each sensor with its scoped name and the nodes that publish its data."""
        return [
            (
                scoped(placed.name, link.name, sensor.name),
                sensor,
                {f"{placed.name}/{name}" for name in (sensor.name, *_names(sensor))},
            )
            for placed in self._simulation.scene.models
            for link in placed.description.links
            for sensor in link.sensors
        ]


def _names(sensor: Sensor) -> list[str]:
    return [tag.name for tag in sensor.plugins]
