"""What a fuzz target is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random

from tests.campaign import mutating

Mutate = Callable[[bytes, Sequence[bytes], Random], bytes]
"""From an input, all inputs of the corpus, and the source of chance, to a new input."""


class FaultError(AssertionError):
    """What a target found wrong itself, such as a run that no longer answers."""


@dataclass(frozen=True, kw_only=True)
class Target:
    """One reader of inputs.

    Any exception beyond `allowed`, a traceback on stdout or stderr, more time or memory than
    stated, or the death of the process is a finding.
    """

    name: str
    seeds: Callable[[], list[bytes]]
    """Valid inputs, from which others are made."""
    run_one: Callable[[bytes], object]
    """Reads one input."""
    allowed: tuple[type[Exception], ...] = ()
    """Errors that are a proper answer to a bad input."""
    seconds: float = 5.0
    """CPU time that one input may take; ten times as much of wall time, at least 60 s."""
    memory_mb: int | None = 1024
    """Address space on top of what the process has after the first seed; None: no limit."""
    mutate: Mutate = mutating.binary
    history: int = 0
    """Inputs before the last one that are saved with a finding, for targets that keep a state."""
    share: float = 1.0
    """Time that the target gets, relative to the others."""
    most_bytes: int = 1 << 16
    """Of an input."""
    notes: tuple[str, ...] = ()
    """Texts in a traceback's last line that are no finding, each with a reason in a comment."""
