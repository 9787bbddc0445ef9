"""The parameters of all contacts in a world, by its surfaces."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from cartwheel.world import contact, dragging
from cartwheel.world.additions import Added, Addition
from cartwheel.world.pairs import Alignment, Pair, stated_pairs


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactRules:
    """The parameters of all contacts."""

    surfaces: tuple[contact.BuiltSurface, ...]
    """With the friction that applies."""
    priorities: tuple[int, ...]
    """The engine's priority of each surface."""
    pairs: tuple[Pair, ...]
    """Pairs of surfaces with their own parameters."""
    added: tuple[Added, ...]
    """What was added to the descriptions."""

    @property
    def alignments(self) -> tuple[Alignment, ...]:
        """Friction directions of pairs with direction-dependent friction."""
        return tuple(pair.alignment for pair in self.pairs if pair.alignment is not None)


def contact_rules(
    surfaces: Sequence[contact.BuiltSurface],
    joined: Collection[frozenset[str]],
    without: Collection[Addition],
) -> ContactRules:
    """The parameters of all contacts between surfaces.

    Args:
        surfaces: All surfaces in the world, as described.
        joined: Bodies of different models that are connected by a joint and do not collide.
        without: Additions to the descriptions that are omitted.
    """
    limited, added = dragging.limited(surfaces, limit="limited-friction" not in without)
    ranks = contact.priorities(surface.friction[0] for surface in limited)
    stated = tuple(stated_pairs(limited, joined, soft_sliding="soft-sliding" not in without))
    softened: dict[tuple[str, str], Added] = {}
    for pair in stated:
        if pair.friction_time is not None and pair.friction[0] > 0:
            found = pair.second.added("soft-sliding", pair.friction_time)
            softened[found.model, found.element] = found
    return ContactRules(
        surfaces=tuple(limited),
        priorities=tuple(ranks[surface.friction[0]] for surface in limited),
        pairs=stated,
        added=(*softened.values(), *added),
    )
