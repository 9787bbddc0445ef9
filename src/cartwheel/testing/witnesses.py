"""The worlds and programs that tests use, and what is recorded of them until a test fails."""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import pytest

from cartwheel.testing.launching import Launched
from cartwheel.testing.recent import Recent
from cartwheel.testing.report import Report, recorded_seconds
from cartwheel.testing.showing import show

if TYPE_CHECKING:
    from cartwheel.api import World

_MOST_KEPT = 8
"""Maximum number of worlds whose messages are kept during a test."""
_MOST_REPORTED = 3
"""Maximum number of worlds in the report of a test."""


class Witnesses:
    """Records the worlds that tests make, and reports those that a failed test has used.

    Worlds are only kept alive during the test that makes them, and at most `_MOST_KEPT` of them.

    Args:
        config: The configuration of pytest.
    """

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._item: pytest.Item | None = None
        self._known: list[_Witness] = []
        """The oldest first."""
        self._programs: list[Launched] = []
        """The programs under test that have not ended."""

    def begin(self, item: pytest.Item) -> None:
        """Begins a test."""
        self._item = item
        for each in self._known:
            each.begin()

    def end(self) -> None:
        """Ends a test. Worlds of fixtures with a wider scope may be used by the next one."""
        for each in self._known:
            each.release()
        self._known = [each for each in self._known if each.open]
        self._item = None

    def note(self, made: World | Launched) -> None:
        """Records a new world or program.

        Raises:
            CartwheelError: As for `add`.
        """
        if isinstance(made, Launched):
            self._programs = [each for each in self._programs if not each.ended] + [made]
        else:
            self.add(made)

    def add(self, world: World, robots: Sequence[str] = ()) -> None:
        """Records a new world, and shows it with ``--cartwheel-view``.

        Args:
            world: The world.
            robots: Names of its models that are reported although they cannot move.

        Raises:
            CartwheelError: An option is invalid, or the world cannot be shown.
        """
        seconds = recorded_seconds(self._config)
        topics = _topics(self._item)
        recent = None if seconds == 0 else Recent(world, seconds, topics)
        if len(self._known) >= _MOST_KEPT:
            dropped = min(self._known, key=lambda each: (each.open, each.inherited))
            self._known.remove(dropped)
            dropped.close()
        self._known.append(_Witness(world, recent, robots))
        if self._item is not None and self._config.getoption("--cartwheel-view"):
            show(world, self._item)

    def complete(self, report: pytest.TestReport, item: pytest.Item) -> None:
        """Adds sections to the report of a failed test, and the files to its properties."""
        programs = [
            ("cartwheel: program", each.summary)
            for each in self._programs
            if not (each.ended or each.reported)
        ]
        given = list(_worlds(getattr(item, "funcargs", {}).values()))
        used = [
            (each, world)
            for each in self._known
            if (world := each.world) is not None and (each.used or world in given)
        ][-_MOST_REPORTED:]
        for index, (each, world) in enumerate(used, 1):
            own = Report(world, each.recent, item, robots=each.robots, number=(index, len(used)))
            try:
                report.sections += own.sections()
            except Exception as error:  # noqa: BLE001 - the error of the test is to be shown
                text = f"no report: {type(error).__name__}: {error}"
                report.sections.append(("cartwheel", text))
            # The JUnit report takes them from the report of the teardown, which follows.
            item.user_properties += own.files
        report.sections += programs


class _Witness:
    """A world with its messages, and whether a test has used it."""

    def __init__(self, world: World, recent: Recent | None, robots: Sequence[str]) -> None:
        self.robots = tuple(robots)
        self.inherited = False
        """Whether an earlier test has made it."""
        self._world = weakref.ref(world)
        # While the world is open, it refers to the recording by its subscriptions.
        self._recent = None if recent is None else weakref.ref(recent)
        self._held: tuple[World, Recent | None] | None = (world, recent)
        self._start: tuple[int, int] | None = None

    @property
    def world(self) -> World | None:
        """The world; None if it has been freed."""
        return self._world()

    @property
    def recent(self) -> Recent | None:
        """Its messages; None if they are not recorded, or if a later test has closed the world."""
        return None if self._recent is None else self._recent()

    @property
    def open(self) -> bool:
        """Whether it can be used."""
        world = self.world
        return world is not None and not world.session.simulation.closed

    @property
    def used(self) -> bool:
        """Whether the current test has made it or run it."""
        return self._start != self._now

    @property
    def _now(self) -> tuple[int, int]:
        world = self.world
        if world is None:
            return (0, 0)
        simulation = world.session.simulation
        return simulation.time_ns, simulation.engine.rewinds

    def begin(self) -> None:
        """Begins a test that has not made it."""
        self.inherited, self._start = True, self._now

    def release(self) -> None:
        """Lets the world be freed after the test that has made it."""
        self._held = None

    def close(self) -> None:
        """Ends the recording."""
        if (recent := self.recent) is not None:
            recent.close()
        self.release()


def _topics(item: pytest.Item | None) -> tuple[str, ...]:
    """Patterns of topics of the innermost mark that has any."""
    if item is None:
        return ()
    for mark in item.iter_markers("cartwheel"):
        if "record" in mark.kwargs:
            given = mark.kwargs["record"]
            return tuple(given) if isinstance(given, list | tuple) else (given,)
    return ()


def _worlds(values: Any) -> Iterator[World]:
    """The worlds among the values of fixtures, also those of models and links."""
    from cartwheel.api import Link, Model, World

    for value in values:
        if isinstance(value, World):
            yield value
        elif isinstance(value, Model | Link):
            yield value._world
