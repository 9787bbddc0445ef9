"""What a check finds."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.errors import Diagnostic, Origin, Place, Severity


@dataclass(frozen=True, kw_only=True, slots=True)
class Remark:
    """What a rule has to say, before it is known under which rule."""

    message: str
    origin: Origin | None
    instead: str = ""
    place: Place = ""
    mark: str = ""
    hint: str = ""
    severity: Severity | None = None
    """Where it differs from the rule's."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding(Diagnostic):
    """Something in a description that breaks or misleads."""

    rule: str
