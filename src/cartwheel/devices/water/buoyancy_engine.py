"""A bladder with a variable volume, by which an underwater vehicle rises and sinks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.periodic import Elapsed
from cartwheel.devices.ramp import ramp
from cartwheel.messages import message_class

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True, slots=True)
class BuoyancyEngineConfig:
    link: str
    """Link on which the force acts."""
    command_topic: str
    """Topic of the volume (Float64), m³."""
    state_topic: str
    """Topic of the present volume (Float64), m³."""
    least: float
    """Smallest commanded volume, m³."""
    most: float
    """Largest commanded volume, m³."""
    neutral: float
    """Volume at which the force is 0, m³."""
    initial: float
    """m³."""
    rate: float
    """Largest change of the volume, m³/s."""
    density: float
    """Density of the fluid, kg/m³."""
    surface: float | None
    """Height from which on there is no fluid, m; None: the fluid fills the world."""


class BuoyancyEngine(Component):
    """Inflates the bladder as commanded, and applies the buoyancy that exceeds the neutral one.

    Source: BuoyancyEngine of gz-sim.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: BuoyancyEngineConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        self.reset()
        self.subscribe(config.command_topic, _FLOAT, self._on_command)
        self._state = self.advertise(config.state_topic, _FLOAT)
        self._Float64 = message_class(_FLOAT)
        part.schedule(0, before=self._apply)
        part.schedule(0, after=self._publish, topics=self.publishers)

    def reset(self) -> None:
        super().reset()
        self.volume = self._target = self._config.initial
        self._elapsed = Elapsed()

    def _on_command(self, message: Any) -> None:
        config = self._config
        self._target = min(max(float(message.data), config.least), config.most)

    def _apply(self) -> None:
        config = self._config
        seconds = self._elapsed.seconds(self.part.time_ns)
        self.volume = ramp(self.volume, self._target, config.rate * seconds)
        mass = -config.density * config.neutral
        if config.surface is None or self._height() < config.surface:
            mass += config.density * self.volume
        x, y, z = self._link.gravity
        self._wrench.apply((-mass * x, -mass * y, -mass * z), (0.0, 0.0, 0.0))

    def _height(self) -> float:
        self.part.locate()
        return self._link.place()[0][2]

    def _publish(self) -> None:
        self._state.publish(self._Float64(data=self.volume))
