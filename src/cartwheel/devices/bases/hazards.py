"""Hazards to a mobile base: pressed bumpers, cliffs and dropped wheels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, where
from cartwheel.devices.rays.scan import Scanner, ScannerConfig
from cartwheel.geometry import quat_conjugate, rotate
from cartwheel.graph import Publisher
from cartwheel.messages import header, message_class

_HAZARD = "irobot_create_msgs/msg/HazardDetection"
_ZONES = ("bump_right", "bump_front_right", "bump_front_center", "bump_front_left", "bump_left")
"""Zones of the bumper, each a fifth of its half circle, from right to left."""
_DROPPED, _LIFTED = 0.95, 0.75
"""Fractions of the threshold above which a wheel has dropped, and below which it is back."""


class _HazardSensor(Component):
    """Publishes a HazardDetection at each update while the hazard exists."""

    def __init__(self, scope: Scope, topic: str, rate: float) -> None:
        super().__init__(scope)
        self._HazardDetection = message_class(_HAZARD)
        self._publisher = self.advertise(topic, _HAZARD, qos="sensor")
        self.part.schedule(rate, after=self._update, topics=self._topics)

    @property
    def _topics(self) -> Sequence[Publisher] | None:
        """The topics without whose subscribers the sensor sleeps; None: it never sleeps."""
        return self.publishers

    def _update(self) -> None:
        raise NotImplementedError

    def _publish(self, kind: int, frame: str) -> None:
        head = header(self.part.time_ns, self.frame(frame))
        self._publisher.publish(self._HazardDetection(head, kind))


@dataclass(frozen=True, kw_only=True, slots=True)
class BumperZonesConfig:
    collisions: frozenset[str]
    """The bumper's collisions, as ``link::collision``."""
    topic: str
    rate: float
    """Publish rate, Hz; 0: every step."""


class BumperZones(_HazardSensor):
    """Publishes the zone of a bumper with the deepest contact, whose name is the frame ID."""

    def __init__(self, scope: Scope, config: BumperZonesConfig) -> None:
        self._collisions = config.collisions
        self._base = scope.part.link(scope.part.description.canonical_link)
        super().__init__(scope, config.topic, config.rate)

    def _update(self) -> None:
        contacts = self.part.contacts(self._collisions)
        if not contacts:
            return
        position, orientation = self._base.place()
        deepest = max(contacts, key=lambda contact: contact.depth)
        arm = [a - b for a, b in zip(deepest.position.tolist(), position, strict=True)]
        x, y, _ = rotate(quat_conjugate(orientation), arm)
        zone = zone_at(x, y)
        if zone is not None:
            self._publish(self._HazardDetection.BUMP, zone)


def zone_at(x: float, y: float) -> str | None:
    """Returns the zone of a contact at a position relative to the base, m; None behind the base."""
    zone = math.floor((math.atan2(y, x) / math.pi + 0.5) * len(_ZONES))
    return _ZONES[zone] if 0 <= zone < len(_ZONES) else None


@dataclass(frozen=True, kw_only=True, slots=True)
class CliffSensorConfig:
    scanner: ScannerConfig
    """Rays towards the floor."""
    threshold: float
    """Smallest range that is a cliff, m."""
    topic: str
    frame: str
    rate: float
    """Publish rate, Hz; 0: every step."""


class CliffSensor(_HazardSensor):
    """Publishes a hazard while the nearest range to the floor is at least the threshold."""

    def __init__(self, scope: Scope, config: CliffSensorConfig) -> None:
        self._config = config
        self._scanner = Scanner(scope.part, config.scanner)
        super().__init__(scope, config.topic, config.rate)

    def _update(self) -> None:
        if nearest(self._scanner) >= self._config.threshold:
            self._publish(self._HazardDetection.CLIFF, self._config.frame)


def nearest(scanner: Scanner) -> float:
    """Returns the nearest range, m, within the limits of the sensor."""
    least = float(scanner.measure().ranges.min())
    return float(np.clip(least, scanner.pattern.minimum, scanner.pattern.maximum))


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelDropSensorConfig:
    joint: str
    """Suspension joint of the wheel."""
    threshold: float
    """Position of the fully extended joint, m."""
    topic: str
    frame: str
    rate: float
    """Rate of checks and messages, Hz."""


class WheelDropSensor(_HazardSensor):
    """Publishes a hazard while the suspension of a wheel is extended.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, scope: Scope, config: WheelDropSensorConfig) -> None:
        self._config = config
        self._joint = scope.part.joint(config.joint, origin=scope.origin)
        self._dropped = False
        super().__init__(scope, config.topic, config.rate)

    def reset(self) -> None:
        super().reset()
        self._dropped = False

    @property
    def _topics(self) -> Sequence[Publisher] | None:
        # The hysteresis must not depend on whether there are subscribers.
        return None

    def _update(self) -> None:
        self._dropped = dropped(self._joint.position, self._config.threshold, before=self._dropped)
        if self._dropped:
            self._publish(self._HazardDetection.WHEEL_DROP, self._config.frame)


def dropped(position: Number, threshold: float, *, before: Any) -> Any:
    """Whether a wheel has dropped: above 95 % of the threshold, until it is below 75 %."""
    return position >= where(before, _LIFTED, _DROPPED) * threshold
