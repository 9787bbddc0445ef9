"""Dock detection and docking status of iRobot's Create 3."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.dialects.makers.create3 import out_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose
from cartwheel.messages import header, message_class

OPCODE = "irobot_create_msgs/msg/IrOpcode"
_CHECKS = 20.0
"""Rate of checks, Hz. The dock is visible if a code arrived within one period."""
_NEAR, _AHEAD = 0.075, math.pi / 30
"""Maximum distance in m and angles in rad between robot and dock when docked."""
_HALO = 0.6096
"""Range of the dock's halo, which surrounds it, m."""
_BUOYS, _OPENING, _SHARE = 1.0, math.radians(50), 0.6
"""Range in m and angle in rad of the dock's two buoys; fraction of it that each covers."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Dock:
    robot: str = tag(
        "robot_model_name",
        default="",
        doc="No effect: the robot is the model that contains the plugin.",
    )
    receiver: str = tag("receiver_link_name", doc="Link of the robot's infrared receiver.")
    dock: str = tag("dock_model_name", default="", doc="Name of the dock's model in the world.")
    emitter: str = tag("emitter_link_name", default="", doc="Link of the dock's infrared emitter.")


class _Docking(Plugin[Any]):
    """Relative position of receiver and emitter."""

    def _find(self) -> None:
        self._receiver = self.part.link(self.config.receiver, origin=self.tag.origin)
        self._around = self.part.surroundings()

    def _seen(self) -> tuple[tuple[float, float], float] | None:
        """Returns the emitter in the receiver's frame, and the receiver in the emitter's frame.

        Returns:
            Distance in m and azimuth in rad of the emitter; azimuth in rad of the receiver. None if
            the world has no such dock.
        """
        emitter = self._around.pose(self.config.dock, self.config.emitter)
        if emitter is None:
            return None
        receiver = self._receiver.pose
        there, here = receiver.inverse() @ emitter, emitter.inverse() @ receiver
        return (math.hypot(there.x, there.y), _azimuth(there)), _azimuth(here)


def _azimuth(pose: Pose) -> float:
    return math.atan2(pose.y, pose.x)


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3OpcodeParameters(_Dock):
    rate: float = tag("update_rate", default=31.0, unit="Hz", doc="Rate of the codes.")
    omni_opening: float = tag(
        "sensor_0_fov", default=1.0, unit="rad", doc="Field of view of the top receiver."
    )
    omni_range: float = tag(
        "sensor_0_range", default=1.0, unit="m", doc="Range of the top receiver."
    )
    front_opening: float = tag(
        "sensor_1_fov", default=1.0, unit="rad", doc="Field of view of the front receiver."
    )
    front_range: float = tag(
        "sensor_1_range", default=1.0, unit="m", doc="Range of the front receiver."
    )


class Create3Opcode(_Docking):
    """Publishes the infrared codes from the dock that the robot's two receivers detect.

    The dock emits three infrared signals: the halo, which surrounds it, and the red and the green
    buoy. A receiver detects a signal if the distance to the dock is below the range of the receiver
    plus the range of the signal. Original plugin: ``gazebo_ros_ir_opcode`` in the package
    ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_ir_opcode.so",)
    parameters: ClassVar[type] = Create3OpcodeParameters

    def configure(self) -> None:
        config: Create3OpcodeParameters = self.config
        self.check_above_zero(update_rate=config.rate)
        self._find()
        self._IrOpcode = message_class(OPCODE)
        self._sensors = (
            (config.omni_opening, config.omni_range),
            (config.front_opening, config.front_range),
        )
        self._publisher = self.advertise(out_topic(self), OPCODE, qos="sensor")
        self.part.schedule(config.rate, after=self._look, active=lambda: self._publisher.wanted)

    def _look(self) -> None:
        seen = self._seen()
        if seen is None:
            return
        (distance, azimuth), back = seen
        for number, (opening, reach) in enumerate(self._sensors):
            if abs(azimuth) < opening / 2 and distance < reach + _HALO:
                self._publish_code(number, self._IrOpcode.CODE_IR_FORCE_FIELD)
        for number, (opening, reach) in enumerate(self._sensors):
            if abs(azimuth) < opening / 2 and distance < reach + _BUOYS:
                code = 0
                if -_OPENING / 2 < back < (_SHARE - 0.5) * _OPENING:
                    code |= self._IrOpcode.CODE_IR_BUOY_GREEN
                if (0.5 - _SHARE) * _OPENING < back < _OPENING / 2:
                    code |= self._IrOpcode.CODE_IR_BUOY_RED
                if code:
                    self._publish_code(number, code)

    def _publish_code(self, sensor: int, code: int) -> None:
        moment = header(self.part.time_ns, self.frame(self.config.receiver))
        self._publisher.publish(self._IrOpcode(moment, code, sensor))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3DockStatusParameters(_Dock):
    rate: float = tag(
        "update_rate",
        default=1.0,
        unit="Hz",
        doc="Publish rate. Changes are published immediately.",
    )


class Create3DockStatus(_Docking):
    """Publishes whether the robot detects its dock and whether it is docked.

    The dock counts as visible while its codes are received on ``ir_opcode``. Nothing is published
    if the world has no dock. Original plugin: ``gazebo_ros_docking_status`` in the package
    ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_docking_status.so",)
    parameters: ClassVar[type] = Create3DockStatusParameters

    def configure(self) -> None:
        config: Create3DockStatusParameters = self.config
        self.check_above_zero(update_rate=config.rate)
        self._find()
        kind = "irobot_create_msgs/msg/DockStatus"
        self._DockStatus = message_class(kind)
        self._publisher = self.advertise(out_topic(self), kind, qos="sensor")
        self.subscribe("ir_opcode", OPCODE, self._on_opcode)
        self.part.schedule(_CHECKS, after=self._look)
        self.reset()

    def reset(self) -> None:
        self._opcode_ns: int | None = None
        self._published: tuple[bool, bool] | None = None
        self._published_ns = 0

    def _on_opcode(self, message: Any) -> None:
        known = message.opcode != message.CODE_IR_VIRTUAL_WALL
        self._opcode_ns = self.part.time_ns if known else None

    def _look(self) -> None:
        seen = self._seen()
        if seen is None:
            return
        (distance, azimuth), back = seen
        now = self.part.time_ns
        visible = self._opcode_ns is not None and now - self._opcode_ns <= 1e9 / _CHECKS
        docked = distance < _NEAR and abs(azimuth) < _AHEAD and abs(back) < _AHEAD
        due = now - self._published_ns >= 1e9 / self.config.rate
        if due or (visible, docked) != self._published:
            self._published, self._published_ns = (visible, docked), now
            moment = header(now, self.frame("base_link"))
            self._publisher.publish(self._DockStatus(moment, visible, docked))
