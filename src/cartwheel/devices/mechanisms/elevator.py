"""An elevator with floors and a door."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, copysign, minimum, sqrt
from cartwheel.simulation.dynamics.velocity_motor import MotorHandle
from cartwheel.simulation.handles import JointHandle

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
_TOLERANCE = 1e-3
"""Distance from the target at which a motor stops, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ElevatorConfig:
    lift_joint: str
    """Prismatic joint that moves the car."""
    door_joint: str
    """Prismatic joint of the door. Position 0 is closed."""
    floor_height: float
    """Height of a floor, m."""
    door_wait: float
    """Time for which the door stays open, s."""
    lowest_floor: int | None = None
    """None: no limit."""
    highest_floor: int | None = None
    """None: no limit."""


class Elevator(Component):
    """Moves a car between floors, and closes its door before it moves.

    Args:
        scope: The elevator's model and names.
        config: Joints and floors.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: ElevatorConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._lift = self._drive(config.lift_joint, _LIFT_EFFORT, _LIFT_SPEED, _LIFT_ACCELERATION)
        self._door = self._drive(config.door_joint, _DOOR_EFFORT, _DOOR_SPEED, _DOOR_ACCELERATION)
        self._steps: deque[tuple[str, float]] = deque()
        """What remains of the trip: "door" or "lift" with its target in m, or "wait"."""
        self._wait_until: int | None = None
        self.part.schedule(_RATE, before=self._control)

    def reset(self) -> None:
        super().reset()
        self._steps.clear()
        self._wait_until = None
        for drive in (self._lift, self._door):
            drive.target = 0.0
            drive.stop()

    def _drive(self, name: str, effort: float, speed: float, acceleration: float) -> _Drive:
        joint = self.part.joint(name, origin=self.origin)
        axis = next(each.axis for each in self.part.description.joints if each.name == name)
        motor = self.part.velocity_motor(name, max_effort=axis.effort or effort, origin=self.origin)
        low = -math.inf if axis.lower is None else axis.lower
        high = math.inf if axis.upper is None else axis.upper
        return _Drive(joint, motor, speed=speed, acceleration=acceleration, limits=(low, high))

    def travel(self, floor: int) -> None:
        """Starts a trip to a floor.

        Commands during a trip are ignored. Floors that do not exist cause a warning.
        """
        config = self._config
        lowest, highest = config.lowest_floor, config.highest_floor
        if lowest is not None and floor < lowest:
            self._refuse(floor, f"below the lowest floor {lowest}")
            return
        if highest is not None and floor > highest:
            self._refuse(floor, f"above the highest floor {highest}")
            return
        if self._steps:
            return
        height = floor * config.floor_height
        if self._lift.within(height) != height:
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: floor {floor} at {height:g} m is beyond the limits of the "
                "lift's joint",
                values={"floor": str(floor)},
            )
            return
        self._steps.extend(
            [
                ("door", 0.0),
                ("lift", height),
                ("door", self._door.within(_OPEN)),
                ("wait", 0.0),
                ("door", 0.0),
            ]
        )

    def _refuse(self, floor: int, fault: str) -> None:
        self.warn(
            running.COMMAND_IGNORED,
            f"a command is ignored: floor {floor} is {fault}",
            values={"floor": str(floor)},
        )

    def _control(self) -> None:
        if self._steps and self._completed(*self._steps[0]):
            self._steps.popleft()
        self._lift.control()
        self._door.control()

    def _completed(self, step: str, target: float) -> bool:
        if step == "wait":
            return self._waited()
        return (self._lift if step == "lift" else self._door).reached(target)

    def _waited(self) -> bool:
        now = self.part.time_ns
        if self._wait_until is None:
            self._wait_until = now + round(self._config.door_wait * 1e9)
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
        return abs(target - self._joint.position) <= 2 * _TOLERANCE and self._velocity == 0.0

    def stop(self) -> None:
        """Stops at the current position."""
        self._velocity = 0.0
        self._motor.command(0.0)

    def control(self) -> None:
        """Commands the velocity towards the target."""
        distance = self.target - self._joint.position
        if abs(distance) <= _TOLERANCE:
            self.stop()
            return
        self._velocity = next_velocity(
            self._velocity, distance, self._speed, self._acceleration, _RATE
        )
        self._motor.command(self._velocity)


def next_velocity(
    velocity: Number, distance: Number, max_speed: float, acceleration: float, rate: float
) -> Number:
    """Returns the highest velocity from which a joint can still stop at its target.

    Args:
        velocity: The present velocity, m/s.
        distance: Position of the target relative to the joint's position, m.
        max_speed: Maximum speed, m/s.
        acceleration: Maximum acceleration and deceleration, m/s².
        rate: Rate of the control loop, Hz.
    """
    allowed = minimum(max_speed, sqrt(2 * acceleration * abs(distance)))
    return copysign(minimum(abs(velocity) + acceleration / rate, allowed), distance)
