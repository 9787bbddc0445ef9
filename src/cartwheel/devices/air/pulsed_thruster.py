"""A thruster that a valve switches on and off, such as one of a spacecraft."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.air.propeller import GZ_ACTUATORS
from cartwheel.geometry import rotate

_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class PulsedThrusterConfig:
    link: str
    """Link of the nozzle. The thrust acts at its centre of mass, along its z axis."""
    topic: str
    """Topic of the commands (Actuators), whose `normalized` contains the duty cycles from 0 to 1.
    """
    number: int
    """Index of the duty cycle in the commands."""
    thrust: float
    """Thrust while the valve is open, N."""
    frequency: float
    """Number of pulses in a second, Hz."""


class PulsedThruster(Component):
    """Applies the thrust of a valve that opens at the beginning of each cycle.

    Each pulse has the commanded length, whatever the length of a step: a step during which the
    valve closes has a smaller force.

    Args:
        scope: The model.
        config: Link, topic and thrust.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: PulsedThrusterConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._link = part.link(config.link, origin=self.origin)
        self._wrench = part.wrench(config.link, origin=self.origin)
        self.reset()
        self.subscribe(config.topic, GZ_ACTUATORS, self._on_command)
        part.schedule(0, before=self._control, active=lambda: self._duty > 0.0 or self._pushes)

    def reset(self) -> None:
        super().reset()
        self._duty = 0.0
        self._pushes = False

    def _on_command(self, message: Any) -> None:
        duties, number = message.normalized, self._config.number
        if number >= len(duties):
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: it has only {len(duties)} duty cycles, so that of thruster "
                f"{number} is missing",
                values={"duties": len(duties), "thruster": number},
            )
            return
        duty = float(duties[number])
        self._duty = min(max(duty, 0.0), 1.0) if math.isfinite(duty) else 0.0

    def _control(self) -> None:
        part, config = self.part, self._config
        start, length = part.time_ns * 1e-9, part.period_ns(0) * 1e-9
        share = open_share(start, length, 1.0 / config.frequency, self._duty)
        self._pushes = share > 0.0
        part.locate()
        _, orientation = self._link.place()
        self._wrench.apply(rotate(orientation, (0.0, 0.0, config.thrust * share)), _ZERO)


def open_share(start: float, length: float, period: float, duty: float) -> float:
    """Returns the part of a step during which a valve is open, from 0 to 1.

    Args:
        start: Time at the beginning of the step, s.
        length: Length of the step, s.
        period: Length of a cycle, s. Cycles begin at time 0.
        duty: Part of each cycle during which the valve is open.
    """

    def opened(time: float) -> float:
        cycles = math.floor(time / period)
        return (cycles * duty + min(time / period - cycles, duty)) * period

    return min(max((opened(start + length) - opened(start)) / length, 0.0), 1.0)
