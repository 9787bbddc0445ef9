"""Contacts and surroundings of the models in a world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from cartwheel.api.arguments import text
from cartwheel.api.running import RunningWorld
from cartwheel.api.surroundings import distances
from cartwheel.api.surroundings.contacts import Contact, contacts_between, selection
from cartwheel.api.surroundings.distances import Clearance, Hit
from cartwheel.api.surroundings.lights import Light, described_light
from cartwheel.api.surroundings.recorded_contacts import ContactRecord
from cartwheel.api.values import Vector, vector
from cartwheel.geometry import Vec3
from cartwheel.simulation.limits import numbers

if TYPE_CHECKING:
    from cartwheel.api.links import Link
    from cartwheel.api.model import Model
    from cartwheel.api.surroundings.distances import Places


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

    def record_contacts(
        self,
        between: str | Model | Link | Sequence[str | Model | Link] | None = None,
        *,
        ignore: Places = (),
    ) -> ContactRecord:
        """Observes contacts in each step from now on: when models touch, and with which force.

        Use it in a ``with`` block, or call `ContactRecord.close`. Models that are spawned later
        count if `between` is None, or by their names. After `reset` or `restore`, contacts that
        were observed before remain in the record.

        Args:
            between: As for `contacts`.
            ignore: Models and links whose contacts do not count, such as ``"ground_plane"``.

        Raises:
            UnknownNameError: A model or link does not exist.
            TypeError: `between` contains more than two models or links.
            SimulationError: The world is closed.
        """
        with self._used() as simulation:
            ignored = distances.among(simulation, ignore)
            return ContactRecord(simulation, selection(simulation, between, ignored))

    def ray(
        self,
        origin: Vector,
        direction: Vector,
        max_range: float = math.inf,
        *,
        ignore: Places = (),
    ) -> Hit | None:
        """What a ray hits first in the current state, without noise; None if it hits nothing.

        Rays hit collisions, not visuals. A ray that starts within a collision hits its far side.

        Args:
            origin: m, shape (3,), in the world.
            direction: Of any length above 0, shape (3,), in world axes.
            max_range: m.
            ignore: Models and links that the ray passes, such as the robot where it starts.

        Raises:
            CartwheelError: A number is out of range, or the direction is zero.
            UnknownNameError: A model or link does not exist.
        """
        with self.lock:
            return distances.ray(self.session.simulation, origin, direction, max_range, ignore)

    def clearance(
        self, one: Places, other: Places | None = None, *, ignore: Places = ()
    ) -> Clearance:
        """The shortest way between the surfaces of two models or links in the current state.

        Surfaces are those of the collisions. Meshes count as their convex hulls, or as the convex
        parts into which they are split.

        Args:
            one: A model or a link, or several.
            other: The same; None for all other models.
            ignore: Models and links that do not count, such as ``"ground_plane"``.

        Raises:
            CartwheelError: There are no two collisions, or only planes.
            UnknownNameError: A model or link does not exist.
        """
        with self.lock:
            return distances.clearance(self.session.simulation, one, other, ignore)

    def ground_height(self, x: float, y: float, *, below: float = math.inf) -> float:
        """Height of the highest surface that is fixed to the world, m; NaN without one.

        Args:
            x: m, in the world.
            y: m, in the world.
            below: Only surfaces below this height count, m, such as those under a roof.

        Raises:
            CartwheelError: A number is out of range.
        """
        with self.lock:
            return distances.ground_height(self.session.simulation, x, y, below)

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
        with self._used(change=True) as simulation:
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
