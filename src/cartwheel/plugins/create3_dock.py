"""What iRobot's Create 3 sees of its dock, and whether it stands in it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.geometry import Pose
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.create3 import out_topic
from cartwheel.plugins.parameters import tag

OPCODE = "irobot_create_msgs/msg/IrOpcode"
_CHECKS = 20.0
"""Hz of looking; without a code in the time between the dock is not seen."""
_NEAR, _AHEAD = 0.075, math.pi / 30
"""m and rad between the two within which it is docked."""
_HALO = 0.6096
"""m; reach of the light all around the dock."""
_BUOYS, _OPENING, _SHARE = 1.0, math.radians(50), 0.6
"""m and rad of the two lights ahead of it, each of which has that share, on its side."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Dock:
    robot: str = tag(
        "robot_model_name", default="", doc="Accepted: it is the robot that names the plugin."
    )
    receiver: str = tag("receiver_link_name", doc="Link of the robot that sees.")
    dock: str = tag("dock_model_name", default="", doc="The dock's model in the world.")
    emitter: str = tag("emitter_link_name", default="", doc="Link of the dock that is seen.")


class _Docking(Plugin[Any]):
    """Where receiver and emitter are, each seen from the other."""

    def _find(self) -> None:
        self._receiver = self.part.link(self.config.receiver, origin=self.tag.origin)
        self._around = self.part.surroundings()

    def _seen(self) -> tuple[tuple[float, float], float] | None:
        """Distance in m and azimuth of the emitter, and the receiver's azimuth there, rad.

        None while there is no such dock.
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
    rate: float = tag("update_rate", default=31.0, unit="Hz", doc="Of the codes.")
    omni_opening: float = tag("sensor_0_fov", default=1.0, unit="rad", doc="Of the sensor above.")
    omni_range: float = tag("sensor_0_range", default=1.0, unit="m", doc="Of the sensor above.")
    front_opening: float = tag("sensor_1_fov", default=1.0, unit="rad", doc="Of the one ahead.")
    front_range: float = tag("sensor_1_range", default=1.0, unit="m", doc="Of the one ahead.")


class Create3Opcode(_Docking):
    """Publishes the codes that the robot's two receivers see: of the dock's halo and its buoys.

    A sensor's range is added to that of the light. Source: irobot_create_gazebo_plugins,
    gazebo_ros_ir_opcode.
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
                self._tell(number, self._IrOpcode.CODE_IR_FORCE_FIELD)
        for number, (opening, reach) in enumerate(self._sensors):
            if abs(azimuth) < opening / 2 and distance < reach + _BUOYS:
                code = 0
                if -_OPENING / 2 < back < (_SHARE - 0.5) * _OPENING:
                    code |= self._IrOpcode.CODE_IR_BUOY_GREEN
                if (0.5 - _SHARE) * _OPENING < back < _OPENING / 2:
                    code |= self._IrOpcode.CODE_IR_BUOY_RED
                if code:
                    self._tell(number, code)

    def _tell(self, sensor: int, code: int) -> None:
        moment = header(self.part.time_ns, self.frame(self.config.receiver))
        self._publisher.publish(self._IrOpcode(moment, code, sensor))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3DockStatusParameters(_Dock):
    rate: float = tag(
        "update_rate", default=1.0, unit="Hz", doc="Of the status; a change is told at once."
    )


class Create3DockStatus(_Docking):
    """Publishes whether the robot sees its dock, by ``ir_opcode``, and whether it stands in it.

    Nothing while the world has no dock. Source: irobot_create_gazebo_plugins,
    gazebo_ros_docking_status.
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
        self._heard_ns: int | None = None
        self._told: tuple[bool, bool] | None = None
        self._told_ns = 0

    def _on_opcode(self, message: Any) -> None:
        known = message.opcode != message.CODE_IR_VIRTUAL_WALL
        self._heard_ns = self.part.time_ns if known else None

    def _look(self) -> None:
        seen = self._seen()
        if seen is None:
            return
        (distance, azimuth), back = seen
        now = self.part.time_ns
        visible = self._heard_ns is not None and now - self._heard_ns <= 1e9 / _CHECKS
        docked = distance < _NEAR and abs(azimuth) < _AHEAD and abs(back) < _AHEAD
        due = now - self._told_ns >= 1e9 / self.config.rate
        if due or (visible, docked) != self._told:
            self._told, self._told_ns = (visible, docked), now
            moment = header(now, self.frame("base_link"))
            self._publisher.publish(self._DockStatus(moment, visible, docked))
