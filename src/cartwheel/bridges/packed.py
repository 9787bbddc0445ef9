"""A message that is still serialised."""

from __future__ import annotations

from typing import Any

from cartwheel.messages import decode_cdr


class Packed:
    """A serialised message. It is decoded when one of its fields is first read.

    Attributes:
        cdr: CDR bytes.
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
