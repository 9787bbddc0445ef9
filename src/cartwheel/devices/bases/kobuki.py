"""The sensors of a Kobuki base: IMU, bumpers, cliff sensors and wheel drop sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.inertial.messages import imu_message
from cartwheel.devices.inertial.unit import InertialUnit, InertialUnitConfig
from cartwheel.devices.rays.scan import Scanner, ScannerConfig
from cartwheel.geometry import Array, yaw_of
from cartwheel.messages import header, message_class

_SIDES = ("left", "center", "right")
_LOWEST, _HIGHEST = 0.01, 0.13
"""m above the root link: contacts between these heights press the bumper."""
_IMU_COVARIANCES = (*[np.diag([1e6, 1e6, 0.05]).ravel()] * 2, np.zeros(9))
_MOST = 4095
"""Largest reading of a cliff sensor's A/D converter."""


@dataclass(frozen=True, kw_only=True, slots=True)
class KobukiSensorsConfig:
    floors: tuple[ScannerConfig, ScannerConfig, ScannerConfig]
    """Left, centre and right cliff sensor, which face the floor."""
    cliff_threshold: float
    """Smallest distance to the floor that is a cliff, m."""
    bumper: frozenset[str]
    """Collisions of the bumper, as ``link::collision``."""
    wheels: tuple[frozenset[str] | None, frozenset[str] | None]
    """Collisions of the left and the right wheel. Without contact, the wheel has dropped. None:
    the wheel has no sensor, and never drops."""
    unit: InertialUnitConfig
    namespace: str
    """Prefix of the topics, which ends with a slash."""
    frame: str
    rate: float
    """Publish rate, Hz; 0: every step."""


class KobukiSensors(Component):
    """Publishes the IMU and the sensor state of a Kobuki base, and events when a state changes.

    Args:
        scope: The base's model and names.
        config: Sensors and topics.
    """

    def __init__(self, scope: Scope, config: KobukiSensorsConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._floors = {
            side: Scanner(part, floor) for side, floor in zip(_SIDES, config.floors, strict=True)
        }
        self._bumper = config.bumper
        self._wheels = dict(zip(("left", "right"), config.wheels, strict=True))
        self.unit = InertialUnit(part, config.unit)
        self._root = part.link(part.description.canonical_link)
        self._frame = self.frame(config.frame)
        kinds = {
            "cliff": "CliffEvent",
            "bumper": "BumperEvent",
            "wheel_drop": "WheelDropEvent",
        }
        types = {name: f"kobuki_msgs/msg/{kind}" for name, kind in kinds.items()}
        self._Events = {name: message_class(kind) for name, kind in types.items()}
        self._events = {
            name: self.advertise(f"{config.namespace}events/{name}", kind)
            for name, kind in types.items()
        }
        rate = config.rate or None
        self._imu = self.advertise(
            config.namespace + "sensors/imu_data", "sensor_msgs/msg/Imu", rate=rate
        )
        self._Core = message_class("kobuki_msgs/msg/SensorState")
        self._core = self.advertise(
            config.namespace + "sensors/core", "kobuki_msgs/msg/SensorState", rate=rate
        )
        self.part.schedule(config.rate, after=self._sense, topics=self.publishers)
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._cliff = dict.fromkeys(_SIDES, False)
        self._pressed = dict.fromkeys(_SIDES, False)
        self._dropped = dict.fromkeys(("left", "right"), False)

    def _sense(self) -> None:
        if self._imu.wanted:
            moment = header(self.part.time_ns, self._frame)
            self._imu.publish(imu_message(moment, *self.unit.measure(), _IMU_COVARIANCES))
        self._check_cliffs()
        self._check_contacts()
        if self._core.wanted:
            self._core.publish(
                self._Core(
                    header=header(self.part.time_ns, self._frame),
                    time_stamp=self.part.time_ns // 1_000_000 % 65536,
                    bumper=_bits(self._pressed, left=4, center=2, right=1),
                    wheel_drop=_bits(self._dropped, left=2, right=1),
                    cliff=_bits(self._cliff, left=4, center=2, right=1),
                )
            )

    def _check_cliffs(self) -> None:
        for index, side in enumerate(_SIDES):
            scanner = self._floors[side]
            # Only the first ray is used. If it is out of range, the floor is at the maximum range.
            floor = min(float(scanner.measure().ranges[0, 0]), scanner.pattern.maximum)
            cliff = floor >= self._config.cliff_threshold
            if cliff != self._cliff[side]:
                self._cliff[side] = cliff
                self._publish_event("cliff", index, int(cliff), cliff_reading(floor))

    def _check_contacts(self) -> None:
        place, turned = self._root.place()
        pressed = dict.fromkeys(_SIDES, False)
        for contact in self.part.contacts(self._bumper):
            if _LOWEST <= contact.position[2] - place[2] <= _HIGHEST:
                side = bumper_at(contact.normal, yaw_of(turned))
                if side:
                    pressed[side] = True
        self._publish_changes("bumper", self._pressed, pressed)
        dropped = {
            side: collisions is not None and not self.part.contacts(collisions)
            for side, collisions in self._wheels.items()
        }
        self._publish_changes("wheel_drop", self._dropped, dropped)

    def _publish_changes(self, name: str, before: dict[str, bool], now: dict[str, bool]) -> None:
        for index, (side, state) in enumerate(now.items()):
            if before[side] != state:
                before[side] = state
                self._publish_event(name, index, int(state))

    def _publish_event(self, name: str, *values: int) -> None:
        if self._events[name].wanted:
            self._events[name].publish(self._Events[name](*values))


def bumper_at(normal: Array, heading: float) -> str:
    """Returns the pressed bumper; empty behind the robot. The normal points into the robot."""
    x, y, _ = (-normal).tolist()
    angle = math.remainder(math.atan2(y, x) - heading, 2 * math.pi)
    if abs(angle) > math.pi / 2:
        return ""
    if abs(angle) <= math.pi / 6:
        return "center"
    return "left" if angle > 0 else "right"


def _bits(states: dict[str, bool], **values: int) -> int:
    return sum(values[side] for side, state in states.items() if state)


def cliff_reading(distance: float) -> int:
    """Returns the reading of a cliff sensor's A/D converter for a distance in m."""
    return min(int(76123.0 * math.atan2(0.995, max(distance, 0.0) * 1000)), _MOST)
