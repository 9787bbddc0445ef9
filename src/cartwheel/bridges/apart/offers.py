"""Services and actions as the other process knows them."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from cartwheel.bridges.bridged import Named


@dataclass(frozen=True, kw_only=True, slots=True)
class Offer:
    """Description of a service or action for the other process."""

    number: int
    """Unique number. A new service or action with the same name has a different number."""
    name: str
    type: str
    node: str


T = TypeVar("T", bound=Named)


class Offers(Generic[T]):
    """Assigns a number to each service or action while it exists.

    Attributes:
        known: Services or actions by number, as of the last `update`.
    """

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        self.known: dict[int, T] = {}

    def update(self, present: Iterable[T]) -> tuple[Offer, ...]:
        """Updates the set, and returns the current descriptions."""
        before = {id(one): number for number, one in self.known.items()}
        self.known = {before.get(id(one)) or next(self._numbers): one for one in present}
        return tuple(
            Offer(number=number, name=one.name, type=one.type, node=one.node)
            for number, one in self.known.items()
        )
