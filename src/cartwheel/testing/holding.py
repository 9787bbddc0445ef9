"""A condition of a program, which is a function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from cartwheel.api.conditions import Condition as Function
from cartwheel.testing.conditions import Condition

if TYPE_CHECKING:
    from cartwheel.api import World


class Holds(Condition):
    """A function returns a true value.

    Args:
        function: Takes no arguments, or the world.
        world: The world.

    Raises:
        CartwheelError: `function` cannot be called with no arguments or one.
    """

    def __init__(self, function: Callable[..., Any], world: World) -> None:
        super().__init__()
        self._function = Function(function, world)
        self._values: dict[str, str] = {}

    def holds(self) -> bool:
        if self._function.holds():
            return True
        self._values = self._function.values()
        return False

    @property
    def expected(self) -> str:
        return f"`{self._function.text}` holds"

    @property
    def actual(self) -> str:
        values = "; ".join(f"{name} is {value}" for name, value in self._values.items())
        return values or "it does not hold"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return dict(self._values)
