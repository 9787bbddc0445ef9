"""Proportional gains, compared with the friction of their joints."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic, Origin

ANGLE, LENGTH = 0.2, 0.02
"""Distance from the target at which a controller should move a joint, rad and m."""
SLOW = 5.0
"""Time after which an integral counts as too slow, s."""


def gain_too_low(
    joint: Joint, gain: float, origin: Origin | None, **place: Any
) -> Iterator[Diagnostic]:
    """The finding that a proportional gain does not overcome a joint's friction.

    Args:
        joint: The joint.
        gain: N m/rad or N/m.
        origin: Where the gain is stated.
        place: More arguments of the diagnostic.
    """
    slides = joint.type == "prismatic"
    way = LENGTH if slides else ANGLE
    effort, friction = gain * way, joint.axis.friction
    if not 0.0 < effort < friction:
        return
    unit, length = ("N", "m") if slides else ("N m", "rad")
    yield CONTROLLER_GAIN_TOO_LOW.diagnostic(
        f"the proportional gain of {gain:g} {unit}/{length} results in {effort:.3g} {unit} at "
        f"{way:g} {length} from the target, which does not overcome the friction of joint "
        f'"{joint.name}", {friction:g} {unit}',
        values={"joint": joint.name, "gain": gain, "friction": friction},
        origin=origin,
        hint=f"Use a gain well above {friction / way:.3g} {unit}/{length}, or an integral gain.",
        **place,
    )
