"""Compiles a world description and its models."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.description.model import WorldDescription
from cartwheel.errors import WorldError
from cartwheel.world import contact, joints, pairs
from cartwheel.world.actuation import ROTOR_INERTIA, stiffen_rotors
from cartwheel.world.additions import Added, Addition
from cartwheel.world.bodies import BodyBuilder, Shapes
from cartwheel.world.chains import drag_chains
from cartwheel.world.contact_rules import contact_rules
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.shapes import Assets
from cartwheel.world.spec import (
    DEFAULT_STEP,
    compile_error,
    compiled,
    divide_floors,
    empty_spec,
    step_of,
)

__all__ = ["DEFAULT_STEP", "Build", "build", "build_visuals", "step_of"]

LONGEST_CHAIN = 500
"""Maximum links in a chain: the compile time grows with the third power."""
MOST_CONTACTS = 10_000
"""Maximum initial contacts: beyond, a step takes seconds and the solver runs out of memory."""
_CROWD = 60
"""Minimum number of shapes for the contact limit to be exceeded."""
_SHORTEST = 0.01
"""Minimum length by which the speed of a rotating body is judged, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Build:
    """A compiled world."""

    model: mujoco.MjModel
    alignments: tuple[pairs.Alignment, ...] = ()
    """Friction directions of pairs with direction-dependent friction."""
    bounces: tuple[contact.Bounce, ...] = ()
    """The surfaces with restitution."""
    surfaces: tuple[contact.BuiltSurface, ...] = ()
    """The collision geoms, as described."""
    joined: frozenset[frozenset[str]] = frozenset()
    """Bodies of different models that are connected by a joint."""
    added: tuple[Added, ...] = ()
    """What was added to the descriptions."""
    xml: str | None = None


def build(
    world: WorldDescription,
    entries: Iterable[ModelEntry],
    *,
    without: Collection[Addition] = (),
    shapes: Shapes = "all",
    xml: bool = False,
) -> Build:
    """Compiles a world.

    Args:
        world: Gravity, lights, physics.
        entries: The models in the world, including the world's own.
        without: Additions to the descriptions that are omitted.
        shapes: The shapes to compile. Visuals take most of the time, but only affect
            `MjModel.dof_length`, by which the engine decides that a body is at rest.
        xml: Also write the model as MJCF.

    Raises:
        WorldError: A model cannot be built; the error has the origin if it is known.
    """
    entries = list(entries)
    try:
        return _built(world, entries, without, shapes, xml=xml)
    except ValueError as error:
        # Duplicate names raise an error as soon as they are added.
        if not str(error).startswith("Error: "):
            raise
        raise compile_error(str(error), entries) from None


def build_visuals(
    world: WorldDescription,
    entries: Iterable[ModelEntry],
    *,
    without: Collection[Addition] = (),
) -> mujoco.MjModel:
    """Compiles the visuals of a world, for images.

    The model has the same bodies, joints, cameras and lights as that of `build`, in the same order.

    Args:
        world: Lights and background.
        entries: As for `build`.
        without: As for `build`.

    Raises:
        WorldError: A visual cannot be built; the error has the origin if it is known.
    """
    entries = list(entries)
    spec = empty_spec(world, step_of(world, entries))
    bodies = BodyBuilder(spec, Assets(spec), spec.option.timestep, without, "visuals")
    try:
        for entry in entries:
            bodies.add(entry)
        model = compiled(spec)
    except ValueError as error:
        if not str(error).startswith("Error: "):
            raise
        raise compile_error(str(error), entries) from None
    # Poses are those of another model's bodies, so none of these bodies may rest.
    model.opt.enableflags &= ~mujoco.mjtEnableBit.mjENBL_SLEEP.value
    divide_floors(model)
    return model


def _built(
    world: WorldDescription,
    entries: list[ModelEntry],
    without: Collection[Addition],
    shapes: Shapes,
    *,
    xml: bool,
) -> Build:
    spec = empty_spec(world, step_of(world, entries))
    bodies = BodyBuilder(spec, Assets(spec), spec.option.timestep, without, shapes)
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
    surfaces = tuple(bodies.surfaces)
    rules = contact_rules(surfaces, joined, without)
    for surface, priority in zip(rules.surfaces, rules.priorities, strict=True):
        geom = bodies.geoms[surface.name]
        geom.friction, geom.priority = list(surface.friction), priority
    for pair in rules.pairs:
        spec.add_pair(**pair.arguments())
    try:
        model = compiled(spec)
        # The engine estimates its memory from the degrees of freedom, but pairs of bodies also need
        # some.
        pairs_of_bodies = 2 * model.nbody**2
        if pairs_of_bodies > model.narena / 2:
            spec.memory = model.narena + 2 * pairs_of_bodies
            model = compiled(spec)
    except (ValueError, mujoco.FatalError) as error:
        raise compile_error(str(error), entries) from None
    _check_contacts(model, entries)
    extend_at_rest(model)
    if any(model.body_treeid[model.body(name).id] < 0 for name in _felt(entries)):
        # A body that sleeps on a fixed body would have no contact to report.
        for option in (spec.option, model.opt):
            option.enableflags &= ~mujoco.mjtEnableBit.mjENBL_SLEEP.value
    exclude_rotors(model)
    stiffen_rotors(model)
    divide_floors(model)
    added = [*bodies.added, *rules.added]
    if "chain-drag" not in without:
        added += _drag(spec, model, entries)
    return Build(
        model=model,
        alignments=rules.alignments,
        bounces=contact.bounces_of(surfaces),
        surfaces=surfaces,
        joined=frozenset(joined),
        added=tuple(added),
        xml=spec.to_xml() if xml else None,
    )


def _drag(
    spec: mujoco.MjSpec, model: mujoco.MjModel, entries: Iterable[ModelEntry]
) -> Iterator[Added]:
    """Adds drag to the hinges of chains."""
    for index, found in drag_chains(model, entries):
        # Only for the XML text: the compiled model already has the value.
        made = spec.joint(model.joint(index).name)
        made.damping = [made.damping[0], made.damping[1], found.value]
        if found.element:
            yield found


def _check_chain(entry: ModelEntry) -> None:
    """Rejects chains of links that would take too long to compile.

    Raises:
        WorldError: With the origin of the first link beyond the limit.
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
    """Rejects worlds with so many overlapping models that a step would never finish.

    Raises:
        WorldError: With the origin of the model with most contacts.
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


def extend_at_rest(model: mujoco.MjModel) -> None:
    """Sets a minimum length, by which the engine judges the speed of a rotating body.

    A body without extent has only its velocity as a measure of rest. It must not sleep while it
    spins. Its radius of gyration is its extent if it has no shape.
    """
    masses = np.maximum(model.body_subtreemass[model.dof_bodyid], mujoco.mjMINVAL)
    radii = np.sqrt(model.dof_M0 / masses)
    model.dof_length[:] = np.maximum.reduce([model.dof_length, radii, np.full(model.nv, _SHORTEST)])


def exclude_rotors(model: mujoco.MjModel) -> None:
    """Excludes motor rotors from the mean inertia, which scales the solver's tolerance.

    Their huge inertia would make the solver accept wrong forces.
    """
    masses = model.dof_M0[model.dof_M0 < ROTOR_INERTIA / 2]
    if len(masses):
        model.stat.meaninertia = max(float(masses.mean()), 1e-9)


def _felt(entries: Iterable[ModelEntry]) -> Iterator[str]:
    """Scoped names of links for which contacts are needed."""
    for entry in entries:
        for link in entry.description.links:
            if link.name in entry.felt or any(each.type == "contact" for each in link.sensors):
                yield scoped(entry.name, link.name)
