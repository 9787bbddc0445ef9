"""The single commands in the command line of a process, which may be one for a shell."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

_BETWEEN = re.compile(r"&&|\|\||[;&|\n]")
"""What separates commands."""
_SHELLS = frozenset({"bash", "sh", "dash", "zsh"})
_PREFIXES = frozenset({"exec", "sudo", "then", "do"})
_QUOTES = "'\""


def shell_commands(words: Iterable[str]) -> Iterator[list[str]]:
    """The words of each command, without quotes, such as two in ``bash -c "sleep 5; ros2 run …"``.

    Args:
        words: The command line, of which each word may contain several.
    """
    for text in _BETWEEN.split(" ".join(words)):
        parts = [stripped for part in text.split() if (stripped := part.strip(_QUOTES))]
        while parts and parts[0] in _PREFIXES:
            parts = parts[1:]
        if parts and parts[0].rpartition("/")[2] in _SHELLS:
            # The options of the shell, such as -lc, precede the command.
            while parts and (parts[0].startswith("-") or parts[0].rpartition("/")[2] in _SHELLS):
                parts = parts[1:]
        if parts:
            yield parts
