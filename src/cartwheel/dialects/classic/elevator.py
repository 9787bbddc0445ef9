"""``libgazebo_ros_elevator.so``: an elevator with floors and a door."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices, running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import shown, tag
from cartwheel.simulation.handles import JointHandle, MotorHandle

_RATE = 100.0
"""Rate of the control loop, Hz."""
_OPEN = 1.0
"""Travel of the opening door, m, as in Gazebo; less if the joint's limit is lower."""
_LIFT_EFFORT = 1e5
"""N; used if the joint has no effort limit."""
_DOOR_EFFORT = 100.0
_LIFT_SPEED, _LIFT_ACCELERATION = 1.5, 1.0
"""m/s and m/s²; low enough for passengers to remain standing."""
_DOOR_SPEED, _DOOR_ACCELERATION = 0.5, 1.0
_THERE = 1e-3
"""Distance from the target at which a motor stops, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ElevatorParameters:
    lift_joint: str = tag("lift_joint", doc="Prismatic joint that moves the car.")
    door_joint: str = tag("door_joint", doc="Prismatic joint of the door. Position 0 is closed.")
    floor_height: float = tag("floor_height", default=3.0, unit="m", doc="Height of a floor.")
    door_wait_time: float = tag(
        "door_wait_time", default=5.0, unit="s", doc="Time for which the door stays open."
    )
    topic: str = tag(
        "topic",
        default="elevator",
        doc="Topic of the String messages with the number of the target floor.",
    )
    bottom_floor: int | None = tag(
        "bottom_floor", default=None, doc="Lowest floor. Default: no limit."
    )
    top_floor: int | None = tag("top_floor", default=None, doc="Highest floor. Default: no limit.")


class Elevator(Plugin[ElevatorParameters]):
    """Moves an elevator's car to the commanded floor and operates its door.

    For each command, the door closes and the car moves. The door then opens, waits for
    ``<door_wait_time>`` and closes. New commands are ignored until the door is closed again. At
    floor n, the position of the lift joint is n times ``<floor_height>``. Original plugins:
    ``gazebo_ros_elevator`` in the package ``gazebo_plugins``, and ``ElevatorPlugin`` in Gazebo
    Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_elevator.so", "libElevatorPlugin.so")
    parameters: ClassVar[type] = ElevatorParameters

    def configure(self) -> None:
        config = self.config
        self.check_above_zero(floor_height=config.floor_height)
        self.check_not_negative("door_wait_time")
        if self.tag.element.find("floor_height") is None:
            self.warn(
                devices.PLUGIN_PARAMETER_MISSING,
                "<floor_height> is missing, so 3 m is used",
                values={"parameter": "floor_height"},
            )
        self._lift = self._drive(config.lift_joint, _LIFT_EFFORT, _LIFT_SPEED, _LIFT_ACCELERATION)
        self._door = self._drive(config.door_joint, _DOOR_EFFORT, _DOOR_SPEED, _DOOR_ACCELERATION)
        self._steps: deque[Callable[[], bool]] = deque()
        self._wait_until: int | None = None
        topic = config.topic.strip().removeprefix("~/") or "elevator"
        self.subscribe(topic, "std_msgs/msg/String", self._order)
        self.part.schedule(_RATE, before=self._control)

    def reset(self) -> None:
        self._steps.clear()
        self._wait_until = None
        for drive in (self._lift, self._door):
            drive.target = 0.0
            drive.stop()

    def _drive(self, name: str, effort: float, speed: float, acceleration: float) -> _Drive:
        """Creates the drive of a joint, whose name can be prefixed with the model's name."""
        origin = self.tag.origin
        description = self.part.description
        if description.joint(name) is None:
            name = name.removeprefix(f"{description.name}::").removeprefix(f"{self.part.name}::")
        joint = self.part.joint(name, origin=origin)
        axis = next(each.axis for each in description.joints if each.name == name)
        motor = self.part.velocity_motor(name, max_effort=axis.effort or effort, origin=origin)
        low = -math.inf if axis.lower is None else axis.lower
        high = math.inf if axis.upper is None else axis.upper
        return _Drive(joint, motor, speed=speed, acceleration=acceleration, limits=(low, high))

    def _order(self, message: Any) -> None:
        """Starts a trip to a floor. Invalid floors are ignored with a warning."""
        text = str(message.data).strip()
        config = self.config
        try:
            floor = int(text)
        except ValueError:
            self.warn(
                running.COMMAND_IGNORED,
                f'a command is ignored: the floor must be a whole number (got "{shown(text)}")',
                values={"floor": shown(text)},
            )
            return
        lowest, highest = config.bottom_floor, config.top_floor
        fault = ""
        if lowest is not None and floor < lowest:
            fault = f"below the lowest floor {lowest}"
        elif highest is not None and floor > highest:
            fault = f"above the highest floor {highest}"
        if fault:
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: floor {floor} is {fault}",
                values={"floor": str(floor)},
            )
            return
        if self._steps:
            return
        height = floor * config.floor_height
        if self._lift.within(height) != height:
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: floor {floor} at {height:g} m is beyond the limits of "
                "<lift_joint>",
                values={"floor": str(floor)},
            )
            return
        self._steps.extend(
            [
                lambda: self._door.reached(0.0),
                lambda: self._lift.reached(height),
                lambda: self._door.reached(self._door.within(_OPEN)),
                self._waited,
                lambda: self._door.reached(0.0),
            ]
        )

    def _control(self) -> None:
        if self._steps and self._steps[0]():
            self._steps.popleft()
        self._lift.control()
        self._door.control()

    def _waited(self) -> bool:
        now = self.part.time_ns
        if self._wait_until is None:
            self._wait_until = now + round(self.config.door_wait_time * 1e9)
        if now < self._wait_until:
            return False
        self._wait_until = None
        return True


class _Drive:
    """Moves a joint to a target position with limited speed and acceleration, and holds it."""

    def __init__(
        self,
        joint: JointHandle,
        motor: MotorHandle,
        *,
        speed: float,
        acceleration: float,
        limits: tuple[float, float],
    ) -> None:
        self._joint = joint
        self._motor = motor
        self._speed = speed
        self._acceleration = acceleration
        self._limits = limits
        self._velocity = 0.0
        self.target = 0.0

    def within(self, position: float) -> float:
        """Returns the nearest position within the joint's limits."""
        return min(max(position, self._limits[0]), self._limits[1])

    def reached(self, target: float) -> bool:
        """Sets the target and returns whether the joint has stopped there."""
        self.target = target
        return abs(target - self._joint.position) <= 2 * _THERE and self._velocity == 0.0

    def stop(self) -> None:
        """Stops at the current position."""
        self._velocity = 0.0
        self._motor.command(0.0)

    def control(self) -> None:
        """Commands the highest speed from which the joint can still stop at the target."""
        left = self.target - self._joint.position
        if abs(left) <= _THERE:
            self.stop()
            return
        allowed = min(self._speed, math.sqrt(2 * self._acceleration * abs(left)))
        step = self._acceleration / _RATE
        self._velocity = min(abs(self._velocity) + step, allowed)
        self._velocity = math.copysign(self._velocity, left)
        self._motor.command(self._velocity)
