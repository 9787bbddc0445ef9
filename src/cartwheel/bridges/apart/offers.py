"""Services and actions as they are known at the other end."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar


class Named(Protocol):
    """A service or an action."""

    @property
    def name(self) -> str:
        """In the graph."""

    @property
    def type(self) -> str:
        """``pkg/srv/Name`` or ``pkg/action/Name``."""

    @property
    def node(self) -> str:
        """Who offers it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Offer:
    """What crosses of one."""

    number: int
    """Another one for what took the name of an older one."""
    name: str
    type: str
    node: str


T = TypeVar("T", bound=Named)


class Offers(Generic[T]):
    """Gives each its number, for as long as it is there.

    Attributes:
        known: By number, as of the last `update`.
    """

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        self.known: dict[int, T] = {}

    def update(self, present: Iterable[T]) -> tuple[Offer, ...]:
        """Those that are there now."""
        before = {id(one): number for number, one in self.known.items()}
        self.known = {before.get(id(one)) or next(self._numbers): one for one in present}
        return tuple(
            Offer(number=number, name=one.name, type=one.type, node=one.node)
            for number, one in self.known.items()
        )
