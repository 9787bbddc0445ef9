"""Topic patterns."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Sequence

from cartwheel.codes.recording import TOPIC_PATTERN_INVALID
from cartwheel.errors import RecordingError

_REGULAR = "re:"


class Patterns:
    """Topic patterns: names with ``*`` and ``?``, or ``re:`` and a regular expression.

    A regular expression must match the whole name. A pattern with a leading ``!`` excludes topics.
    Without other patterns, all topics match.

    Args:
        patterns: Patterns from the user.

    Raises:
        RecordingError: A pattern is empty, or an invalid regular expression.
    """

    def __init__(self, patterns: Sequence[str] = ()) -> None:
        self._wanted: dict[str, re.Pattern[str]] = {}
        self._unwanted: list[re.Pattern[str]] = []
        self._matched: set[str] = set()
        for pattern in patterns:
            if pattern.startswith("!"):
                self._unwanted.append(_compiled(pattern[1:]))
            else:
                self._wanted[pattern] = _compiled(pattern)

    def match(self, topic: str) -> bool:
        """Whether a topic is selected."""
        if any(pattern.fullmatch(topic) for pattern in self._unwanted):
            return False
        if not self._wanted:
            return True
        found = [name for name, pattern in self._wanted.items() if pattern.fullmatch(topic)]
        self._matched.update(found)
        return bool(found)

    @property
    def unmatched(self) -> list[str]:
        """Patterns that no topic has matched so far."""
        return [name for name in self._wanted if name not in self._matched]


def _compiled(pattern: str) -> re.Pattern[str]:
    if pattern.startswith(_REGULAR):
        try:
            return re.compile(pattern.removeprefix(_REGULAR))
        except re.error as error:
            raise RecordingError(
                f'"{pattern}" is not a regular expression: {error}',
                code=TOPIC_PATTERN_INVALID,
                values={"pattern": pattern},
            ) from None
    if not pattern:
        raise RecordingError(
            "an empty pattern matches no topic", code=TOPIC_PATTERN_INVALID, values={"pattern": ""}
        )
    name = pattern if pattern[0] in "/*?[" else f"/{pattern}"
    return re.compile(fnmatch.translate(name))
