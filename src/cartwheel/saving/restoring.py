"""Restores the state of a session."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from cartwheel.codes.world import STATE_MISMATCH
from cartwheel.component import Component
from cartwheel.description.model import RobotDescription
from cartwheel.errors import SimulationError
from cartwheel.saving.changes import mismatch
from cartwheel.saving.models import SavedModel, replace_entry
from cartwheel.saving.reading import Reader
from cartwheel.saving.state import Saved, State, objects, registered, save, version
from cartwheel.simulation.models.resident import Resident

if TYPE_CHECKING:
    from cartwheel.session import Session


def restore(session: Session, state: State) -> None:
    """Restores a state; the session continues as it did after the state was saved.

    Models that were spawned since are deleted, and deleted models are spawned again. Call it on the
    owner's thread, while the simulation does not advance. If the state cannot be restored, the
    session continues as if it had not been tried.

    Args:
        session: The session that was saved, or one that was made in the same way.
        state: The state.

    Raises:
        SimulationError: The session differs from the one that was saved.
        CartwheelError: A model cannot be spawned again.
    """
    _check(session, state)
    session.simulation.drain()
    # Whether all parts exist is known only when they have been created.
    before = None if _is_of(session, state) else save(session)
    current = [
        (action, goal)
        for action in session.graph.actions()
        for goal in action.goals
        if not goal.done
    ]
    try:
        _restore(session, state)
    except BaseException:
        if before is not None:
            _restore(session, before, changed=True)
        raise
    for action, goal in current:
        restored = action.goal(goal.id)
        if restored is None or not restored.is_copy_of(goal):
            action.drop(goal, "a state before this goal was restored")


def _is_of(session: Session, state: State) -> bool:
    """Whether a state was saved in this session, whose models are still the same."""
    saved = session.originals.get(state)
    return saved is not None and saved.residents == session.simulation.population.residents


def _restore(session: Session, state: State, *, changed: bool = False) -> None:
    """Restores a state that passes `_check`.

    Args:
        session: The session.
        state: The state.
        changed: Whether the world must be compiled in any case.
    """
    simulation = session.simulation
    population, engine = simulation.population, simulation.engine
    saved = session.originals.get(state)
    before = engine.model
    changed |= _restore_world(session, state)
    earlier = dict(population.residents)
    residents, replaced = _restore_models(session, state)
    changed |= replaced
    for model in (state._house, *state._models):
        name = model.entry.name
        resident = residents[name] if name else population.house
        _restore_plugins(resident, model)
        changed |= replace_entry(resident.entry, model.entry)
        resident.start = model.start
    population.residents = residents
    reader = Reader(
        state._nodes,
        session.graph.types.message_class,
        None if saved is None else saved.originals,
    )
    roots = _read(reader, session, state, saved)
    reader.apply()
    _put(session, roots)
    physics = state._physics
    if changed or not physics.fits(engine.model):
        population.compile()
        # Compiling bound the handles again, which acts on what was restored.
        reader.apply()
    if not physics.fits(engine.model):
        raise mismatch("its links or joints differ")
    physics.restore(engine.model, engine.data)
    engine.restore(state._engine)
    simulation.alarms.restore(() if saved is None else saved.alarms)
    population.gather_tasks()
    if engine.model is not before:
        population.observe()
    for name in [name for name in residents if earlier.get(name) is not residents[name]]:
        for diagnostic in population.diagnostics_of(name):
            if diagnostic not in engine.diagnostics:
                engine.report(diagnostic)
    engine.rewinds += 1
    for callback in simulation.on_reset:
        callback()


def _check(session: Session, state: State) -> None:
    if state._version != version():
        saved, now = (
            f"Cartwheel {each[0]} with MuJoCo {each[1]}" for each in (state._version, version())
        )
        raise SimulationError(
            f"the state was saved by {saved}, and this is {now}",
            code=STATE_MISMATCH,
            hint="Save the state again with these versions.",
            values={"saved": saved, "now": now},
        )
    name, without = session.simulation.world.name, session.simulation.engine.without
    if state._world.name != name:
        raise mismatch(f'the state is of world "{state._world.name}", and this is world "{name}"')
    furniture = tuple(model.name for model in session.simulation.world.models)
    if state._furniture != furniture:
        found = sorted(set(state._furniture) ^ set(furniture)) or furniture
        raise mismatch(f'the files of the worlds differ in model "{found[0]}"')
    if state._without != tuple(sorted(without)):
        raise mismatch("different physics is omitted")


def _restore_world(session: Session, state: State) -> bool:
    """Restores gravity, lights and step length; returns whether the world must be compiled."""
    engine = session.simulation.engine
    world = replace(state._world, models=engine.world.models)
    if world == engine.world:
        return False
    engine.world = world
    return True


def _restore_models(session: Session, state: State) -> tuple[dict[str, Resident], bool]:
    """Closes models that are not in the state, and creates those that are missing.

    Returns:
        The models in the order of the state, and whether they have changed.
    """
    simulation = session.simulation
    population = simulation.population
    wanted = {model.entry.name: model for model in state._models}
    live = dict(population.residents)
    for name, resident in population.residents.items():
        model = wanted.get(name)
        if model is None or not _same(resident, model):
            simulation.forces.drop(name)
            resident.close()
            del live[name]
    changed = len(live) != len(population.residents)
    # Models that were created are closed if a later one fails.
    population.residents = everyone = dict(live)
    for name, model in wanted.items():
        if name not in everyone:
            everyone[name] = session.admit(
                model.entry.description,
                name,
                pose=model.start,
                namespace=model.namespace,
                frame_prefix=model.frame_prefix,
                how=model.how,
            )
    residents = {name: everyone[name] for name in wanted}
    return residents, changed or list(residents) != list(live)


def _same(resident: Resident, model: SavedModel) -> bool:
    """Whether a model can be restored without being created again."""
    alive = {
        index for index, plugin in enumerate(resident.created) if plugin in resident.behaviours
    }
    part = resident.part
    return (
        alive.issuperset(model.plugins)
        and part.namespace == model.namespace
        and part.frame_prefix == model.frame_prefix
        and _similar(resident.entry.description, model.entry.description)
    )


def _similar(description: RobotDescription, other: RobotDescription) -> bool:
    """Whether two descriptions are of the same robot, whose properties may have been changed."""
    if description == other:
        return True
    one, two = (
        (
            each.origin,
            [link.name for link in each.links],
            [(joint.name, joint.type) for joint in each.joints],
        )
        for each in (description, other)
    )
    return one == two


def _restore_plugins(resident: Resident, model: SavedModel) -> None:
    """Closes plugins that were disabled, and lets the others create their parts."""
    created = resident.created
    if len(created) <= max(model.plugins, default=-1):
        raise mismatch(f'model "{model.entry.name}" has other plugins')
    for index, plugin in enumerate(created):
        if index not in model.plugins:
            resident.end(plugin)
    for index, structure in zip(model.plugins, model.structures, strict=True):
        plugin = created[index]
        if isinstance(plugin, Component):
            plugin.rebuild(structure)


def _read(reader: Reader, session: Session, state: State, saved: Saved | None) -> dict[str, Any]:
    """Decodes all objects of a session; see `objects`."""
    known = {} if saved is None else saved.residents
    population = session.simulation.population
    strange = {
        resident.entry.name
        for resident in population.residents.values()
        if known.get(resident.entry.name) is not resident
    }
    roots = {}
    for places in (objects, registered):
        for name, live in list(places(session)):
            if name not in state._roots and name.startswith("shared "):
                # Only models that are deleted now have used it.
                continue
            own = saved is not None and name.rpartition(" ")[0] not in strange
            roots[name] = reader.root(state._roots[name], live, own=own)
        reader.finish()
    return roots


def _put(session: Session, roots: dict[str, Any]) -> None:
    """Sets the containers that may have been replaced since."""
    for resident in session.simulation.population.everyone():
        name = resident.entry.name
        resident.part.tasks = roots[f"{name} tasks"]
        resident.part.handles = roots[f"{name} handles"]
        resident.drives = roots[f"{name} drives"]
    session.graph.joint_inputs.replace(roots["joint inputs"])
