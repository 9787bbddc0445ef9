"""Suggestions: the existing name that is most similar to an unknown one."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterable, Sequence

SIMILAR = 0.6
"""Minimum similarity of two names for a suggestion."""
_SIMILAR_END = 0.8
"""The same for the last parts of two names."""
LONGEST = 500
"""Maximum length of a name that is shown in full and compared with other names."""


def meant_one(name: str, existing: Iterable[str], *, cutoff: float = 0.75) -> str:
    """The most similar name in `existing`, or an empty string."""
    close = closest(name, existing, cutoff)
    return close[0] if close else ""


def meant(name: str, existing: Iterable[str]) -> str:
    """The name that `suggestion` suggests; empty if no name is similar."""
    return meant_one(name, existing, cutoff=SIMILAR)


def suggestion(name: str, existing: Iterable[str]) -> str:
    """A sentence that suggests the most similar name in `existing`, or lists all names."""
    known = list(existing)
    return suggested(closest(name, known, SIMILAR), known)


def suggested(close: Sequence[str], known: Sequence[str]) -> str:
    if not known:
        return "Valid names: none."
    if close:
        return f'Did you mean "{close[0]}"?'
    shown = ", ".join(known[:12])
    return f"Valid names: {shown}{', …' if len(known) > 12 else ''}."


def closest(name: str, known: Iterable[str], cutoff: float) -> list[str]:
    """The most similar name; empty for overlong names, which remote clients may send.

    The last results are kept: an error may recur for each message, and to compare with all types
    of messages takes 10 ms.

    Of the names of topics, those that end with all of the name are the most similar ones:
    ``/base/odom`` for ``/odom``, with the fewest parts. If none is similar, those with a similar
    last part: ``/base/odom`` for ``/odm``.
    """
    return [] if len(name) > LONGEST else list(_closest(name, tuple(known), cutoff))


@functools.lru_cache(maxsize=64)
def _closest(name: str, known: tuple[str, ...], cutoff: float) -> tuple[str, ...]:
    if "/" in name:
        end = f"/{name.strip('/')}"
        scoped = [each for each in known if len(each) <= LONGEST and each.endswith(end)]
        if scoped and name not in known:
            return (min(scoped, key=lambda each: (each.count("/"), each)),)
    best = most_similar(name, known, cutoff)
    if best is None and "/" in name:
        ends: dict[str, str] = {}
        for each in sorted(known, key=lambda each: (each.count("/"), each)):
            ends.setdefault(each[:LONGEST].rpartition("/")[2], each)
        last = most_similar(name.rpartition("/")[2], ends, max(cutoff, _SIMILAR_END))
        best = None if last is None else ends[last]
    return (best,) if best is not None else ()


def most_similar(name: str, known: Iterable[str], cutoff: float) -> str | None:
    """The first name that `difflib.get_close_matches` finds, and None if it finds none.

    difflib compares a name with all that may be similar enough. This compares it with the most
    promising ones first, and leaves out those that cannot be more similar than the best one.
    """
    matcher = difflib.SequenceMatcher()
    matcher.set_seq2(name)
    promising = []
    for each in known:
        matcher.set_seq1(each)
        if matcher.real_quick_ratio() >= cutoff and (bound := matcher.quick_ratio()) >= cutoff:
            promising.append((bound, each))
    best: tuple[float, str] | None = None
    for bound, each in sorted(promising, reverse=True):
        if best is not None and bound < best[0]:
            break
        matcher.set_seq1(each)
        ratio = matcher.ratio()
        if ratio >= cutoff and (best is None or (ratio, each) > best):
            best = ratio, each
    return best[1] if best is not None else None
