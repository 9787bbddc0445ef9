"""A message that is still as it came from elsewhere."""

from __future__ import annotations

from typing import Any

from cartwheel.messages import decode_cdr


class Packed:
    """A message as bytes; its fields are there for who asks for one.

    Attributes:
        cdr: The bytes.
    """

    __slots__ = ("_made", "_type", "cdr")

    def __init__(self, data: bytes, type_name: str) -> None:
        self.cdr = data
        self._type = type_name
        self._made: Any = None

    def __getattr__(self, name: str) -> Any:
        if self._made is None:
            self._made = decode_cdr(self.cdr, self._type)
        return getattr(self._made, name)
