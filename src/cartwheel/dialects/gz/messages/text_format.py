"""Messages in the text format of Protocol Buffers, as ``gz topic`` writes and reads them."""

from __future__ import annotations

import re
from typing import Any

_TOKEN = re.compile(
    r"""\s*(?:\#[^\n]*\s*)*(?:
    (?P<text>"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')
    |(?P<number>[-+]?(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf|nan)f?(?![\w.]))
    |(?P<word>[A-Za-z_]\w*)
    |(?P<mark>[:{}<>\[\],;])
    |(?P<end>$)
    )""",
    re.VERBOSE,
)
_CLOSING = {"{": "}", "<": ">"}
_DEEPEST = 32
_LARGEST = 2**64 - 1
"""Of integers."""
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}


class TextFormatError(ValueError):
    """A text that is not a message in text format."""


def parse_text_format(text: str) -> dict[str, Any]:
    """Returns the fields of a message such as ``linear: {x: 0.5} data: true``.

    Fields that are repeated become lists.

    Raises:
        TextFormatError: The text is not a message.
    """
    return _Parser(text).fields("")


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._depth = 0
        self._next()

    def _next(self) -> None:
        found = _TOKEN.match(self._text, self._at)
        if found is None:
            raise self._error()
        self._kind = str(found.lastgroup)
        self._value = found.group(self._kind)
        self._at = found.end()

    def _error(self) -> TextFormatError:
        rest = self._text[self._at :].strip()[:20]
        return TextFormatError(f'unexpected text before "{rest}"' if rest else "unexpected end")

    def _take(self, mark: str) -> bool:
        taken = self._kind == "mark" and self._value == mark
        if taken:
            self._next()
        return taken

    def fields(self, closing: str) -> dict[str, Any]:
        """Reads fields up to a closing bracket, or to the end of the text if it is empty."""
        found: dict[str, Any] = {}
        self._depth += 1
        if self._depth > _DEEPEST:
            raise TextFormatError(f"messages are nested more than {_DEEPEST} times")
        while self._kind == "word":
            name = self._value
            self._next()
            value = self._value_after(colon=self._take(":"))
            if name not in found:
                found[name] = value
            else:
                before = found[name] if isinstance(found[name], list) else [found[name]]
                found[name] = [*before, *(value if isinstance(value, list) else [value])]
            if not self._take(","):
                self._take(";")
        self._depth -= 1
        if closing and not self._take(closing):
            raise self._error()
        if not closing and self._kind != "end":
            raise self._error()
        return found

    def _value_after(self, *, colon: bool) -> Any:
        for opening, closing in _CLOSING.items():
            if self._take(opening):
                return self.fields(closing)
        if not colon:
            raise self._error()
        if self._take("["):
            items: list[Any] = []
            while not self._take("]"):
                items.append(self._value_after(colon=True))
                self._take(",")
                if self._kind == "end":
                    raise self._error()
            return items
        return self._scalar()

    def _scalar(self) -> Any:
        kind, value = self._kind, self._value
        if kind == "text":
            parts = []
            while self._kind == "text":
                # Adjacent texts are one.
                parts.append(_unescaped(self._value[1:-1]))
                self._next()
            return "".join(parts)
        if kind == "number":
            self._next()
            return _number(value)
        if kind == "word":
            self._next()
            return {"true": True, "false": False}.get(value, value)
        raise self._error()


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", lambda found: _ESCAPES.get(found[1], found[1]), text)


def _number(text: str) -> float | int:
    if text.lower().lstrip("+-").startswith("0x"):
        value = int(text, 16)
        if abs(value) > _LARGEST:
            raise TextFormatError(f'"{text[:20]}" has more than 64 bits')
        return value
    text = text.rstrip("f") if not text.endswith("inf") else text
    try:
        value = int(text)
    except ValueError:
        return float(text)
    return value if abs(value) <= _LARGEST else float(text)
