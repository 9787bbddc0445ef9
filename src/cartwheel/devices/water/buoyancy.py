"""The buoyancy of a model in layers of fluids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.water.immersion import below
from cartwheel.geometry import Array, Quat, Vec3, matrix_from_quat, rotate
from cartwheel.simulation.dynamics.external_servos import WrenchHandle
from cartwheel.simulation.handles import LinkHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class Fluid:
    """Fluids in horizontal layers."""

    density: float
    """Density below the lowest surface, kg/m³."""
    layers: tuple[tuple[float, float], ...] = ()
    """Height of the surface at which each further fluid begins in m, and its density in kg/m³; in
    ascending order."""

    def densities(self) -> tuple[float, ...]:
        """The density of each fluid, from the lowest."""
        return (self.density, *(density for _, density in self.layers))


@dataclass(frozen=True, kw_only=True, eq=False)
class FloatingShape:
    """A shape that displaces fluid."""

    volume: float
    """m³."""
    centre: Vec3
    """Centre of the volume in the link, m."""
    corners: Array | None = None
    """Its surface in the link, which is cut where it crosses the surface of a fluid; shape
    (n, 3, 3), m. None: the whole shape is in the fluid at its centre."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FloatingLinkConfig:
    """A link that floats."""

    link: str
    shapes: tuple[FloatingShape, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class BuoyancyConfig:
    links: tuple[FloatingLinkConfig, ...]
    fluid: Fluid


@dataclass(kw_only=True, slots=True)
class _Floating:
    handle: LinkHandle
    wrench: WrenchHandle
    shapes: tuple[_Shape, ...]
    mass_centre: Vec3


@dataclass(kw_only=True, slots=True)
class _Shape:
    volume: float
    centre: Vec3
    corners: Array | None
    radius: float
    """Largest distance of a corner from the centre, m."""
    scale: float
    """The volume divided by that within the corners."""


class Buoyancy(Component):
    """Applies the weight of the displaced fluid to each link, upwards, at every step.

    Args:
        scope: The model.
        config: Links and fluids.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: BuoyancyConfig) -> None:
        super().__init__(scope)
        self._fluid = config.fluid
        self._densities = config.fluid.densities()
        self._links = [self._floating(each) for each in config.links]
        self.part.schedule(0, before=self._apply)

    def _floating(self, config: FloatingLinkConfig) -> _Floating:
        part = self.part
        handle = part.link(config.link, origin=self.origin)
        description = part.description.link(config.link)
        assert description is not None
        return _Floating(
            handle=handle,
            wrench=part.wrench(config.link, origin=self.origin),
            shapes=tuple(_prepared(shape) for shape in config.shapes),
            mass_centre=description.mass_centre,
        )

    def _apply(self) -> None:
        self.part.locate()
        for each in self._links:
            position, orientation = each.handle.place()
            mass, moment = 0.0, np.zeros(3)
            for shape in each.shapes:
                displaced, first = self._displaced(shape, position, orientation)
                mass += displaced
                moment += first
            # The moment is about the link's origin, in world axes.
            gx, gy, gz = each.handle.gravity
            cx, cy, cz = rotate(orientation, each.mass_centre)
            mx, my, mz = moment.tolist()
            mx, my, mz = mx - mass * cx, my - mass * cy, mz - mass * cz
            each.wrench.apply(
                (-mass * gx, -mass * gy, -mass * gz),
                (gy * mz - gz * my, gz * mx - gx * mz, gx * my - gy * mx),
            )

    def _displaced(self, shape: _Shape, position: Vec3, orientation: Quat) -> tuple[float, Array]:
        """Mass of the displaced fluid in kg, and its first moment about the link's origin in kg m,
        in world axes.
        """
        centre = np.array(rotate(orientation, shape.centre))
        height = position[2] + float(centre[2])
        surfaces = [surface for surface, _ in self._fluid.layers]
        crossed = [each for each in surfaces if abs(each - height) < shape.radius]
        if shape.corners is None or not crossed:
            mass = self._densities[sum(each <= height for each in surfaces)] * shape.volume
            return mass, mass * centre
        turned = shape.corners @ matrix_from_quat(orientation).T
        mass, moment = 0.0, np.zeros(3)
        lower, lower_moment = 0.0, np.zeros(3)
        first = surfaces.index(crossed[0])
        for index, surface in enumerate((*crossed, None)):
            if surface is None:
                upper, upper_moment = shape.volume, shape.volume * centre
            else:
                cut, cut_moment = below(turned, surface - position[2])
                upper, upper_moment = cut * shape.scale, cut_moment * shape.scale
            density = self._densities[first + index]
            mass += density * (upper - lower)
            moment += density * (upper_moment - lower_moment)
            lower, lower_moment = upper, upper_moment
        return mass, moment


def _prepared(shape: FloatingShape) -> _Shape:
    corners = shape.corners
    if corners is None:
        return _Shape(volume=shape.volume, centre=shape.centre, corners=None, radius=0.0, scale=1.0)
    whole, _ = below(corners, float(corners[:, :, 2].max()) + 1.0)
    return _Shape(
        volume=shape.volume,
        centre=shape.centre,
        corners=corners,
        radius=float(np.linalg.norm(corners - np.array(shape.centre), axis=2).max()),
        scale=shape.volume / whole if whole > 0 else 1.0,
    )
