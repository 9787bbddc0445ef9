"""Which existing name a wrong one stands for: near enough to be written in its place."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable, Mapping

from cartwheel.errors import Code, Diagnostic, Origin, Value

_LETTERS_AN_ERROR = 6
"""So many letters may hold one slip of the keyboard."""
_MOST_ERRORS = 2
_SHORTEST_WORD = 3
"""Letters of a word that can hold a slip."""
_SHORTEST = 4
"""Letters of a part that is enough to know the whole by."""
_SHOWN = 4
_LISTED = 12
_LONGEST = 100
"""Letters of a name that may be misspelt."""
_MOST_COMPARED = 1000


def meant(name: str, known: Collection[str], *, parts: bool = True) -> str:
    """The one name that was meant; empty where none or several could be.

    A slip of the keyboard, another case or other separators, a prefix or suffix too many or too
    few: all else is another name, which nobody should write instead.

    Args:
        name: As it is written.
        known: Those that exist.
        parts: Whether a prefix or suffix may be what is wrong.
    """
    if not name or name in known:
        return ""
    names = _comparable(name, known)
    plain = _plain(name)
    alike = [each for each in names if _plain(each) == plain]
    if alike:
        return alike[0]
    allowed = min(_MOST_ERRORS, max(1, len(plain) // _LETTERS_AN_ERROR))
    # Another number is another name: joint_4 is no misspelt joint_3.
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
    """A sentence for where no name is surely meant: the nearest ones, or those that exist."""
    names = sorted(set(known) - {""})
    close = difflib.get_close_matches(name, _comparable(name, known), n=_SHOWN, cutoff=0.5)
    shown = ", ".join(close or names[:_LISTED])
    if not names:
        return "None exist."
    if close:
        return f"Similar names: {shown}."
    return f"Known names: {shown}{', …' if len(names) > _LISTED else ''}."


def _comparable(name: str, known: Iterable[str]) -> list[str]:
    """Names among which another is looked for; the time grows with their number and length."""
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
    """The diagnostic for an attribute whose name does not exist, with the name that was meant.

    Args:
        code: Its kind.
        name: As it is written.
        known: Those that exist.
        attribute: In which it stands.
        message: What is wrong.
        origin: Where.
        mark: What of the line it is about.
        values: What the message names; ``meant`` is added.
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
    """Whether no word of a name is another word: arm_l is no slip of arm_r, nor of arm_pi_r."""
    ours, theirs = (re.findall(r"[0-9a-z]+", each.lower()) for each in (name, other))
    if len(ours) != len(theirs):
        # A separator too many or too few, and the letters nearly the same.
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
    """Whether a name is the whole of another but for a prefix or a suffix."""
    if len(short) < _SHORTEST:
        return False
    # A number at its end makes it another: caster_2 is not caster.
    return bool(re.search(rf"(^|[_/:.]){re.escape(short)}($|[_/:.](?!\d+$))", long))


def _errors(a: str, b: str, most: int) -> int:
    """Letters that are wrong, missing, too many or swapped; more than `most` counts as one more."""
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
