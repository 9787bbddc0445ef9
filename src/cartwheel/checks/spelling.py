"""Finds the existing name that a wrong name probably means."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable, Mapping

from cartwheel.errors import Code, Diagnostic, Origin, Value

_LETTERS_AN_ERROR = 6
"""Letters in a name for each allowed typing error."""
_MOST_ERRORS = 2
_SHORTEST_WORD = 3
"""Minimum letters in a word that may contain a typing error."""
_SHORTEST = 4
"""Minimum letters in a part that identifies the whole name."""
_SHOWN = 4
_LISTED = 12
_LONGEST = 100
"""Maximum letters in a name that is compared."""
_MOST_COMPARED = 1000


def meant(name: str, known: Collection[str], *, parts: bool = True) -> str:
    """The one existing name that was probably meant; empty if there is none or several.

    Accepted differences are typing errors, letter case, separators and an additional or missing
    prefix or suffix. Any other difference makes it a different name.

    Args:
        name: The name in the file.
        known: Existing names.
        parts: Whether an additional or missing prefix or suffix is accepted.
    """
    if not name or name in known:
        return ""
    names = _comparable(name, known)
    plain = _plain(name)
    alike = [each for each in names if _plain(each) == plain]
    if alike:
        return alike[0]
    allowed = min(_MOST_ERRORS, max(1, len(plain) // _LETTERS_AN_ERROR))
    # A different number is a different name: joint_4 is not a misspelt joint_3.
    digits = re.findall(r"\d+", name)
    slips = sorted(
        (errors, each)
        for each in names
        if re.findall(r"\d+", each) == digits
        and _words_alike(name, each)
        and (errors := _errors(plain, _plain(each), allowed)) <= allowed
    )
    if slips and (len(slips) == 1 or slips[0][0] < slips[1][0]):
        return slips[0][1]
    held = [each for each in names if _is_part(name, each) or _is_part(each, name)]
    return held[0] if parts and len(held) == 1 and not slips else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """A sentence with the nearest names, or all existing names, if none was clearly meant."""
    names = sorted(set(known) - {""})
    close = difflib.get_close_matches(name, _comparable(name, known), n=_SHOWN, cutoff=0.5)
    shown = ", ".join(close or names[:_LISTED])
    if not names:
        return "Existing names: none."
    if close:
        return f"Similar names: {shown}."
    return f"Existing names: {shown}{', …' if len(names) > _LISTED else ''}."


def _comparable(name: str, known: Iterable[str]) -> list[str]:
    """Limits the names to compare: the time grows with their number and length."""
    if len(name) > _LONGEST:
        return []
    near = {each for each in known if each and abs(len(each) - len(name)) <= _LONGEST}
    return sorted(near)[:_MOST_COMPARED]


def misspelt(
    code: Code,
    name: str,
    known: Collection[str],
    *,
    attribute: str,
    message: str,
    origin: Origin | None,
    mark: str,
    values: Mapping[str, Value],
) -> Diagnostic:
    """The diagnostic for an attribute with an unknown name, with the name that was meant.

    Args:
        code: The diagnostic's code.
        name: The name in the file.
        known: Existing names.
        attribute: The attribute that contains the name.
        message: What is wrong.
        origin: File and line.
        mark: The text in the line to underline.
        values: Names and numbers in the message; ``meant`` is added.
    """
    near = meant(name, known)
    return code.diagnostic(
        message=message,
        origin=origin,
        values={**values, "meant": near},
        instead=f'{attribute}="{near}"' if near else "",
        place="attribute" if near else "",
        mark=mark,
        hint="" if near else nearest(name, known),
    )


def _words_alike(name: str, other: str) -> bool:
    """Whether all words match: arm_l is not a misspelt arm_r or arm_pi_r."""
    ours, theirs = (re.findall(r"[0-9a-z]+", each.lower()) for each in (name, other))
    if len(ours) != len(theirs):
        # One separator more or less, with nearly the same letters.
        return len(_plain(name)) == len(_plain(other))
    return all(
        a == b
        or (
            min(len(a), len(b)) >= _SHORTEST_WORD
            and _errors(a, b, _MOST_ERRORS) < max(len(a), len(b)) / 2
        )
        for a, b in zip(ours, theirs, strict=True)
    )


def _plain(name: str) -> str:
    return re.sub(r"[^0-9a-z]", "", name.lower())


def _is_part(short: str, long: str) -> bool:
    """Whether two names differ only by a prefix or suffix."""
    if len(short) < _SHORTEST:
        return False
    # A trailing number makes a different name: caster_2 is not caster.
    return bool(re.search(rf"(^|[_/:.]){re.escape(short)}($|[_/:.](?!\d+$))", long))


def _errors(a: str, b: str, most: int) -> int:
    """Number of wrong, missing, additional or swapped letters, up to `most` + 1."""
    if abs(len(a) - len(b)) > most:
        return most + 1
    before: list[int] = []
    last = list(range(len(b) + 1))
    for i, letter in enumerate(a, 1):
        row = [i]
        for j, other in enumerate(b, 1):
            cost = min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == b[j - 2] and a[i - 2] == other:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        if min(row) > most:
            return most + 1
        before, last = last, row
    return last[-1]
