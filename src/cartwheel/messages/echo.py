"""Messages as text, in the format of ``rostopic echo``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields

SHOWN = 64
"""Maximum number of array elements to print: enough for a covariance, but not for an image."""

_PLAIN = re.compile(r"[A-Za-z_/][\w/.-]*(::[\w/.-]+)*\Z")
_WORDS = {"true", "false", "yes", "no", "on", "off", "null", "y", "n", "nan", "inf"}


def to_yaml(message: Any, *, full: bool = False, arrays: bool = True) -> str:
    """A message as YAML in the layout of ``rostopic echo``, with a final line break.

    Args:
        message: A message, or a field of a message.
        full: Whether to print long arrays completely instead of `SHOWN` elements and ``...``.
        arrays: Whether to print arrays; otherwise only their type and length.
    """
    if not hasattr(message, "__msgtype__"):
        return _bare(message, full=full)
    return "".join(f"{line}\n" for line in _lines(message, "", full=full, arrays=arrays))


def _bare(value: Any, *, full: bool) -> str:
    """A single field, for ``--field``."""
    if isinstance(value, str):
        return f"{_text(value)}\n"
    if isinstance(value, list) and value and hasattr(value[0], "__msgtype__"):
        return "".join(f"- {to_yaml(item, full=full).replace(chr(10), chr(10) + '  ').rstrip()}\n"
                       for item in value)  # fmt: skip
    if hasattr(value, "__len__"):
        return f"{_list(value, full=full)}\n"
    return f"{_number(value)}\n"


def _lines(message: Any, indent: str, *, full: bool, arrays: bool) -> Iterator[str]:
    for field in fields(message.__msgtype__):
        value = getattr(message, field.name)
        start = f"{indent}{field.name}:"
        if field.array:
            yield from _array(field, value, indent, full=full, arrays=arrays)
        elif field.kind == "message":
            # rostopic prints the space after the colon. Tools compare its output line by line.
            inner = list(_lines(value, indent + "  ", full=full, arrays=arrays))
            yield f"{start} " if inner else f"{start} {{}}"
            yield from inner
        elif field.kind == "string":
            yield f"{start} {_text(value)}"
        else:
            yield f"{start} {_number(value)}"


def _array(field: Field, value: Any, indent: str, *, full: bool, arrays: bool) -> Iterator[str]:
    start = f"{indent}{field.name}:"
    if not arrays:
        yield f'{start} "<array of {field.type}, {len(value)} long>"'
    elif len(value) == 0:
        yield f"{start} []"
    elif field.kind == "message":
        yield f"{start} "
        for item in value:
            yield f"{indent}  - "
            yield from _lines(item, indent + "    ", full=full, arrays=arrays)
    elif field.kind == "string":
        yield f"{start} "
        for item in value:
            yield f"{indent}  - {item if _is_plain(item) else _quoted(item)}"
    else:
        yield f"{start} {_list(value, full=full)}"


def _list(value: Any, *, full: bool) -> str:
    shown = value if full else value[:SHOWN]
    items = shown.tolist() if hasattr(shown, "tolist") else shown
    more = ["..."] if len(items) < len(value) else []
    return f"[{', '.join([*map(_number, items), *more])}]"


def _number(value: Any) -> str:
    if hasattr(value, "item"):
        value = value.item()
    return str(value)


def _text(value: str) -> str:
    return _quoted(value) if value else "''"


def _quoted(value: str) -> str:
    # JSON strings are valid double-quoted YAML strings, except for unprintable characters.
    text = json.dumps(value, ensure_ascii=False)
    return re.sub(
        "[\x7f-\x9f\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff]",
        lambda match: f"\\u{ord(match[0]):04x}",
        text,
    )


def _is_plain(value: str) -> bool:
    return bool(_PLAIN.match(value)) and value.lower() not in _WORDS
