"""What a check finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cartwheel.errors import Diagnostic, Origin, Severity

Place = Literal["", "element", "attribute", "inside", "after", "line"]
"""Where a finding's text goes.

``element`` replaces the element at the finding's line; ``attribute`` replaces its attribute of
the same name, or is added to it; ``inside`` goes in before its closing tag; ``after`` follows
it. In YAML ``line`` replaces what its line says behind the indentation, and ``after`` is a line of
its own below, with the same indentation. Empty is for a text that says what to write, but not
where.
"""


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
    instead: str = ""
    """The text to write."""
    place: Place = ""
    mark: str = ""
    """What in the source's line it is about, for the caret; empty for the whole tag."""
    hint: str = ""
    """The likely fix as a sentence, where no text says it."""
    also: tuple[str, ...] = ()
    """Further messages of the same kind, which the same line of a macro makes."""
