"""The properties of a link that a program can change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from cartwheel.api.handles import Handle
from cartwheel.api.properties.appearance import (
    Colour,
    Texture,
    colour_of,
    coloured,
    image_of,
    rgba,
    texture_of,
    textured,
)
from cartwheel.api.properties.inertials import (
    inertia_of,
    inertial_of,
    naming,
    with_centre,
    with_inertia,
    with_mass,
)
from cartwheel.api.properties.surfaces import (
    friction_of,
    restitution_of,
    with_friction,
    with_restitution,
)
from cartwheel.api.values import Vector, flag
from cartwheel.description.model import Link as Description
from cartwheel.description.model import Rgba, RobotDescription
from cartwheel.geometry import Array, Vec3

if TYPE_CHECKING:
    from cartwheel.api.world import World
    from cartwheel.simulation import Simulation

T = TypeVar("T")


class LinkProperties(Handle):
    """The properties of a link, which `World.reset` keeps."""

    __slots__ = ()

    model: str
    name: str
    _world: World

    @property
    def mass(self) -> float:
        """Mass, kg. Setting it does not change the inertia.

        Raises:
            CartwheelError: The mass is not a positive number, or the link has no inertial.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        inertial = self._described.inertial
        return 0.0 if inertial is None else inertial.mass

    @mass.setter
    def mass(self, mass: float) -> None:
        self._change(lambda link: with_mass(link, mass))

    @property
    def inertia(self) -> Array:
        """Inertia matrix about the centre of mass in the link's axes, kg m², shape (3, 3).

        Raises:
            CartwheelError: The matrix is not symmetric, no body can have it, or the link has no
                inertial.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return self._read(inertia_of)

    @inertia.setter
    def inertia(self, inertia: Sequence[Sequence[float]] | Array) -> None:
        self._change(lambda link: with_inertia(link, inertia))

    @property
    def center_of_mass(self) -> Vec3:
        """Centre of mass in the link's frame, m.

        Raises:
            CartwheelError: There are not three finite numbers, or the link has no inertial.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return self._read(inertial_of).pose.position

    @center_of_mass.setter
    def center_of_mass(self, centre: Vector) -> None:
        self._change(lambda link: with_centre(link, centre))

    @property
    def friction(self) -> tuple[float, float]:
        """The friction coefficients mu and mu2 of the first collision.

        A single number sets both, for all collisions. Of two surfaces in contact, the smaller
        coefficient counts, and coefficients above 100 count as 100.

        Raises:
            CartwheelError: A coefficient is negative or not finite, or the link has no collision.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return self._read(friction_of)

    @friction.setter
    def friction(self, friction: float | Sequence[float]) -> None:
        self._change(lambda link: with_friction(link, friction))

    @property
    def restitution(self) -> float:
        """The coefficient of restitution of the first collision, from 0 to 1.

        A single number sets it for all collisions. Two surfaces bounce if both have a coefficient,
        and the smaller one counts. If the description states no threshold, each impact bounces that
        is faster than what gravity adds in two steps.

        Raises:
            CartwheelError: The coefficient is not a number from 0 to 1, or the link has no
                collision.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return self._read(restitution_of)

    @restitution.setter
    def restitution(self, restitution: float) -> None:
        self._change(lambda link: with_restitution(link, restitution))

    @property
    def gravity(self) -> bool:
        """Whether gravity acts on the link.

        Raises:
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return self._described.gravity

    @gravity.setter
    def gravity(self, gravity: bool) -> None:
        on = flag(gravity, "gravity")
        self._change(lambda link: replace(link, gravity=on))

    @property
    def color(self) -> Rgba | None:
        """Colour of the first visual: red, green, blue and alpha, each 0 to 1.

        None without a visual, or if the visual has the colours of a mesh. Setting it removes
        textures; the alpha of a colour without one is 1.

        Raises:
            CartwheelError: There are not three or four numbers from 0 to 1.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return colour_of(self._described)

    @color.setter
    def color(self, color: Colour) -> None:
        colour = rgba(color, "color")
        self._change(lambda link: coloured(link, colour))

    @property
    def texture(self) -> Path | bytes | None:
        """Image of the first visual: a file, or the contents of one; None without an image.

        It is set as an image file, or as an array of shape (height, width, 3), uint8, RGB, and
        covers all visuals. Meshes require texture coordinates. The next image of a camera takes
        longer, because the visuals are compiled again.

        Raises:
            CartwheelError: The file does not exist, or the array is not an image.
            UnknownNameError: The model or the link does not exist any more.
            SimulationError: The world is closed.
        """
        return texture_of(self._described)

    @texture.setter
    def texture(self, texture: Texture) -> None:
        image = image_of(texture)
        self._change(lambda link: textured(link, image))

    @property
    def _described(self) -> Description:
        with self._world.lock:
            return self._find(self._world.session.simulation)[1]

    def _find(self, simulation: Simulation) -> tuple[RobotDescription, Description]:
        """The descriptions of the model and of the link."""
        simulation.truth.link(self.model, self.name)
        description = simulation.truth.description(self.model)
        link = description.link(self.name)
        assert link is not None
        return description, link

    def _read(self, read: Callable[[Description], T]) -> T:
        with self._world.lock:
            description, link = self._find(self._world.session.simulation)
            with naming(description.links):
                return read(link)

    def _change(self, change: Callable[[Description], Description]) -> None:
        with self._world._used(change=True) as simulation:
            description, link = self._find(simulation)
            with naming(description.links):
                changed = change(link)
            if changed != link:
                links = tuple(changed if each is link else each for each in description.links)
                simulation.redescribe(self.model, replace(description, links=links))
