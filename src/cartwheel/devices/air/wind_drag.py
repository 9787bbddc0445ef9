"""The force of wind on the links of a model, in proportion to their masses."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from cartwheel.component import Component, Scope
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class Fluctuation:
    """How a quantity follows the wind that is stated."""

    rise: float = 1.0
    """Time constant, s."""
    amplitude: float = 0.0
    """Amplitude of a sine that is added."""
    period: float = 1.0
    """Period of the sine, s."""
    mean: float = 0.0
    deviation: float = 0.0
    """Mean and standard deviation of Gaussian noise that is added at each step."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WindDragConfig:
    links: tuple[str, ...]
    """Links on which the wind acts."""
    wind: Vec3
    """Velocity of the wind in the world, m/s."""
    factor: float
    """Force per mass and relative velocity, 1/s."""
    magnitude: Fluctuation = field(default_factory=Fluctuation)
    """Of the horizontal speed, m/s. The amplitude is a fraction of the speed."""
    direction: Fluctuation = field(default_factory=Fluctuation)
    """Of the horizontal direction, rad."""
    vertical: Fluctuation = field(default_factory=Fluctuation)
    """Of the vertical speed, m/s; without a sine."""


class WindDrag(Component):
    """Pulls links along with a wind that begins at time 0 and fluctuates.

    The force is the mass times the velocity of the wind relative to the link times a factor, at the
    end of the step, so it is stable at any factor. Source: WindEffects of gz-sim.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: WindDragConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        centres = {link.name: link.mass_centre for link in part.description.links}
        self._links = [
            (part.link(name, origin=origin), part.wrench(name, origin=origin), centres[name])
            for name in config.links
        ]
        self.reset()
        part.schedule(0, before=self._apply)

    def reset(self) -> None:
        super().reset()
        self._elapsed = Elapsed()
        self._speed = self._vertical = 0.0
        x, y, _ = self._config.wind
        self._direction = math.atan2(y, x)

    def _apply(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        wind = self._next(seconds)
        factor = self._config.factor / (1.0 + self._config.factor * seconds)
        self.part.locate()
        for link, wrench, centre in self._links:
            (vx, vy, vz), _ = link.motion_at(link.pose.apply(centre))
            push = link.mass * factor
            force = (push * (wind[0] - vx), push * (wind[1] - vy), push * (wind[2] - vz))
            wrench.apply(force, (0.0, 0.0, 0.0))

    def _next(self, seconds: float) -> Vec3:
        """The velocity of the wind after a step, m/s."""
        config, now = self._config, self.part.time_ns * 1e-9
        x, y, z = config.wind
        stated = math.hypot(x, y)
        self._speed += (stated - self._speed) * min(1.0, seconds / config.magnitude.rise)
        self._vertical += (z - self._vertical) * min(1.0, seconds / config.vertical.rise)
        noise = self.part.random("wind").standard_normal(3)
        speed = self._speed * (1.0 + _sine(config.magnitude, now))
        speed += config.magnitude.mean + config.magnitude.deviation * noise[0]
        direction = self._direction + _sine(config.direction, now)
        direction += config.direction.mean + config.direction.deviation * noise[1]
        up = self._vertical + config.vertical.mean + config.vertical.deviation * noise[2]
        return speed * math.cos(direction), speed * math.sin(direction), float(up)


def _sine(fluctuation: Fluctuation, now: float) -> float:
    return fluctuation.amplitude * math.sin(2 * math.pi * now / fluctuation.period)
