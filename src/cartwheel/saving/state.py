"""The state of a session."""

from __future__ import annotations

import pickle
import zlib
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from cartwheel.description.model import WorldDescription
from cartwheel.saving.encoded import Node
from cartwheel.saving.models import SavedModel, components, describe
from cartwheel.saving.writing import Writer
from cartwheel.session import Spawned
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.saved_physics import VERSION, Physics

if TYPE_CHECKING:
    from cartwheel.session import Session
    from cartwheel.simulation import Simulation
    from cartwheel.simulation.models.resident import Resident


class State:
    """The state of a world; `World.save` returns it and `World.restore` takes it.

    It can be pickled. As with all pickles, load it only from a source that you trust: loading can
    execute code.
    """

    def __init__(
        self,
        *,
        version: tuple[str, str],
        world: WorldDescription,
        furniture: tuple[str, ...],
        house: SavedModel,
        models: tuple[SavedModel, ...],
        without: tuple[str, ...],
        time_ns: int,
        roots: dict[str, Any],
        nodes: list[Node],
        engine: dict[str, Any],
        physics: Physics,
        left_out: tuple[str, ...],
    ) -> None:
        self._version = version
        self._world = world
        self._furniture = furniture
        self._house = house
        self._models = models
        self._without = without
        self._time_ns = time_ns
        self._roots = roots
        self._nodes = nodes
        self._engine = engine
        self._physics = physics
        self._left_out = left_out

    @property
    def time(self) -> float:
        """Simulation time at which the state was saved, s."""
        return self._time_ns / NANOSECONDS

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models in the state."""
        return tuple(model.entry.name for model in self._models)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What was not saved: subscribers of the program, connections, recordings, and values of
        plugins that cannot be copied. Each text names one of them.
        """
        return self._left_out

    def __repr__(self) -> str:
        names = ", ".join(self.models)
        return f"<State at {self.time:g} s of {names}>"

    def __getstate__(self) -> bytes:
        return zlib.compress(pickle.dumps(vars(self)), 1)

    def __setstate__(self, state: bytes) -> None:
        vars(self).update(pickle.loads(zlib.decompress(state)))  # noqa: S301 - see above


def version() -> tuple[str, str]:
    """The versions of Cartwheel and MuJoCo."""
    import cartwheel

    return cartwheel.__version__, VERSION


def save(session: Session, left_out: tuple[str, ...] = ()) -> State:
    """Saves the state of a session.

    Call it on the owner's thread, between two steps.

    Args:
        session: The session.
        left_out: What is left out besides what the session itself leaves out.
    """
    simulation = session.simulation
    simulation.drain()
    writer = Writer()
    roots: dict[str, Any] = {}
    for places in (objects, registered):
        roots |= {name: writer.root(value, name) for name, value in places(session)}
        writer.finish()
    state = State(
        version=version(),
        world=replace(simulation.world, models=()),
        furniture=tuple(model.name for model in simulation.world.models),
        house=describe(simulation.population.house, Spawned()),
        models=tuple(
            describe(each, session.spawned.get(name, Spawned()))
            for name, each in simulation.population.residents.items()
        ),
        without=tuple(sorted(simulation.engine.without)),
        time_ns=simulation.time_ns,
        roots=roots,
        nodes=writer.nodes,
        engine=simulation.engine.save(),
        physics=Physics(simulation.model, simulation.data),
        left_out=(*left_out, *_of_program(session), *writer.left_out),
    )
    session.originals[state] = Saved(writer, simulation)
    return state


class Saved:
    """The objects from which a state was saved."""

    def __init__(self, writer: Writer, simulation: Simulation) -> None:
        self.originals = writer.originals
        self.alarms = simulation.alarms.save()
        self.residents: dict[str, Resident] = dict(simulation.population.residents)


def objects(session: Session) -> Iterator[tuple[str, Any]]:
    """Yields the objects of a session that have a state, by their places.

    Objects that are registered with the graph or the schedule come before the objects that refer
    to them, so that each is found in the same place in every process.
    """
    simulation = session.simulation
    population = simulation.population
    for resident in population.everyone():
        yield from _objects_of(resident)
    yield "forces", simulation.forces
    yield "attachments", simulation.attachments
    yield "watch", population.watch
    yield "separation", population.separation
    for kind, shared in session.shared.objects():
        yield f"shared {kind}", shared
    yield "parameters", session.graph.parameters.tree


def registered(session: Session) -> Iterator[tuple[str, Any]]:
    """Yields lists of objects that `objects` refer to, of which some may not be listed."""
    yield "joint inputs", session.graph.joint_inputs.all()


def _objects_of(resident: Resident) -> Iterator[tuple[str, Any]]:
    name = resident.entry.name
    parts = tuple(components(resident))
    yield f"{name} components", parts
    yield f"{name} graph", tuple(tuple(each.items) for each in parts)
    yield f"{name} tasks", resident.part.tasks
    yield f"{name} handles", resident.part.handles
    yield f"{name} drives", resident.drives


def _of_program(session: Session) -> Iterator[str]:
    """Yields the subscribers and timed actions that the program has added."""
    for topic in session.graph.topics():
        for node in topic.subscribers:
            if node == "cartwheel":
                yield f"subscriber of {topic.name}"
    for alarm in session.simulation.alarms.pending:
        yield f"action at {alarm.time_ns / NANOSECONDS:g} s"
