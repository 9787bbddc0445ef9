"""Reads Wavefront OBJ files and their material libraries."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.meshes.corners import weld
from cartwheel.description.meshes.number_text import floats_of, integers_of
from cartwheel.description.meshes.submesh import Submesh
from cartwheel.description.model import Rgba

_LINES = re.compile(rb"(?P<key>v[tn]?|f) [^\n]*+\n(?:(?P=key) [^\n]*+\n)*+|[^\n]*+\n")
"""A line, or several lines with the same key."""
_KEYS = b"vtn"
_TO_SPACES = bytes.maketrans(b"f/", b"  ")
_IGNORED = frozenset({"s", "l", "p", "vp", "#", "mg"})


@dataclass(slots=True)
class _Material:
    rgba: Rgba | None = None
    texture: Path | None = None


@dataclass(slots=True)
class _Group:
    """Faces with the same object or group, and material, as lines with absolute indices."""

    name: str
    material: str
    faces: list[bytes] = field(default_factory=list)


@dataclass(slots=True)
class _Table:
    """The statements of one kind."""

    lines: list[bytes] = field(default_factory=list)
    """Each is one or several lines."""
    count: int = 0

    def add(self, lines: bytes) -> None:
        self.lines.append(lines)
        self.count += lines.count(b"\n")


def read_obj(path: Path, data: bytes, notes: list[str]) -> list[Submesh]:
    """One submesh for each object or group, and material.

    Args:
        path: The file; its libraries and images are relative to it.
        data: Its contents.
        notes: Receives notes about skipped parts.

    Raises:
        ValueError: What is wrong with the file.
    """
    tables = {key: _Table() for key in (b"v", b"vt", b"vn")}
    groups: dict[tuple[str, str], _Group] = {}
    libraries: list[str] = []
    name, material = "", ""
    whole = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ") + b"\n"
    for found in _LINES.finditer(whole):
        lines = found[0]
        key, _, rest = lines.strip().partition(b" ")
        if found["key"] is None and (key in tables or key == b"f"):
            lines = key + b" " + rest + b"\n"  # without spaces before the key
        if key in tables:
            tables[key].add(lines)
        elif key == b"f":
            group = groups.setdefault((name, material), _Group(name, material))
            group.faces.append(_absolute(lines, tables) if b"-" in lines else lines)
        elif key in (b"o", b"g"):
            # Gazebo starts a submesh at both.
            name = rest.strip().decode(errors="replace")
        elif key == b"usemtl":
            material = rest.strip().decode(errors="replace")
        elif key == b"mtllib":
            libraries.append(rest.strip().decode(errors="replace"))
        elif key and not key.startswith(b"#") and key.decode(errors="replace") not in _IGNORED:
            note = f'the statement "{key[:20].decode(errors="replace")}" is not supported'
            if note not in notes:
                notes.append(note)
    points = _table(tables[b"v"], 3, "v")
    uv = _table(tables[b"vt"], 2, "vt")
    normals = _table(tables[b"vn"], 3, "vn")
    materials = _materials(path, libraries, notes)
    result: list[Submesh] = []
    for group in groups.values():
        counts, corners = _corners(b"".join(group.faces))
        look = materials.get(group.material, _Material())
        has_uv = bool(len(uv)) and bool((corners[:, 1] >= 0).all())
        has_normals = bool(len(normals)) and bool((corners[:, 2] >= 0).all())
        submesh = weld(
            group.name or group.material,
            counts,
            (points, corners[:, 0]),
            uv=(uv, corners[:, 1]) if has_uv else None,
            normals=(normals, corners[:, 2]) if has_normals else None,
            rgba=look.rgba,
            texture=look.texture if has_uv else None,
        )
        if submesh is not None:
            result.append(submesh)
    return result


def _table(table: _Table, width: int, key: str) -> NDArray[np.float64]:
    """The numbers in all statements of one kind, without additional colours or weights."""
    if not table.count:
        return np.zeros((0, width))
    text = b"".join(table.lines)
    first, _, _ = text.partition(b"\n")
    # Letters of the keys within numbers are errors.
    letters = sum(map(text.count, (b"v", b"t", b"n")))
    if len(first.split()) == width + 1 and letters == len(key) * table.count:
        with contextlib.suppress(ValueError):
            values = floats_of(text.translate(None, _KEYS))
            if len(values) == width * table.count:
                return values.reshape(-1, width)
    try:
        rows = (line.split()[1 : width + 1] for line in text.split(b"\n")[:-1])
        return np.array([[float(word) for word in row] for row in rows], dtype=np.float64)
    except ValueError:
        raise ValueError(f'an OBJ "{key}" statement must contain {width} numbers') from None


def _absolute(lines: bytes, tables: Mapping[bytes, _Table]) -> bytes:
    """Converts negative indices of faces, which count back from the last statement."""
    return b"".join(
        b"f " + _absolute_face(line[2:], tables) + b"\n" for line in lines.split(b"\n")[:-1]
    )


def _absolute_face(face: bytes, tables: Mapping[bytes, _Table]) -> bytes:
    words = []
    for word in face.split():
        parts = word.split(b"/")
        for i, key in enumerate((b"v", b"vt", b"vn")[: len(parts)]):
            if parts[i].startswith(b"-"):
                parts[i] = str(tables[key].count + 1 + _index(parts[i])).encode()
        words.append(b"/".join(parts))
    return b" ".join(words)


def _index(word: bytes) -> int:
    try:
        return int(word)
    except ValueError:
        raise ValueError(f'"{word[:20].decode(errors="replace")}" is not an OBJ index') from None


def _corners(text: bytes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Corners of each face, and indices of v, vt and vn, shape (corners, 3); -1 if missing."""
    return _uniform_corners(text) or _any_corners(text)


def _uniform_corners(text: bytes) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """The corners of faces that all state the same kinds of indices; None for others."""
    characters = np.frombuffer(text, dtype=np.uint8)
    inside = characters > ord(" ")
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    lines = np.searchsorted(np.flatnonzero(characters == ord("\n")), starts)
    counts = np.bincount(lines) - 1  # without the key
    corners = starts[characters[starts] != ord("f")]
    slashes = np.searchsorted(corners, np.flatnonzero(characters == ord("/")), side="right") - 1
    per_corner = np.bincount(slashes[slashes >= 0], minlength=len(corners))
    if text.count(b"f") != len(counts) or not len(corners):
        return None
    if (per_corner != per_corner[0]).any() or per_corner[0] > 2:
        return None
    width = int(per_corner[0]) + 1
    try:
        plain = text.replace(b"//", b"/0/") if width == 3 else text
        numbers = integers_of(plain.translate(_TO_SPACES))
    except ValueError:
        return None
    if len(numbers) != width * len(corners) or len(corners) != counts.sum():
        return None
    indices = np.full((len(corners), 3), -1, dtype=np.int64)
    indices[:, :width] = numbers.reshape(-1, width) - 1
    return counts.astype(np.int64), indices


def _any_corners(text: bytes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    split = [line.split()[1:] for line in text.split(b"\n")[:-1]]
    counts = np.array([len(words) for words in split], dtype=np.int64)
    words = [word for row in split for word in row]
    corners = np.full((len(words), 3), -1, dtype=np.int64)
    for row, word in enumerate(words):
        for column, part in enumerate(word.split(b"/")[:3]):
            if part:
                corners[row, column] = _index(part) - 1
    return counts, corners


def _materials(path: Path, libraries: list[str], notes: list[str]) -> dict[str, _Material]:
    found: dict[str, _Material] = {}
    for library in libraries:
        file = path.parent / library
        try:
            text = read_regular_text(file)
        except (OSError, ValueError):
            notes.append(
                f'the material library "{library}" does not exist, so its colours are not used'
            )
            continue
        _read_library(file, text, found, notes)
    return found


def _read_library(file: Path, text: str, found: dict[str, _Material], notes: list[str]) -> None:
    current = _Material()
    for line in text.splitlines():
        key, _, rest = line.strip().partition(" ")
        rest = rest.strip()
        key = key.lower()
        if key == "newmtl":
            current = found.setdefault(rest, _Material())
        elif key == "kd":
            values = _fractions(rest, 3)
            alpha = current.rgba[3] if current.rgba else 1.0
            if values:
                current.rgba = (values[0], values[1], values[2], alpha)
        elif key in ("d", "tr"):
            values = _fractions(rest, 1)
            if values:
                r, g, b, _ = current.rgba or (0.8, 0.8, 0.8, 1.0)
                current.rgba = (r, g, b, values[0] if key == "d" else 1 - values[0])
        elif key == "map_kd":
            # Options precede the name, which may contain spaces.
            name = rest.split()[-1] if rest.startswith("-") else rest
            image = file.parent / name.replace("\\", "/")
            if image.is_file():
                current.texture = image
            else:
                notes.append(f'texture "{name}" does not exist')


def _fractions(text: str, count: int) -> list[float]:
    try:
        values = [max(0.0, min(1.0, float(word))) for word in text.split()[:count]]
    except ValueError:
        return []
    return values if len(values) == count else []
