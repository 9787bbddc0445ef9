"""Reads STL files, binary and ASCII."""

from __future__ import annotations

import re

import numpy as np

from cartwheel.description.meshes.submesh import Submesh, build_submesh, has_area, unique_rows

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_FIRST = 100
"""Triangles at which `glance` looks for one with an area."""
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def read_stl(data: bytes) -> list[Submesh]:
    """The file's triangles as one submesh with merged corners.

    Facet normals are ignored: they are often zero and can be computed from the corners.

    Raises:
        ValueError: What is wrong with the file.
    """
    corners = _read_ascii(data) if _is_ascii(data) else _read_binary(data)
    if not np.isfinite(corners).all():
        raise ValueError("a vertex coordinate is not finite")
    first, inverse = unique_rows(corners)
    submesh = build_submesh("", corners[first], inverse.reshape(-1, 3))
    return [submesh] if submesh else []


def glance(data: bytes, most: int) -> float | None:
    """The least size of a mesh, if a short look at its file shows that the file is valid.

    A look takes a tenth of the time of `read_stl`.

    Args:
        data: The file.
        most: Maximum number of triangles.

    Returns:
        The size of the largest of the first triangles along an axis, in the file's unit, if
        `read_stl` surely returns triangles; otherwise None.
    """
    if len(data) < _HEADER or _is_ascii(data):
        return None
    count = int.from_bytes(data[80:84], "little")
    if not 0 < count <= min((len(data) - _HEADER) // _RECORD.itemsize, most):
        return None
    corners = np.frombuffer(data, dtype=_RECORD, count=count, offset=_HEADER)["corners"]
    if not np.isfinite(corners).all():
        return None
    first = np.ascontiguousarray(corners[:_FIRST]).reshape(-1, 3)
    proper = has_area(first, np.arange(len(first)).reshape(-1, 3))
    if not proper.any():
        return None
    sizes = np.ptp(first.reshape(-1, 3, 3)[proper], axis=1)
    return float(sizes.max())


def _is_ascii(data: bytes) -> bool:
    """Whether the file is ASCII. Binary files may also begin with "solid", so the size decides."""
    if data.lstrip()[:5].lower() != b"solid":
        return False
    if len(data) >= _HEADER:
        count = int.from_bytes(data[80:84], "little")
        if len(data) == _HEADER + count * _RECORD.itemsize:
            return False
    return b"\0" not in data[:_HEADER] or b"facet" in data[:1024].lower()


def _read_binary(data: bytes) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    if len(data) < _HEADER:
        raise ValueError(
            f"the file is not an STL file: it has {len(data)} bytes, fewer than the "
            f"{_HEADER}-byte header"
        )
    count = int.from_bytes(data[80:84], "little")
    present = (len(data) - _HEADER) // _RECORD.itemsize
    if count > present:
        raise ValueError(
            f"the file is truncated: it declares {count} triangles but contains {present}"
        )
    records = np.frombuffer(data, dtype=_RECORD, count=count, offset=_HEADER)
    return records["corners"].reshape(-1, 3).astype(np.float32)


def _read_ascii(data: bytes) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    found = _VERTEX.findall(data)
    if len(found) % 3:
        raise ValueError(
            f"the file is truncated: its {len(found)} vertices do not form complete triangles"
        )
    try:
        return np.array(found, dtype="S").astype(np.float32).reshape(-1, 3)
    except ValueError:
        wrong = next((n for row in found for n in row if not _is_number(n)), b"?")
        raise ValueError(f'"{wrong[:40].decode(errors="replace")}" is not a number') from None


def _is_number(text: bytes) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
