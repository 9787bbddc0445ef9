"""Physics that descriptions do not state, and that Cartwheel adds: names, and what a load reports.

``docs/physics.md`` explains why each addition is there.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, get_args

from cartwheel.codes import command
from cartwheel.codes import world as world_codes
from cartwheel.errors import CartwheelError, Code, Diagnostic, Origin
from cartwheel.options import WITHOUT
from cartwheel.similar_names import suggestion

Addition = Literal[
    "chain-drag",
    "round-tyres",
    "soft-sliding",
    "limited-friction",
    "minimum-inertia",
    "raised-efforts",
    "slow-separation",
    "apart-hulls",
]
"""An addition that can be omitted.

- ``chain-drag``: drag on the hinges of chains, which removes the energy that the integration adds.
- ``round-tyres``: wheels collide as ellipsoids.
- ``soft-sliding``: friction stops sliding bodies within 30 ms, the wheels of skid steers and of
  casters without trail within 0.12 s, and dragged casters within 0.4 s.
- ``limited-friction``: parts that a base must slide on the ground have a largest coefficient.
- ``minimum-inertia``: moments of inertia that are 0 or almost 0 are raised.
- ``raised-efforts``: a joint with position commands may exceed an effort limit with which it could
  not hold its own weight.
- ``slow-separation``: overlapping models separate at no more than 0.5 m/s.
- ``apart-hulls``: links of a model whose meshes have overlapping convex hulls do not collide.
"""
ADDITIONS: tuple[Addition, ...] = get_args(Addition)
ALL = "all"


@dataclass(frozen=True, kw_only=True, slots=True)
class Added:
    """An addition to one element of a model."""

    addition: Addition
    model: str
    element: str
    """Name of the joint, link or collision; a collision as ``link::collision``."""
    value: float
    """Its size; see `_REPORTS`."""
    origin: Origin | None


@dataclass(frozen=True, kw_only=True, slots=True)
class _Report:
    """How the additions to a model are reported."""

    code: Code
    elements: str
    """Plural of the kind of elements, which also names them among the values."""
    text: str
    """Follows the names of the elements."""
    size: str
    """Name of the numbers among the values."""


_REPORTS: dict[Addition, _Report] = {
    "chain-drag": _Report(
        code=world_codes.CHAIN_DRAG,
        elements="joints",
        text="drag removes the energy that the integration adds",
        size="drag",  # N m s³/rad³, times the third power of the velocity
    ),
    "round-tyres": _Report(
        code=world_codes.TYRES_ROUNDED,
        elements="collisions",
        text="a wheel collides as an ellipsoid, which touches the ground in the middle",
        size="widths",  # m
    ),
    "soft-sliding": _Report(
        code=world_codes.SLIDING_SOFTENED,
        elements="collisions",
        text="friction on fixed surfaces is softer than the contact, so that sliding does not lift "
        "the body",
        size="times",  # s, in which friction stops slow sliding
    ),
    "limited-friction": _Report(
        code=world_codes.FRICTION_LIMITED,
        elements="collisions",
        text="the friction coefficient is limited, because the base must slide this part on the "
        "ground to drive or turn",
        size="coefficients",
    ),
    "minimum-inertia": _Report(
        code=world_codes.INERTIA_RAISED,
        elements="links",
        text="the smallest moment of inertia is raised, because the physics engine requires a "
        "positive value",
        size="moments",  # kg m²
    ),
    "apart-hulls": _Report(
        code=world_codes.HULLS_APART,
        elements="links",
        text="the convex hulls of their meshes overlap while all joints are at 0, so these links "
        "do not collide with each other",
        size="partners",  # number of links whose hulls overlap with that of the link
    ),
}
"""The additions that are reported by the load of a model, in this order.

The others have codes of their own: CW477 effort-limit-too-low and CW615 models-overlap.
"""


def omitted(names: Iterable[str]) -> frozenset[Addition]:
    """The additions with these names; ``all`` stands for all of them.

    Raises:
        CartwheelError: A name is unknown.
    """
    found: set[Addition] = set()
    for name in names:
        known = ADDITIONS if name == ALL else [each for each in ADDITIONS if each == name]
        if not known:
            raise CartwheelError(
                f'"{name}" is not an addition to the physics',
                code=command.OPTION_INVALID,
                hint=suggestion(name, (*ADDITIONS, ALL)),
                values={"option": str(WITHOUT), "value": name},
            )
        found.update(known)
    return frozenset(found)


def reports(added: Collection[Added], model: str) -> Iterator[Diagnostic]:
    """What was added to a model: a diagnostic for each kind, at the first element."""
    for addition, report in _REPORTS.items():
        own = [each for each in added if each.model == model and each.addition == addition]
        if not own:
            continue
        names = ", ".join(f'"{each.element}"' for each in own[:3])
        more = f" and {len(own) - 3} more" if len(own) > 3 else ""
        kind = report.elements if len(own) > 1 else report.elements.removesuffix("s")
        yield report.code.diagnostic(
            f"{kind} {names}{more}: {report.text}",
            origin=own[0].origin,
            hint=f"To omit it, pass {WITHOUT.given(addition)}.",
            values={
                "model": model,
                report.elements: tuple(each.element for each in own),
                report.size: tuple(each.value for each in own),
            },
        )
