"""The four motors and propellers of a quadrotor, which are driven by voltages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.contact.wrench import wrench_stamped
from cartwheel.devices.periodic import Elapsed, Periodic
from cartwheel.geometry import Vec3, rotate
from cartwheel.messages import header, message_class

_COUNT = 4
_PLACES = ((1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0))
"""x and y of the propellers, as multiples of the arm: front, right, back, left."""
_SENSES = (1.0, -1.0, 1.0, -1.0)
"""Direction of the torque of each motor on the body, about z."""
_STEPS = 255
"""Largest duty cycle in the messages."""
_FASTEST = 100.0
"""Largest velocity that enters the model, m/s or rad/s, as in the original plugin."""
_TURNS = 1.0
"""Speed above which a motor counts as running, rad/s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PropulsionModel:
    """Coefficients of a motor and its propeller. The defaults are those of the motor Roxxy 2827-34
    with a propeller of 10 x 4.5 inches. Source: hector_quadrotor_model.
    """

    k_m: float = -7.011631909766668e-5
    """Friction torque per speed, N m s/rad."""
    k_t: float = 0.015336864714397
    """Torque of the propeller per thrust, m."""
    CT0s: float = 1.538190483976698e-5
    """Thrust per square of the speed, N s²/rad²."""
    CT1s: float = -2.5224e-4
    """Thrust per speed and upward velocity, N s²/(m rad)."""
    CT2s: float = 0.0
    """Thrust per square of the upward velocity, N s²/m²."""
    Psi: float = 0.007242179827506
    """Torque per current, N m/A, and voltage per speed, V s/rad."""
    J_M: float = 2.573048063300000e-5
    """Moment of inertia of motor and propeller, kg m²."""
    R_A: float = 0.201084219222241
    """Resistance, Ohm."""
    alpha_m: float = 0.104863758313889
    """Part of the current that does not depend on the speed, A."""
    beta_m: float = 0.549262344777900
    """Part of the voltage that acts on the motor."""
    l_m: float = 0.275
    """Distance of the propellers from the centre, m."""

    def thrust(self, speed: float, upward: float) -> float:
        """Returns the thrust in N at a speed in rad/s and an upward velocity in m/s."""
        return (
            self.CT0s * speed * speed
            + self.CT1s * upward * speed
            - math.copysign(self.CT2s, upward) * upward * upward
        )

    def current(self, voltage: float, speed: float) -> float:
        """Returns the current in A at a voltage in V and a speed in rad/s."""
        half = (voltage * self.beta_m - self.Psi * speed) / (2 * self.R_A)
        return half + math.sqrt(max(0.0, half * half + voltage * self.alpha_m / self.R_A))

    def next_speed(self, speed: float, torque: float, thrust: float, seconds: float) -> float:
        """Returns the speed after a time in s, given the motor's torque and the thrust."""
        load = self.k_t * thrust + self.k_m * speed
        return max(0.0, speed + seconds / self.J_M * (torque - load))


@dataclass(frozen=True, kw_only=True, slots=True)
class QuadrotorPropulsionConfig:
    """Configuration of a `QuadrotorPropulsion`. An empty topic is not used."""

    link: str
    """Link on which the propellers act, at its origin."""
    frame: str
    """Frame ID of the messages."""
    model: PropulsionModel
    supply: float
    """Voltage of the supply, V."""
    command_topic: str
    """Topic of the voltages (MotorCommand)."""
    pwm_topic: str
    """Topic of the duty cycles (MotorPWM)."""
    status_topic: str
    """Topic of the motors' states (MotorStatus)."""
    status_rate: float
    """Rate of the states, Hz; 0: every step."""
    supply_topic: str
    """Topic of the supply's voltage (Supply), once per second."""
    wrench_topic: str
    """Topic of the force and the torque (WrenchStamped)."""


class QuadrotorPropulsion(Component):
    """Applies the thrusts and torques of four propellers to a link.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: QuadrotorPropulsionConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        description = part.description.link(config.link)
        assert description is not None
        self._centre = description.mass_centre
        self._frame = self.frame(config.frame)
        self._types = {
            name: message_class(f"hector_uav_msgs/msg/{name}") for name in ("MotorStatus", "Supply")
        }
        self._publishers = {
            name: self.advertise(topic, f"{package}/msg/{name}")
            for name, package, topic in (
                ("MotorStatus", "hector_uav_msgs", config.status_topic),
                ("Supply", "hector_uav_msgs", config.supply_topic),
                ("WrenchStamped", "geometry_msgs", config.wrench_topic),
            )
            if topic
        }
        if config.command_topic:
            self.subscribe(
                config.command_topic, "hector_uav_msgs/msg/MotorCommand", self._on_command
            )
        if config.pwm_topic:
            self.subscribe(config.pwm_topic, "hector_uav_msgs/msg/MotorPWM", self._on_pwm)
        self.reset()
        part.schedule(0, before=self._control)

    def reset(self) -> None:
        super().reset()
        self._voltages = [0.0] * _COUNT
        self._speeds = [0.0] * _COUNT
        self._currents = [0.0] * _COUNT
        self._on = False
        self._elapsed = Elapsed()
        self._status_due, self._supply_due = Periodic(self._config.status_rate), Periodic(1.0)

    def _on_command(self, message: Any) -> None:
        supply = self._config.supply
        # As in the original plugin, voltages become duty cycles of 8 bits.
        self._drive([_STEPS * float(each) / supply for each in message.voltage])

    def _on_pwm(self, message: Any) -> None:
        self._drive([float(each) for each in message.pwm])

    def _drive(self, cycles: Sequence[float]) -> None:
        """Switches the motors on with duty cycles from 0 to 255."""
        if len(cycles) < _COUNT:
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: it must contain {_COUNT} motors (got {len(cycles)})",
                values={"motors": len(cycles)},
            )
            return
        self._on = True
        self._voltages = [
            min(max(round(each), 0), _STEPS) * self._config.supply / _STEPS
            for each in cycles[:_COUNT]
        ]

    def _control(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        self.part.locate()
        force, torque = self._step(seconds)
        _, orientation = self._link.place()
        # The force acts at the link's origin.
        cx, cy, _ = self._centre
        x, y, z = torque
        self._wrench.apply(
            rotate(orientation, (0.0, 0.0, force)),
            rotate(orientation, (x - cy * force, y + cx * force, z)),
        )
        self._publish(force, torque)

    def _step(self, seconds: float) -> tuple[float, Vec3]:
        """Returns the force along z and the torque, and advances the motors by a time in s."""
        model = self._config.model
        (_, _, vz), (wx, wy, _) = (
            [min(max(each, -_FASTEST), _FASTEST) for each in vector]
            for vector in self._link.motion(local=True)
        )
        force = about_x = about_y = about_z = 0.0
        for index, ((x, y), sense) in enumerate(zip(_PLACES, _SENSES, strict=True)):
            x, y, speed = model.l_m * x, model.l_m * y, self._speeds[index]  # noqa: PLW2901
            thrust = model.thrust(speed, vz + wx * y - wy * x)
            current = model.current(self._voltages[index], speed)
            torque = model.Psi * current
            self._currents[index] = current
            self._speeds[index] = model.next_speed(speed, torque, thrust, seconds)
            force += thrust
            about_x += y * thrust
            about_y -= x * thrust
            about_z += sense * torque
        return force, (about_x, about_y, about_z)

    def _publish(self, force: float, torque: Vec3) -> None:
        now = self.part.time_ns
        head, offered = header(now, self._frame), self._publishers
        status, supply, wrench = (
            offered.get(name) for name in ("MotorStatus", "Supply", "WrenchStamped")
        )
        if self._status_due.due(now) and status is not None and status.wanted:
            numbers = [
                np.array(each, dtype=np.float32)
                for each in (self._voltages, self._speeds, self._currents)
            ]
            turns = all(speed > _TURNS for speed in self._speeds)
            status.publish(self._types["MotorStatus"](head, self._on, turns, *numbers))
        if self._supply_due.due(now) and supply is not None and supply.wanted:
            voltage = np.array([self._config.supply], dtype=np.float32)
            none = np.zeros(0, dtype=np.float32)
            supply.publish(self._types["Supply"](head, voltage, none))
        if wrench is not None and wrench.wanted:
            wrench.publish(wrench_stamped(head, (0.0, 0.0, force, *torque)))
