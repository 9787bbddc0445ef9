"""Functions that are called with each world that a program makes, and each program under test.

The plugin for pytest adds one before anything of the simulation is imported, so this module imports
nothing either. It belongs to the process, not to a run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Watcher = Callable[[Any], None]
_watchers: list[Watcher] = []


def watch(watcher: Watcher) -> Callable[[], None]:
    """Calls a function with each world, and each program under test, that starts from now on.

    Args:
        watcher: Receives a `cartwheel.api.World` or a `cartwheel.testing.launching.Launched`, on
            the thread that makes it. Worlds that Cartwheel makes for itself, such as those of a
            batch, are left out.

    Returns:
        A function that ends the calls.
    """
    _watchers.append(watcher)
    return lambda: _watchers.remove(watcher)


def announce(made: Any) -> None:
    """Calls all watchers with a new world or program."""
    for watcher in tuple(_watchers):
        watcher(made)
