"""Lidars: scans that are published as LaserScan, Range or point clouds."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.devices.rays.outputs import Output
from cartwheel.devices.rays.scan import Scanner, ScannerConfig
from cartwheel.messages import header


@dataclass(frozen=True, kw_only=True, slots=True)
class LidarConfig:
    scanner: ScannerConfig
    """The scanner, whose rate is also the publish rate."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    outputs: tuple[Output, ...]
    """The topics, in the order in which messages are published."""


class Lidar(Component):
    """Measures a scan if one of its topics has subscribers, and publishes it.

    All rays are measured at the same time.

    Args:
        scope: The lidar's model and names.
        config: Scanner and topics.
    """

    def __init__(self, scope: Scope, config: LidarConfig) -> None:
        super().__init__(scope)
        self._scanner = Scanner(self.part, config.scanner)
        self._frame = self.frame(config.frame)
        rate = config.scanner.rate
        self._outputs = [
            (
                output,
                self.advertise(output.topic, output.type_name, rate=rate or None, qos="sensor"),
            )
            for output in config.outputs
        ]
        self.part.schedule(rate, after=self._publish, topics=self.publishers)

    def _publish(self) -> None:
        moment = header(self.part.time_ns, self._frame)
        scan = self._scanner.measure()
        for output, publisher in self._outputs:
            if publisher.wanted:
                publisher.publish(output.message(moment, self._scanner, scan))
