"""MuJoCo specs: the options of a world, compilation, and the compiler's errors."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Sequence

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Origin, WorldError
from cartwheel.world import contact
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.lights import add_light

DEFAULT_STEP = 0.005
"""s; see ``docs/physics.md`` for the reasons."""

_SLOWEST = 0.05
"""Speed below which a body is at rest, per time step, m/s². A body sleeps after ten steps below it,
so one that accelerates from rest by more than a tenth of this value does not sleep. It is above the
0.04 mm/s at which the bricks of the world ``rubble`` creep, down to a time step of 1 ms.
"""
_MOST_AMBIENT = 0.4
"""SDF's default. Worlds for new Gazebo state 1, which Gazebo's renderer dims; here it would leave
no shading.
"""
_CELLS = 100
"""Maximum grid cells on each side of a plane's centre."""
_LEAST_CELL = 0.2
"""Minimum size of a grid cell, m."""


def step_of(world: WorldDescription, entries: Iterable[ModelEntry] = ()) -> float:
    """The step length in s, from the world, or else the default or what its models need."""
    stated = world.physics.max_step_size
    return stated or min((DEFAULT_STEP, *(entry.longest_step for entry in entries)))


def empty_spec(world: WorldDescription, step: float) -> mujoco.MjSpec:
    """A spec with the options, sky and lights of a world, but without models."""
    spec = mujoco.MjSpec()
    spec.modelname = world.name
    spec.compiler.degree = False
    spec.compiler.autolimits = False
    spec.compiler.boundmass = 0
    spec.option.timestep = step
    spec.option.gravity = list(world.gravity)
    # Solves motors and contacts in one system. The other implicit integrators damp a servo only
    # after the contacts were solved without it, so a driven wheel slips by the difference.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    # This integrator includes damping in its system; mj_Euler, which completes a step after the
    # state was read, would apply the damping twice.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = contact.FRICTION_IMPEDANCE_RATIO
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    spec.option.sleep_tolerance = _SLOWEST * step
    # Keeps lengths that MuJoCo scales by the model's extent in metres.
    spec.stat.extent = 1.0
    # The laser_retro of a geom.
    spec.nuser_geom = 1
    spec.visual.global_.offwidth = 16
    spec.visual.global_.offheight = 16
    # Multisampling and shadows would be most of the cost in a software renderer.
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    ambient = [min(value, _MOST_AMBIENT) for value in world.ambient[:3]]
    spec.visual.headlight.ambient = ambient
    # A weak headlight keeps the shape of faces visible that point away from the sun.
    spec.visual.headlight.diffuse = [0.25, 0.25, 0.25]
    spec.visual.headlight.specular = [0, 0, 0]
    sky = list(world.background[:3])
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=sky,
        rgb2=sky,
        width=1,
        height=6,
    )
    for light in world.lights:
        add_light(spec.worldbody, light.name, light)
    return spec


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compiles a spec without MuJoCo's warnings.

    Raises:
        ValueError: The spec cannot be compiled.
        mujoco.FatalError: As `ValueError`.
    """
    with warnings.catch_warnings():
        # The engine counts the same warnings at run time, and the simulation reports them.
        warnings.simplefilter("ignore", UserWarning)
        return spec.compile()


def divide_floors(model: mujoco.MjModel) -> None:
    """Splits planes into many cells in worlds with lamps: lighting is computed at cell corners.

    Sunlight is uniform, so one cell is enough for it.
    """
    if (model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL).all():
        return
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    half = model.geom_size[planes, :2].max(axis=1)
    model.geom_size[planes, 2] = np.maximum(half / _CELLS, _LEAST_CELL)


def compile_error(message: str, entries: Sequence[ModelEntry]) -> WorldError:
    """The error for a message of MuJoCo's compiler, at the origin of the named element.

    Only this function parses the compiler's messages.
    """
    text = message.splitlines()[0].removeprefix("Error: ")
    for entry in entries:
        for link in entry.description.links:
            named: list[tuple[str, Origin]] = [(scoped(entry.name, link.name), link.origin)]
            named += [(scoped(entry.name, link.name, c.name), c.origin) for c in link.collisions]
            for name, origin in reversed(named):
                if re.search(rf"'{re.escape(name)}'", message):
                    return _refused(entry, text, origin)
        for joint in entry.description.joints:
            if re.search(rf"'{re.escape(scoped(entry.name, joint.name))}'", message):
                return _refused(entry, text, joint.origin)
    newest = entries[-1] if entries else None
    return _refused(newest, text, newest.description.origin if newest else None)


def _refused(entry: ModelEntry | None, text: str, origin: Origin | None) -> WorldError:
    model = f'model "{entry.name}"' if entry else "the world"
    return WorldError(
        f"{model} cannot be simulated: {text}",
        code=world_codes.MODEL_NOT_BUILT,
        origin=origin,
        values={"model": entry.name if entry else "", "reason": text},
    )
