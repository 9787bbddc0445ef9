"""A world description and the models that stand in it, compiled."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Origin, WorldError
from cartwheel.world import chains, contact, joints, pairs
from cartwheel.world.bodies import ROTOR_INERTIA, BodyBuilder
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.lights import add_light
from cartwheel.world.shapes import Assets

LONGEST_CHAIN = 500
"""Links in a row: the compiler's time grows with the third power."""
MOST_CONTACTS = 10_000
"""At the start: beyond, one step takes seconds and the solver's memory runs out."""
_CROWD = 60
"""Shapes, of which no fewer can touch at too many points."""
DEFAULT_STEP = 0.005
"""s; see ``docs/physics.md`` for how it was chosen."""


_MOST_AMBIENT = 0.4
"""SDF's default. New Gazebo's worlds state 1, which its renderer dims; here no shade were left."""
_CELLS = 100
"""On each side of a plane's middle; the engine draws no more."""
_LEAST_CELL = 0.2
"""m."""
_SHORTEST = 0.01
"""m, at which a turning body's speed is judged where it has no shape."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Build:
    """A compiled world."""

    model: mujoco.MjModel
    alignments: tuple[pairs.Alignment, ...] = ()
    """In which directions friction counts where it is not the same in all."""
    bounces: tuple[contact.Bounce, ...] = ()
    """The surfaces that bounce."""
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
    entries = list(entries)
    try:
        return _built(world, entries, xml=xml)
    except ValueError as error:
        # A name that stands twice is refused as soon as it is given.
        if not str(error).startswith("Error: "):
            raise
        raise _explain(str(error), entries) from None


def _built(world: WorldDescription, entries: list[ModelEntry], *, xml: bool) -> Build:
    spec = _empty(world)
    bodies = BodyBuilder(spec, Assets(spec), spec.option.timestep)
    for entry in entries:
        _check_chain(entry)
        bodies.add(entry)
    joined = {
        frozenset((joint.parent, joint.child))
        for joint in world.joints
        if joints.join_models(spec, joint)
    }
    for name in (name for entry in entries for name in entry.attachments):
        joints.add_attachment(spec, name)
    ranks = contact.priorities(surface.friction[0] for surface in bodies.surfaces)
    for surface in bodies.surfaces:
        surface.geom.priority = ranks[surface.friction[0]]
    alignments = []
    for pair in pairs.stated_pairs(bodies.surfaces, joined):
        spec.add_pair(**pair.arguments())
        if pair.alignment is not None:
            alignments.append(pair.alignment)
    try:
        model = _compiled(spec)
        # The engine reserves memory by degrees of freedom, and needs it by pairs of bodies, too.
        pairs_of_bodies = 2 * model.nbody**2
        if pairs_of_bodies > model.narena / 2:
            spec.memory = model.narena + 2 * pairs_of_bodies
            model = _compiled(spec)
    except (ValueError, mujoco.FatalError) as error:
        raise _explain(str(error), entries) from None
    _check_contacts(model, entries)
    # What has no extent is as far from rest as its speed says, and not asleep while it spins.
    model.dof_length[:] = np.maximum(model.dof_length, _SHORTEST)
    if any(model.body_treeid[model.body(name).id] < 0 for name in _felt(entries)):
        # A body asleep on something that stands has no contact with it to be reported.
        for option in (spec.option, model.opt):
            option.enableflags &= ~mujoco.mjtEnableBit.mjENBL_SLEEP.value
    _judge_without_rotors(model)
    _divide_floors(model)
    for index, coefficient in chains.apply(model).items():
        # For the text alone: the compiled model has it.
        made = spec.joint(model.joint(index).name)
        made.damping = [made.damping[0], made.damping[1], coefficient]
    bounces = (contact.bounce(surface.name, surface.surface) for surface in bodies.surfaces)
    return Build(
        model=model,
        alignments=tuple(alignments),
        bounces=tuple(each for each in bounces if each is not None),
        xml=spec.to_xml() if xml else None,
    )


def _compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    with warnings.catch_warnings():
        # The engine counts the same warnings while it runs, and the simulation reports them.
        warnings.simplefilter("ignore", UserWarning)
        return spec.compile()


def _check_chain(entry: ModelEntry) -> None:
    """Refuses chains of links whose matrices nobody can wait for.

    Raises:
        WorldError: With the place of the first link that is too far out.
    """
    description = entry.description
    parents = {joint.child: joint.parent for joint in reversed(description.joints)}
    depths: dict[str, int] = {"world": 0}
    for link in description.links:
        path: list[str] = []
        name = link.name
        while name not in depths and len(path) <= len(description.links):
            path.append(name)
            name = parents.get(name, "world")
        depth = depths.get(name, 0)
        for each in reversed(path):
            depth += 1
            depths[each] = depth
        if depths[link.name] > LONGEST_CHAIN and len(path) <= len(description.links):
            raise WorldError(
                f'link "{link.name}" is at the end of a chain of {depths[link.name]} links, but at '
                f"most {LONGEST_CHAIN} can be simulated",
                code=world_codes.CHAIN_TOO_LONG,
                origin=link.origin,
                values={"link": link.name, "links": depths[link.name], "most": LONGEST_CHAIN},
            )


def _check_contacts(model: mujoco.MjModel, entries: list[ModelEntry]) -> None:
    """Refuses models that stand inside each other in such numbers that no step would end.

    Raises:
        WorldError: With the place of the model that touches most.
    """
    if model.ngeom < _CROWD:
        return
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_collision(model, data)
    if data.ncon <= MOST_CONTACTS and not data.warning.number.any():
        return
    touched = np.bincount(model.geom_bodyid[data.contact.geom].ravel(), minlength=model.nbody)
    touched[0] = 0
    body = int(np.argmax(touched))
    owner = model.body(int(body)).name.partition("::")[0]
    found = next((each for each in entries if each.name == owner), None)
    raise WorldError(
        f"the models have {data.ncon} contacts, but at most {MOST_CONTACTS} can be simulated; "
        f'"{owner}" alone has {int(touched[body])}',
        code=world_codes.TOO_MANY_CONTACTS,
        values={"contacts": int(data.ncon), "model": owner},
        origin=found.description.origin if found else None,
        hint="Check whether models overlap.",
    )


def _judge_without_rotors(model: mujoco.MjModel) -> None:
    """Takes the rotors of motors out of the mean inertia, by which the solver judges its accuracy.

    They are heavy beyond measure, and with them it would be content with forces that are wrong.
    """
    masses = model.dof_M0[model.dof_M0 < ROTOR_INERTIA / 2]
    if len(masses):
        model.stat.meaninertia = max(float(masses.mean()), 1e-9)


def _divide_floors(model: mujoco.MjModel) -> None:
    """Draws planes in many cells where lamps shine: light is computed at their corners.

    The sun shines alike everywhere, so that one cell does for it.
    """
    if (model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL).all():
        return
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    half = model.geom_size[planes, :2].max(axis=1)
    model.geom_size[planes, 2] = np.maximum(half / _CELLS, _LEAST_CELL)


def _felt(entries: Iterable[ModelEntry]) -> Iterator[str]:
    """The links that somebody asks what lies on them, scoped."""
    for entry in entries:
        for link in entry.description.links:
            if link.name in entry.felt or any(each.type == "contact" for each in link.sensors):
                yield scoped(entry.name, link.name)


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
    # That one takes damping into its system; mj_Euler, by which a step ends where something has
    # read it, would take it a second time.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = contact.FRICTION_IMPEDANCE_RATIO
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    # Lengths that MuJoCo scales by the model's extent stay in metres.
    spec.stat.extent = 1.0
    # A geom's laser_retro.
    spec.nuser_geom = 1
    spec.visual.global_.offwidth = 16
    spec.visual.global_.offheight = 16
    # Four samples a pixel and shadows are most of what a software renderer would pay for.
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    ambient = [min(value, _MOST_AMBIENT) for value in world.ambient[:3]]
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
        add_light(spec.worldbody, light.name, light)
    return spec


def _explain(message: str, entries: list[ModelEntry]) -> WorldError:
    """The error for what MuJoCo's compiler refuses, at the line of the element that it names.

    Here alone its texts are read.
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
