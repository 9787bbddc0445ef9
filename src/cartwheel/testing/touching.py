"""Conditions on contacts."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from cartwheel.errors import UnknownNameError
from cartwheel.testing.conditions import Condition

if TYPE_CHECKING:
    from cartwheel.api import Contact, World

GROUND = "ground_plane"
"""The model that every robot touches."""


class Touches(Condition):
    """Two models touch.

    Args:
        model: Name of a model, or a pattern such as ``wall*``.
        other: The other model; None for any model but the ground plane.
        inverted: Whether the models must not touch instead.
    """

    every_step = True

    def __init__(self, model: str, other: str | None = None, *, inverted: bool = False) -> None:
        super().__init__()
        self.model, self.other, self.inverted = model, other, inverted
        self.first: tuple[float, str, str, float] | None = None
        """Time, both links, and force in N of the first contact."""

    def begin(self, world: World) -> None:
        super().begin(world)
        for name in filter(None, (self.model, self.other)):
            if not fnmatch.filter(world.models, name):
                raise UnknownNameError("model", name, world.models)

    def holds(self) -> bool:
        touching = any(self._contacts())
        return touching is not self.inverted

    def _contacts(self) -> Iterator[Contact]:
        for contact in self.world.contacts():
            turned = not self._meant(*contact.models)
            if not turned or self._meant(*reversed(contact.models)):
                if self.first is None:
                    names = [
                        f"{model}::{link}"
                        for model, link in zip(contact.models, contact.links, strict=True)
                    ]
                    one, other = reversed(names) if turned else names
                    force = math.hypot(*contact.force)
                    self.first = (self.world.time, one, other, force)
                yield contact

    def _meant(self, one: str, other: str) -> bool:
        if not fnmatch.fnmatchcase(one, self.model) or one == other:
            return False
        return other != GROUND if self.other is None else fnmatch.fnmatchcase(other, self.other)

    @property
    def expected(self) -> str:
        verb = "does not touch" if self.inverted else "touches"
        return f"{self.model} {verb} {self.other or 'another model'}"

    @property
    def actual(self) -> str:
        if self.first is None:
            return "they did not touch"
        time, one, other, force = self.first
        return f"{one} touched {other} at {time:.3f} s with {force:.3g} N"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        if self.first is None:
            return {}
        time, one, other, force = self.first
        return {"time": time, "link": one, "other": other, "force": force}
