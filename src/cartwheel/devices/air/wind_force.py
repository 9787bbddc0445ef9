"""The force of wind and gusts on a link."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.contact.wrench import WRENCH_STAMPED, wrench_stamped
from cartwheel.geometry import Vec3, cross, rotate
from cartwheel.messages import header


@dataclass(frozen=True, kw_only=True, slots=True)
class WindForceConfig:
    link: str
    """Link on which the wind acts."""
    place: Vec3
    """Where it acts, from the centre of mass, along the axes of the link, m."""
    force: Vec3
    """Constant force in the world, N."""
    gust: Vec3
    """Additional force during the gust, in the world, N."""
    begin: float
    """Start of the gust, s."""
    end: float
    """End of the gust, s."""
    topic: str
    """Topic of the force (WrenchStamped); empty: not published."""
    frame: str
    """Frame ID of the messages."""


class WindForce(Component):
    """Applies the force of constant wind, and of one gust, to a link.

    Args:
        scope: The link's model and names.
        config: The forces.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: WindForceConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        self._frame = self.frame(config.frame)
        self._publisher = self.advertise(config.topic, WRENCH_STAMPED) if config.topic else None
        part.schedule(0, before=self._apply)

    def _apply(self) -> None:
        config = self._config
        now = self.part.time_ns * 1e-9
        force = np.array(config.force)
        if config.begin <= now < config.end:
            force = force + np.array(config.gust)
        self.part.locate()
        _, orientation = self._link.place()
        torque = cross(rotate(orientation, config.place), force)
        self._wrench.apply(force.tolist(), torque.tolist())
        if self._publisher is not None and self._publisher.wanted:
            moment = header(self.part.time_ns, self._frame)
            self._publisher.publish(wrench_stamped(moment, (*force, 0.0, 0.0, 0.0)))
