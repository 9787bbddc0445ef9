"""The lights of a world."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from cartwheel.api.handles import Handle
from cartwheel.api.properties.appearance import Colour, rgba
from cartwheel.api.values import Vector, flag, invalid, scalar, vector
from cartwheel.codes.graph import ENTITY_UNKNOWN
from cartwheel.description.model import Light as LightDescription
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Pose, Vec3, quat_conjugate, rotate

if TYPE_CHECKING:
    from cartwheel.api.surroundings.surroundings import SurroundingWorld
    from cartwheel.simulation import Simulation


class Light(Handle):
    """A handle to a light in a world. `World.light` returns it.

    Changes affect the images of cameras from then on. `World.reset` keeps them. Two handles are
    equal if they belong to the same world and have the same name.
    """

    __slots__ = ("_world", "name")

    def __init__(self, world: SurroundingWorld, name: str) -> None:
        self._world = world
        self.name = name
        """Name in the world."""

    def __repr__(self) -> str:
        return f"Light({self.name!r})"

    @property
    def _identity(self) -> tuple[SurroundingWorld, str]:
        return self._world, self.name

    @property
    def type(self) -> str:
        """``directional``, ``point`` or ``spot``."""
        return self._described.type

    @property
    def color(self) -> Vec3:
        """Red, green and blue, each 0 to 1."""
        r, g, b, _ = self._described.diffuse
        return r, g, b

    @color.setter
    def color(self, color: Colour) -> None:
        self._change(diffuse=rgba(color, "color"))

    @property
    def intensity(self) -> float:
        """Factor on the colour, at least 0."""
        return self._described.intensity

    @intensity.setter
    def intensity(self, intensity: float) -> None:
        self._change(intensity=scalar(intensity, "intensity", least=0.0))

    @property
    def on(self) -> bool:
        """Whether it shines."""
        return self._described.on

    @on.setter
    def on(self, on: bool) -> None:
        self._change(on=flag(on, "on"))

    @property
    def position(self) -> Vec3:
        """m, in the world; without effect on a directional light."""
        return self._described.pose.position

    @position.setter
    def position(self, position: Vector) -> None:
        turn = self._described.pose.orientation
        self._change(pose=Pose(vector(position, "position"), turn))

    @property
    def direction(self) -> Vec3:
        """The direction in which it shines, in world axes; without effect on a point light."""
        light = self._described
        return rotate(light.pose.orientation, light.direction)

    @direction.setter
    def direction(self, direction: Vector) -> None:
        wanted = vector(direction, "direction")
        if not any(wanted):
            raise invalid("direction", "must not be zero", direction)
        turn = self._described.pose.orientation
        self._change(direction=rotate(quat_conjugate(turn), wanted))

    @property
    def _described(self) -> LightDescription:
        with self._world.lock:
            return described_light(self._world.session.simulation, self.name)

    def _change(self, **values: object) -> None:
        with self._world._used(change=True) as simulation:
            light = described_light(simulation, self.name)
            changed = replace(light, **values)  # type: ignore[arg-type]
            lights = (changed if each is light else each for each in simulation.world.lights)
            simulation.change_world(replace(simulation.world, lights=tuple(lights)))


def described_light(simulation: Simulation, name: str) -> LightDescription:
    """The description of a light.

    Raises:
        UnknownNameError: The world does not have the light.
    """
    lights = {light.name: light for light in simulation.world.lights}
    if name not in lights:
        raise UnknownNameError("light", name, lights, code=ENTITY_UNKNOWN)
    return lights[name]
