"""Random changes of a world for each episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from cartwheel.api.values import array, invalid
from cartwheel.batch.plan import AbsoluteVary
from cartwheel.codes.world import PROPERTY_ABSENT, VALUE_INVALID
from cartwheel.errors import CartwheelError, UnknownNameError
from cartwheel.geometry import Pose

if TYPE_CHECKING:
    from cartwheel.api import Link, World

Range = tuple[float, float]
_AXES = ("x", "y", "z", "roll", "pitch", "yaw")


class _Original:
    """The values of the files, because changes last until the next ones."""

    def __init__(self, world: World, name: str) -> None:
        model = world.model(name)
        masses = {each: model.link(each).mass for each in model.links}
        self.masses = {each: mass for each, mass in masses.items() if mass > 0}
        self.colliding = [each for each in model.links if _collides(model.link(each))]
        self.dampings = {each: model.joints[each].damping for each in model.joints.names}
        efforts = {each: model.joints[each].effort_limit for each in model.joints.names}
        self.efforts = {each: effort for each, effort in efforts.items() if effort is not None}
        self.lights = {each: world.light(each).intensity for each in world.lights}


def _collides(link: Link) -> bool:
    try:
        return bool(link.friction)
    except CartwheelError as error:
        if error.code is PROPERTY_ABSENT:
            return False
        raise


@dataclass(frozen=True, eq=False)
class Variation(AbsoluteVary):
    """Changes a model and the light by uniformly distributed random numbers; see `vary`."""

    model: str
    pose: Mapping[str, Range]
    mass: Range | None = None
    friction: Range | None = None
    damping: Range | None = None
    effort: Range | None = None
    light: Range | None = None
    _originals: Any = field(default_factory=WeakKeyDictionary, repr=False)

    def __call__(self, world: World, random: np.random.Generator) -> None:
        """Changes a world.

        Raises:
            UnknownNameError: The model does not exist.
            CartwheelError: A value is not possible.
        """
        model = world.model(self.model)
        original = self._original(world)
        if self.mass is not None:
            factor = random.uniform(*self.mass)
            for name, mass in original.masses.items():
                model.link(name).mass = mass * factor
        if self.friction is not None:
            friction = random.uniform(*self.friction)
            for name in original.colliding:
                model.link(name).friction = friction
        if self.damping is not None:
            factor = random.uniform(*self.damping)
            for name, damping in original.dampings.items():
                model.joints[name].damping = damping * factor
        if self.effort is not None:
            factor = random.uniform(*self.effort)
            for name, effort in original.efforts.items():
                model.joints[name].effort_limit = effort * factor
        if self.light is not None:
            factor = random.uniform(*self.light)
            for name, intensity in original.lights.items():
                world.light(name).intensity = intensity * factor
        if self.pose:
            old = dict(zip(_AXES, (*model.pose.position, *model.pose.rpy), strict=True))
            new = {
                axis: random.uniform(*self.pose[axis]) if axis in self.pose else old[axis]
                for axis in _AXES
            }
            model.pose = Pose.from_xyz_rpy(
                (new["x"], new["y"], new["z"]), (new["roll"], new["pitch"], new["yaw"])
            )

    def _original(self, world: World) -> _Original:
        if world not in self._originals:
            self._originals[world] = _Original(world, self.model)
        found: _Original = self._originals[world]
        return found

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_originals": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _originals=WeakKeyDictionary())


def vary(
    model: str,
    *,
    mass: Range | None = None,
    friction: Range | None = None,
    damping: Range | None = None,
    effort: Range | None = None,
    light: Range | None = None,
    pose: Mapping[str, Range] | None = None,
) -> Variation:
    """Domain randomization: changes of a model for each episode.

    Each argument is a range from which a number is drawn.

    Args:
        model: Name of the model.
        mass: Factor on the masses of all links.
        friction: Friction coefficient of all links.
        damping: Factor on the damping of all joints.
        effort: Factor on the effort limits of all joints, which is the strength of their motors.
        light: Factor on the intensity of all lights.
        pose: Coordinates of the model, m and rad, such as ``{"x": (-1, 1), "yaw": (-3.1, 3.1)}``.

    Raises:
        CartwheelError: A range is not two finite numbers, the smaller one first, or a coordinate is
            unknown.
    """
    factors = {
        "mass": mass,
        "friction": friction,
        "damping": damping,
        "effort": effort,
        "light": light,
    }
    places = dict(pose or {})
    for axis in places:
        if axis not in _AXES:
            raise UnknownNameError("coordinate", axis, _AXES, code=VALUE_INVALID)
    for name, limits in (factors | places).items():
        if limits is not None:
            _check_range(name, limits)
    return Variation(model, places, **factors)


def _check_range(name: str, limits: Any) -> None:
    low, high = array(limits, (2,), name).tolist()
    if low > high:
        error = invalid(name, "must be a range with the smaller number first", limits)
        error.hint = f"Write ({high:g}, {low:g})."
        raise error
