"""Tests of robots with pytest: fixtures, marks, and functions that check behaviour.

pytest loads the plugin of this package in each run, so nothing is imported until it is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cartwheel.testing.matchers import (
        UnmetError,
        joint_reaches,
        moves,
        publishes,
        reaches,
        sees,
        stays_within,
        touches,
        touches_nothing,
    )

__all__ = [
    "UnmetError",
    "joint_reaches",
    "moves",
    "publishes",
    "reaches",
    "sees",
    "stays_within",
    "touches",
    "touches_nothing",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(name)
    from cartwheel.testing import matchers

    return getattr(matchers, name)


def __dir__() -> list[str]:
    """Lists the functions for `help` and completion. Python does not know them before their use."""
    return [*globals(), *__all__]
