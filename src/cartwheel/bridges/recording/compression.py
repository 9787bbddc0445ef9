"""How chunks are packed. The packers come with rosbags, and are imported when they are needed."""

from __future__ import annotations

import sys
from typing import Any


def _zstd() -> Any:
    if sys.version_info >= (3, 14):
        from compression import zstd
    else:
        from backports import zstd
    return zstd


def compress(data: bytes, *, level: int) -> bytes:
    """Bytes as zstd packs them."""
    packed: bytes = _zstd().compress(data, level=level)
    return packed


def decompress(data: bytes, kind: str) -> bytes:
    """Bytes as they were before ``zstd``, ``lz4``, ``bz2`` or nothing (``""``, ``none``).

    Raises:
        ValueError: They are damaged, or the kind is unknown.
    """
    if kind in ("", "none"):
        return data
    if kind == "zstd":
        zstd = _zstd()
        try:
            return bytes(zstd.decompress(data))
        except zstd.ZstdError as error:
            raise ValueError(str(error)) from error
    if kind == "lz4":
        from lz4 import frame

        try:
            return bytes(frame.decompress(data))
        except RuntimeError as error:
            raise ValueError(str(error)) from error
    if kind == "bz2":
        import bz2

        try:
            return bz2.decompress(data)
        except OSError as error:
            raise ValueError(str(error)) from error
    raise ValueError(f'"{kind}" is no compression that is known')
