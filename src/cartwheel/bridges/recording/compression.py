"""Compression of chunks. The libraries come with rosbags, and are imported when first used."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

MOST_BYTES = 1 << 28
"""Maximum uncompressed size of a chunk in bytes: a hundred times the usual size of a chunk, and
enough for four large point clouds."""


class TooLargeError(ValueError):
    """Decompressed data that exceeds `MOST_BYTES`."""


def _zstd() -> Any:
    if sys.version_info >= (3, 14):
        from compression import zstd
    else:
        from backports import zstd
    return zstd


def prepare() -> None:
    """Imports what `compress` needs, which may be slow on a busy machine."""
    _zstd()


def compress(data: bytes, *, level: int) -> bytes:
    """Compresses bytes with zstd."""
    packed: bytes = _zstd().compress(data, level=level)
    return packed


def decompress(data: bytes, kind: str) -> bytes:
    """Decompresses bytes. The kind is ``zstd``, ``lz4``, ``bz2``, ``none`` or empty.

    Raises:
        TooLargeError: The decompressed data exceeds `MOST_BYTES`.
        ValueError: The data is damaged, or the kind is unknown.
    """
    if kind in ("", "none"):
        return data
    make, damage = _unpacker(kind)
    try:
        return _unpacked(data, make)
    except damage as error:
        raise ValueError(str(error)) from error


def _unpacker(kind: str) -> tuple[Callable[[], Any], type[Exception]]:
    """Creates an incremental decompressor for one frame. Returns it with its error class."""
    if kind == "zstd":
        zstd = _zstd()
        return zstd.ZstdDecompressor, zstd.ZstdError
    if kind == "lz4":
        from lz4 import frame

        return frame.LZ4FrameDecompressor, RuntimeError
    if kind == "bz2":
        import bz2

        return bz2.BZ2Decompressor, OSError
    raise ValueError(f'the compression "{kind}" is not supported')


def _unpacked(data: bytes, make: Callable[[], Any]) -> bytes:
    parts: list[bytes] = []
    left = MOST_BYTES
    while data:
        unpacker = make()
        while not unpacker.eof:
            if unpacker.needs_input and not data:
                raise ValueError("the compressed data is truncated")
            parts.append(unpacker.decompress(data, left + 1))
            left -= len(parts[-1])
            data = b""
            if left < 0:
                raise TooLargeError(f"the decompressed data exceeds {MOST_BYTES >> 20} MiB")
        data = unpacker.unused_data or b""
    return b"".join(parts)
