"""Compiled worlds, and their use by several simulations."""

from __future__ import annotations

import copy
import threading
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import Diagnostic
from cartwheel.world import Build, build, build_visuals, unreadable, unused
from cartwheel.world.additions import Addition
from cartwheel.world.entry import ModelEntry

_VISUALS = threading.Lock()
"""Held while visuals are compiled, because simulations in several threads may share them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Compiled:
    """A world that is compiled for one simulation."""

    build: Build
    compile_visuals: Callable[[], Any]
    """See `VisualModel.bind`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Notes:
    """What a load reports of a description, besides what its readers and plugins report."""

    unused: tuple[Diagnostic, ...]
    """Elements without effect on the physics."""
    unreadable: tuple[Diagnostic, ...]
    """Visuals that cannot be shown as described."""


class Compiler:
    """Compiles worlds for a simulation."""

    def compile(
        self,
        world: WorldDescription,
        entries: Sequence[ModelEntry],
        without: Collection[Addition],
    ) -> Compiled:
        """Compiles a world. Later changes of the entries have no effect.

        Args:
            world: The world.
            entries: Its models, and the world's own entry.
            without: Additions to the descriptions that are omitted.

        Raises:
            WorldError: The world cannot be built.
        """
        own = [entry.copy() for entry in entries]
        return Compiled(
            build=build(world, own, without=without, shapes="collisions"),
            compile_visuals=self.visuals(world, own, without),
        )

    def visuals(
        self,
        world: WorldDescription,
        entries: Sequence[ModelEntry],
        without: Collection[Addition],
    ) -> Callable[[], Any]:
        """A function that compiles the visuals of a world, which is otherwise compiled already."""
        own = [entry.copy() for entry in entries]
        return partial(build_visuals, world, own, without=without)

    def notes(self, description: RobotDescription) -> Notes:
        """The notes on a description that is part of a compiled world."""
        return Notes(unused=tuple(unused(description)), unreadable=tuple(unreadable(description)))


class _Original:
    """A compiled world, of which each simulation gets copies."""

    def __init__(
        self,
        world: WorldDescription,
        entries: Sequence[ModelEntry],
        without: Collection[Addition],
        compiled: Compiled,
    ) -> None:
        self._contents = (world, [entry.copy() for entry in entries], without)
        self._compiled = compiled
        self._visuals: Any = None

    def consists_of(
        self,
        world: WorldDescription,
        entries: Sequence[ModelEntry],
        without: Collection[Addition],
    ) -> bool:
        return self._contents == (world, list(entries), without)

    def copy(self) -> Compiled:
        """A copy for one simulation, which may change its model."""
        made = self._compiled.build
        return Compiled(
            build=replace(made, model=copy.copy(made.model)), compile_visuals=self._copy_visuals
        )

    def _copy_visuals(self) -> Any:
        with _VISUALS:
            if self._visuals is None:
                self._visuals = self._compiled.compile_visuals()
            return copy.copy(self._visuals)


class SharedCompiler(Compiler):
    """Stores the worlds of one simulation, for other simulations of the same worlds.

    It can be pickled. Simulations in several threads can use it once it is `complete`.
    """

    def __init__(self) -> None:
        self._worlds: list[_Original] = []
        self._notes: list[tuple[RobotDescription, Notes]] = []
        self.complete = False
        """Whether further worlds are compiled without being stored."""

    def compile(
        self,
        world: WorldDescription,
        entries: Sequence[ModelEntry],
        without: Collection[Addition],
    ) -> Compiled:
        """As `Compiler.compile`, which is only called if no stored world is equal."""
        for each in self._worlds:
            if each.consists_of(world, entries, without):
                return each.copy()
        compiled = super().compile(world, entries, without)
        if self.complete:
            return compiled
        original = _Original(world, entries, without, compiled)
        self._worlds.append(original)
        return original.copy()

    def notes(self, description: RobotDescription) -> Notes:
        """As `Compiler.notes`, stored for the descriptions of the stored worlds."""
        for known, notes in self._notes:
            if known is description:
                return notes
        notes = super().notes(description)
        if not self.complete:
            self._notes.append((description, notes))
        return notes
