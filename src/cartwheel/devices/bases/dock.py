"""The infrared signals of a dock, and whether a base is docked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from cartwheel.component import Component, Scope
from cartwheel.geometry import Pose
from cartwheel.messages import header, message_class

_OPCODE = "irobot_create_msgs/msg/IrOpcode"
_STATUS = "irobot_create_msgs/msg/DockStatus"
_CHECKS = 20.0
"""Rate of checks, Hz. The dock is visible if a code arrived within one period."""
_NEAR, _AHEAD = 0.075, math.pi / 30
"""Maximum distance in m and angles in rad between robot and dock when docked."""
_HALO = 0.6096
"""Range of the dock's halo, which surrounds it, m."""
_BUOYS, _OPENING, _SHARE = 1.0, math.radians(50), 0.6
"""Range in m and angle in rad of the dock's two buoys; fraction of it that each covers."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DockConfig:
    """The receiver and the dock."""

    receiver: str
    """Link of the robot's infrared receiver."""
    model: str
    """Name of the dock's model in the world."""
    emitter: str
    """Link of the dock's infrared emitter."""


class Sighting(NamedTuple):
    """Relative position of receiver and emitter."""

    distance: float
    """m."""
    azimuth: float
    """Direction of the emitter in the receiver's frame, rad."""
    back: float
    """Direction of the receiver in the emitter's frame, rad."""


class _DockSensor(Component):
    def __init__(self, scope: Scope, dock: DockConfig) -> None:
        super().__init__(scope)
        self._dock = dock
        self._receiver = self.part.link(dock.receiver, origin=self.origin)
        self._surroundings = self.part.surroundings()

    def _measure(self) -> Sighting | None:
        """Returns the position of the dock; None if the world has no such dock."""
        emitter = self._surroundings.pose(self._dock.model, self._dock.emitter)
        return None if emitter is None else sighting(self._receiver.pose, emitter)


def sighting(receiver: Pose, emitter: Pose) -> Sighting:
    """Returns the relative position of a receiver and an emitter with these poses."""
    there, back = receiver.inverse() @ emitter, emitter.inverse() @ receiver
    distance = math.hypot(there.x, there.y)
    return Sighting(distance, math.atan2(there.y, there.x), math.atan2(back.y, back.x))


@dataclass(frozen=True, kw_only=True, slots=True)
class IrReceiversConfig:
    dock: DockConfig
    receivers: tuple[tuple[float, float], ...]
    """Field of view in rad and range in m of each receiver."""
    topic: str
    rate: float
    """Rate of the codes, Hz."""


class IrReceivers(_DockSensor):
    """Publishes the codes of a dock's infrared signals that receivers detect.

    Raises:
        UnknownNameError: The receiver's link does not exist.
    """

    def __init__(self, scope: Scope, config: IrReceiversConfig) -> None:
        super().__init__(scope, config.dock)
        self._receivers = config.receivers
        self._IrOpcode = message_class(_OPCODE)
        self._publisher = self.advertise(config.topic, _OPCODE, qos="sensor")
        self.part.schedule(config.rate, after=self._update, topics=self.publishers)

    def _update(self) -> None:
        seen = self._measure()
        if seen is None:
            return
        for number, (opening, reach) in enumerate(self._receivers):
            if abs(seen.azimuth) < opening / 2 and seen.distance < reach + _HALO:
                self._publish(number, self._IrOpcode.CODE_IR_FORCE_FIELD)
        green, red = buoys(seen.back)
        code = 0
        if green:
            code |= self._IrOpcode.CODE_IR_BUOY_GREEN
        if red:
            code |= self._IrOpcode.CODE_IR_BUOY_RED
        for number, (opening, reach) in enumerate(self._receivers):
            if code and abs(seen.azimuth) < opening / 2 and seen.distance < reach + _BUOYS:
                self._publish(number, code)

    def _publish(self, receiver: int, code: int) -> None:
        head = header(self.part.time_ns, self.frame(self._dock.receiver))
        self._publisher.publish(self._IrOpcode(head, code, receiver))


def buoys(back: float) -> tuple[bool, bool]:
    """Whether the green and the red buoy reach a receiver in a direction from the emitter, rad."""
    green = -_OPENING / 2 < back < (_SHARE - 0.5) * _OPENING
    red = (0.5 - _SHARE) * _OPENING < back < _OPENING / 2
    return green, red


def is_docked(seen: Sighting) -> bool:
    """Whether a base is so near to its dock, and so well aligned, that it is docked."""
    return seen.distance < _NEAR and abs(seen.azimuth) < _AHEAD and abs(seen.back) < _AHEAD


@dataclass(frozen=True, kw_only=True, slots=True)
class DockStatusConfig:
    dock: DockConfig
    topic: str
    opcode_topic: str
    """Topic of the dock's codes. While they are received, the dock is visible."""
    frame: str
    rate: float
    """Publish rate, Hz. Changes are published immediately."""


class DockStatus(_DockSensor):
    """Publishes whether a base detects its dock and whether it is docked.

    Raises:
        UnknownNameError: The receiver's link does not exist.
    """

    def __init__(self, scope: Scope, config: DockStatusConfig) -> None:
        super().__init__(scope, config.dock)
        self._config = config
        self._DockStatus = message_class(_STATUS)
        self._publisher = self.advertise(config.topic, _STATUS, qos="sensor")
        self.subscribe(config.opcode_topic, _OPCODE, self._on_opcode)
        self.part.schedule(_CHECKS, after=self._update)
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._opcode_ns: int | None = None
        self._published: tuple[bool, bool] | None = None
        self._published_ns = 0

    def _on_opcode(self, message: Any) -> None:
        is_dock = message.opcode != message.CODE_IR_VIRTUAL_WALL
        self._opcode_ns = self.part.time_ns if is_dock else None

    def _update(self) -> None:
        seen = self._measure()
        if seen is None:
            return
        now = self.part.time_ns
        visible = self._opcode_ns is not None and now - self._opcode_ns <= 1e9 / _CHECKS
        docked = is_docked(seen)
        due = now - self._published_ns >= 1e9 / self._config.rate
        if due or (visible, docked) != self._published:
            self._published, self._published_ns = (visible, docked), now
            head = header(now, self.frame(self._config.frame))
            self._publisher.publish(self._DockStatus(head, visible, docked))
