"""Saves which models are in a world, with what their plugins added to them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from cartwheel.component import Component
from cartwheel.geometry import Pose
from cartwheel.session import Spawned
from cartwheel.simulation.models.resident import Resident
from cartwheel.world.entry import ModelEntry


@dataclass(frozen=True, kw_only=True, slots=True)
class SavedModel:
    """A model as it was when it was saved."""

    entry: ModelEntry
    start: Pose
    namespace: str
    frame_prefix: str
    how: Spawned
    plugins: tuple[int, ...]
    """Indices of its plugins that were not disabled, in the order in which they were created."""
    structures: tuple[Any, ...]
    """For each of these plugins, its `Component.structure`."""


def describe(resident: Resident, how: Spawned) -> SavedModel:
    """Returns the description of a model from which it can be created again."""
    alive = [each for each in resident.created if each in resident.behaviours]
    return SavedModel(
        entry=resident.entry.copy(),
        start=resident.start,
        namespace=resident.part.namespace,
        frame_prefix=resident.part.frame_prefix,
        how=how,
        plugins=tuple(resident.created.index(each) for each in alive),
        structures=tuple(
            each.structure() if isinstance(each, Component) else None for each in alive
        ),
    )


def components(resident: Resident) -> Iterator[Component]:
    """Yields a model's plugins, and the devices and controllers of each."""
    for each in resident.created:
        if each in resident.behaviours and isinstance(each, Component):
            yield from _with_parts(each)


def _with_parts(component: Component) -> Iterator[Component]:
    yield component
    for each in component.components():
        yield from _with_parts(each)


def replace_entry(entry: ModelEntry, saved: ModelEntry) -> bool:
    """Sets an entry to its saved state; returns whether that changed anything."""
    if entry == saved:
        return False
    for field in fields(entry):
        before, after = getattr(entry, field.name), getattr(saved, field.name)
        # Plugins may refer to the containers.
        if isinstance(before, list):
            before[:] = after
        elif isinstance(before, dict):
            before.clear()
            before.update(after)
        else:
            setattr(entry, field.name, after)
    return True
