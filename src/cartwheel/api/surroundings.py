"""Contacts and surroundings of the models in a world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from cartwheel.api.arguments import text
from cartwheel.api.contacts import Contact, contacts_between
from cartwheel.api.lights import Light, described_light
from cartwheel.api.running import RunningWorld
from cartwheel.api.values import Vector, vector
from cartwheel.geometry import Vec3
from cartwheel.simulation.limits import numbers

if TYPE_CHECKING:
    from cartwheel.api.links import Link
    from cartwheel.api.model import Model


class SurroundingWorld(RunningWorld):
    """The part of `World` with the exact state of all models together."""

    def contacts(
        self, between: str | Model | Link | Sequence[str | Model | Link] | None = None
    ) -> tuple[Contact, ...]:
        """The contacts in the current state.

        A model that rests on another one usually has several contacts with it. Links that are
        connected by a joint have none, and neither have links of one model without self-collision.

        Args:
            between: A model or a link: its contacts with everything, with its links as the first
                ones. Two of them: the contacts between both, in this order. Each is a `Model`, a
                `Link`, a model's name, or a link's name such as ``cart::wheel``. None: all contacts
                in the world.

        Raises:
            UnknownNameError: A model or link does not exist.
            TypeError: `between` contains more than two models or links.
        """
        with self.lock:
            return contacts_between(self.session.simulation, between)

    @property
    def gravity(self) -> Vec3:
        """Acceleration of free fall, m/s², in world axes. Setting it wakes all bodies.

        Raises:
            CartwheelError: There are not three finite numbers.
            SimulationError: The world is closed.
        """
        with self.lock:
            return self.session.simulation.world.gravity

    @gravity.setter
    def gravity(self, gravity: Vector) -> None:
        pull = vector(gravity, "gravity")
        numbers(pull, "gravity")
        with self.used(change=True) as simulation:
            simulation.change_world(replace(simulation.world, gravity=pull))

    @property
    def lights(self) -> tuple[str, ...]:
        """Names of the lights."""
        with self.lock:
            return tuple(light.name for light in self.session.simulation.world.lights)

    def light(self, name: str) -> Light:
        """A handle to a light.

        Raises:
            UnknownNameError: The light does not exist.
        """
        with self.lock:
            described_light(self.session.simulation, text(name, "name"))
        return Light(self, name)
