"""Conditions on distances between surfaces."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cartwheel.api.values import scalar
from cartwheel.errors import UnknownNameError
from cartwheel.testing.conditions import Condition, shown
from cartwheel.testing.subjects import matching

if TYPE_CHECKING:
    from cartwheel.api import Clearance, World


class KeepsClear(Condition):
    """The surfaces of two models or links keep a distance.

    Args:
        model: Name of a model, or scoped name of a link.
        other: The same, or a pattern as for `Touches`; None for all other models.
        distance: Minimum distance, m.
        ignore: Names and patterns of models and links that do not count, if they exist.
    """

    def __init__(
        self, model: str, other: str | None, distance: float, *, ignore: Sequence[str] = ()
    ) -> None:
        super().__init__()
        self.model, self.other, self.ignore = model, other, ignore
        self.distance = scalar(distance, "distance")
        self.closest = math.inf
        self.closest_time = 0.0
        self._nearest: Clearance | None = None

    def begin(self, world: World) -> None:
        super().begin(world)
        if self.other is not None:
            matching(world, self.other)
        self.holds()

    def _existing(self, patterns: Sequence[str]) -> list[str]:
        """The models and links that match patterns. Models may be spawned and deleted."""
        found: list[str] = []
        for each in patterns:
            with contextlib.suppress(UnknownNameError):
                found += matching(self.world, each)
        return found

    def holds(self) -> bool:
        other: str | list[str] | None = self.other
        if self.other is not None and self.other != self.model:
            own = (self.model, self.model.partition("::")[0])
            other = [each for each in self._existing([self.other]) if each not in own]
            if not other:
                return True
        ignored = self._existing(self.ignore)
        found = self.world.clearance(self.model, other, ignore=ignored)
        if found.distance < self.closest:
            self.closest, self.closest_time = found.distance, self.world.time
            self._nearest = found
        return found.distance >= self.distance

    @property
    def expected(self) -> str:
        return f"{self.model} keeps {self.distance:g} m from {self.other or 'all other models'}"

    @property
    def actual(self) -> str:
        if self._nearest is None:
            return "no time passed"
        one, other = (
            f"{model}::{link}"
            for model, link in zip(self._nearest.models, self._nearest.links, strict=True)
        )
        return f"{one} was {shown(self.closest)} m from {other} at {self.closest_time:.3f} s"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        if self._nearest is None:
            return {}
        return {
            "closest": self.closest,
            "closest_time": self.closest_time,
            "other": self._nearest.models[1],
        }
