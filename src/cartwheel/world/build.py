"""A world description and the models that stand in it, compiled."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

import mujoco

from cartwheel.description.model import Light, WorldDescription
from cartwheel.errors import Origin, WorldError
from cartwheel.geometry import rotate
from cartwheel.world import contact
from cartwheel.world.bodies import BodyBuilder
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.shapes import Assets

DEFAULT_STEP = 0.005
"""s; see ``docs/physics.md`` for how it was chosen."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Build:
    """A compiled world."""

    model: mujoco.MjModel
    xml: str | None = None


def step_of(world: WorldDescription) -> float:
    """The step length in s: the world's own, or the default."""
    return world.physics.max_step_size or DEFAULT_STEP


def build(world: WorldDescription, entries: Iterable[ModelEntry], *, xml: bool = False) -> Build:
    """Compiles a world.

    Args:
        world: Gravity, lights, physics.
        entries: The models in it, the world's own among them.
        xml: Also write the model as MJCF.

    Raises:
        WorldError: A model cannot be built; with the place in its file where it is known.
    """
    spec = _empty(world)
    bodies = BodyBuilder(spec, Assets(spec), spec.option.timestep)
    entries = list(entries)
    for entry in entries:
        bodies.add(entry)
    if any(_feels_touch(entry) for entry in entries if entry.description.static):
        # A body asleep on something that stands has no contact with it to be reported.
        spec.option.enableflags &= ~mujoco.mjtEnableBit.mjENBL_SLEEP.value
    ranks = contact.priorities(surface.friction[0] for surface in bodies.surfaces)
    for surface in bodies.surfaces:
        surface.geom.priority = ranks[surface.friction[0]]
    for still, mover, rules in contact.standing_pairs(bodies.surfaces):
        sliding, torsional, rolling = rules.friction
        spec.add_pair(
            geomname1=still.name,
            geomname2=mover.name,
            condim=3,
            friction=[sliding, sliding, torsional, rolling, rolling],
            solref=list(rules.reference),
            solreffriction=[contact.FRICTION_TIME_CONSTANT, 1.0],
            solimp=list(contact.IMPEDANCE),
        )
    try:
        model = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise _explain(str(error), entries) from None
    return Build(model=model, xml=spec.to_xml() if xml else None)


def _feels_touch(entry: ModelEntry) -> bool:
    return any(
        sensor.type == "contact" for link in entry.description.links for sensor in link.sensors
    )


def _empty(world: WorldDescription) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.modelname = world.name
    spec.compiler.degree = False
    spec.compiler.autolimits = False
    spec.compiler.boundmass = 0
    spec.option.timestep = step_of(world)
    spec.option.gravity = list(world.gravity)
    # Solves motors and contacts in one system. The other implicit integrators damp a servo only
    # after the contacts were solved without it, and a driven wheel slips by that difference.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = contact.FRICTION_IMPEDANCE_RATIO
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    # Lengths that MuJoCo scales by the model's extent stay in metres.
    spec.stat.extent = 1.0
    spec.visual.global_.offwidth = 16
    spec.visual.global_.offheight = 16
    # Four samples a pixel and shadows are most of what a software renderer would pay for.
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    ambient = list(world.ambient[:3])
    spec.visual.headlight.ambient = ambient
    # A little light from the camera itself: a face turned away from the sun keeps its shape.
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
        _add_light(spec, light)
    return spec


def _add_light(spec: mujoco.MjSpec, light: Light) -> None:
    kinds = {
        "directional": mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        "point": mujoco.mjtLightType.mjLIGHT_POINT,
        "spot": mujoco.mjtLightType.mjLIGHT_SPOT,
    }
    spec.worldbody.add_light(
        name=light.name,
        type=kinds[light.type],
        pos=list(light.pose.position),
        dir=list(rotate(light.pose.orientation, light.direction)),
        ambient=[0, 0, 0],
        diffuse=list(light.diffuse[:3]),
        specular=[0, 0, 0],
        attenuation=list(light.attenuation),
        cutoff=math.degrees(light.spot_angle) / 2,
        castshadow=False,
    )


def _explain(message: str, entries: list[ModelEntry]) -> WorldError:
    """Leads an error of MuJoCo's compiler back to the line of the element it names."""
    text = message.splitlines()[0].removeprefix("Error: ")
    for entry in entries:
        for link in entry.description.links:
            named: list[tuple[str, Origin]] = [(scoped(entry.name, link.name), link.origin)]
            named += [(scoped(entry.name, link.name, c.name), c.origin) for c in link.collisions]
            for name, origin in reversed(named):
                if re.search(rf"'{re.escape(name)}'", message):
                    return WorldError(f'model "{entry.name}": {text}', origin=origin)
        for joint in entry.description.joints:
            if re.search(rf"'{re.escape(scoped(entry.name, joint.name))}'", message):
                return WorldError(f'model "{entry.name}": {text}', origin=joint.origin)
    newest = entries[-1] if entries else None
    return WorldError(
        f'model "{newest.name}": {text}' if newest else text,
        origin=newest.description.origin if newest else None,
    )
