"""Conditions on contacts."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from cartwheel.testing.conditions import Condition, shown
from cartwheel.testing.subjects import matching

if TYPE_CHECKING:
    from cartwheel.api import Contact, World

GROUND = "ground_plane"
"""The model that every robot touches."""


class Touches(Condition):
    """Two models or links touch.

    Args:
        model: Name of a model, or a pattern such as ``wall*``. With ``::``, it is the name of a
            link in its model, or a pattern such as ``cart::wheel_*``.
        other: The other model or link; None for any other model but the ground plane. Two links of
            one model are compared only if `other` is a link.
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
            matching(world, name)

    def holds(self) -> bool:
        touching = any(self._contacts())
        return touching is not self.inverted

    def _contacts(self) -> Iterator[Contact]:
        for contact in self.world.contacts():
            names = [
                f"{model}::{link}"
                for model, link in zip(contact.models, contact.links, strict=True)
            ]
            turned = not self._meant(*names)
            if not turned or self._meant(*reversed(names)):
                if self.first is None:
                    one, other = reversed(names) if turned else names
                    force = math.hypot(*contact.force)
                    self.first = (self.world.time, one, other, force)
                yield contact

    def _meant(self, one: str, other: str) -> bool:
        """Whether two links, as scoped names, are those of the condition, in this order."""
        own, model = one.partition("::")[0], other.partition("::")[0]
        if not _matches(one, self.model):
            return False
        if self.other is None:
            return model not in (own, GROUND)
        return (own != model or "::" in self.other) and _matches(other, self.other)

    @property
    def expected(self) -> str:
        verb = "does not touch" if self.inverted else "touches"
        return f"{self.model} {verb} {self.other or 'another model'}"

    @property
    def actual(self) -> str:
        if self.first is None:
            return "they did not touch"
        time, one, other, force = self.first
        return f"{one} touched {other} at {time:.3f} s with {shown(force)} N"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        if self.first is None:
            return {}
        time, one, other, force = self.first
        return {"time": time, "link": one, "other": other, "force": force}


def _matches(link: str, pattern: str) -> bool:
    """Whether a link, as a scoped name, or its model matches a pattern."""
    return fnmatch.fnmatchcase(link if "::" in pattern else link.partition("::")[0], pattern)
