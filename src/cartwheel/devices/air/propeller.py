"""A propeller: its speed follows commands, and it applies forces and moments."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, clamp, copysign, where
from cartwheel.geometry import Array, rotate

ACTUATORS: Final = "mav_msgs/msg/Actuators"
GZ_ACTUATORS: Final = "actuator_msgs/msg/Actuators"
_SPEEDS = {ACTUATORS: "angular_velocities", GZ_ACTUATORS: "velocity"}
"""Field with the speeds of all propellers, by message type."""
_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class PropellerConfig:
    joint: str
    """Joint of the propeller, whose parent link receives the moments."""
    link: str
    """Link of the propeller. The thrust acts along its z axis."""
    counterclockwise: bool
    """Direction of rotation, seen from above."""
    driven: bool = True
    """Whether the propeller follows commands. If not, it applies no forces."""
    command_topic: str
    """Topic of the commands, with the speeds of all propellers in rad/s."""
    command_type: Literal["mav_msgs/msg/Actuators", "actuator_msgs/msg/Actuators"]
    """Message type of the commands."""
    number: int
    """Index of the propeller's speed in the commands."""
    max_speed: float
    """Maximum speed, rad/s."""
    rise_time: float
    """Time constant while the speed increases, s."""
    fall_time: float
    """Time constant while the speed decreases, s."""
    slowdown: float
    """Speed of the propeller divided by the speed of the joint."""
    thrust: float
    """Thrust divided by the square of the speed, N s²/rad²."""
    thrust_sign: Literal["direction", "joint", "up"]
    """The thrust is upwards if the propeller turns in its direction, if the joint's velocity is
    positive, or always."""
    max_airspeed: float | None = None
    """Axial airspeed at which the thrust becomes 0, m/s. None: no influence."""
    moment: float
    """Torque on the parent link divided by the thrust, m."""
    drag: float
    """Drag force divided by the speed and by the airspeed perpendicular to the axis, N s²/(m rad).
    """
    rolling: float
    """Rolling moment divided by the speed and by the airspeed perpendicular to the axis, N s²/rad.
    """


class Propeller(Component):
    """Turns a joint at the commanded speed. Applies thrust and drag to its link, and the torque and
    the rolling moment to the parent link.

    Args:
        scope: The propeller's model and names.
        config: Joint, commands and coefficients.

    Raises:
        UnknownNameError: The joint or link does not exist.
    """

    def __init__(self, scope: Scope, config: PropellerConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        description = part.description.joint(config.joint)
        self._joint = part.joint(config.joint, origin=origin)
        assert description is not None
        self._axis = rotate(description.pose.orientation, description.axis.xyz)
        self._link = part.link(config.link, origin=origin)
        self._force = part.wrench(config.link)
        self._torque = part.wrench(description.parent, origin=origin)
        self._sense = 1.0 if config.counterclockwise else -1.0
        self.reset()
        if config.driven:
            self._motor = part.velocity_motor(config.joint, max_effort=None)
            self.subscribe(config.command_topic, config.command_type, self._on_command)
            part.schedule(0, before=self._control)

    def reset(self) -> None:
        super().reset()
        self._target = self._speed = 0.0
        self._last_ns = self.part.time_ns

    def _on_command(self, message: Any) -> None:
        config = self._config
        speeds = getattr(message, _SPEEDS[config.command_type])
        if config.number >= len(speeds):
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: it has only {len(speeds)} speeds, so the speed of motor "
                f"{config.number} is missing",
                values={"speeds": len(speeds), "motor": config.number},
            )
            return
        self._target = min(float(speeds[config.number]), config.max_speed)

    def _control(self) -> None:
        config, part = self._config, self.part
        part.locate()
        _, orientation = self._link.place()
        force, torque = loads(
            config,
            speed=self._joint.velocity * config.slowdown,
            velocity=np.array(self._link.motion(local=False)[0]),
            axis=np.array(rotate(orientation, self._axis)),
            up=np.array(rotate(orientation, (0.0, 0.0, 1.0))),
        )
        self._force.apply(force.tolist(), _ZERO)
        self._torque.apply(_ZERO, torque.tolist())
        now = part.time_ns
        seconds, self._last_ns = (now - self._last_ns) * 1e-9, now
        self._speed = next_speed(
            self._speed, self._target, seconds, config.rise_time, config.fall_time
        )
        self._motor.command(self._sense * self._speed / config.slowdown)


def thrust_of(config: PropellerConfig, speed: Number, along: Number) -> tuple[Number, Number]:
    """Returns the thrust of a propeller.

    Args:
        config: The coefficients.
        speed: Velocity of the joint times the slowdown, rad/s.
        along: Velocity along the axis, m/s.

    Returns:
        The thrust along the link's z axis in N without the influence of the airspeed, and the
        fraction of it that remains.
    """
    thrust = copysign(speed * speed, speed) * config.thrust
    if config.thrust_sign == "direction" and not config.counterclockwise:
        thrust = -thrust
    elif config.thrust_sign == "up":
        thrust = abs(thrust)
    if config.max_airspeed is None:
        return thrust, 1.0
    return thrust, clamp(1 - abs(along) / config.max_airspeed, 0.0, 1.0)


def loads(
    config: PropellerConfig, *, speed: float, velocity: Array, axis: Array, up: Array
) -> tuple[Array, Array]:
    """Returns the loads of a propeller on the links.

    Args:
        config: The coefficients.
        speed: Velocity of the joint times the slowdown, rad/s.
        velocity: Velocity of the propeller's link in the world, m/s, shape (3,).
        axis: The joint's axis in the world, shape (3,).
        up: The link's z axis in the world, shape (3,).

    Returns:
        The force on the propeller's link, N, and the torque on the parent link, N m.
    """
    along = float(velocity @ axis)
    across = velocity - along * axis
    thrust, remaining = thrust_of(config, speed, along)
    sense = 1.0 if config.counterclockwise else -1.0
    force = remaining * thrust * up + -abs(speed) * config.drag * across
    torque = -sense * thrust * config.moment * up + -abs(speed) * config.rolling * across
    return force, torque


def next_speed(speed: Number, target: Number, seconds: float, rise: float, fall: float) -> Number:
    """Returns the speed after a time in s, as it approaches its target exponentially.

    Args:
        speed: The present speed, rad/s.
        target: The commanded speed, rad/s.
        seconds: The time.
        rise: Time constant while the target is larger than the speed, s; 0: at once.
        fall: Time constant otherwise, s.
    """
    fraction = where(target > speed, _covered(seconds, rise), _covered(seconds, fall))
    return speed + (target - speed) * fraction


def _covered(seconds: float, constant: float) -> float:
    """Fraction of the difference to the target that is covered in a time."""
    return -math.expm1(-seconds / constant) if constant > 0 else 1.0
