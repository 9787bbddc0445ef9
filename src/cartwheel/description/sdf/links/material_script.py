"""OGRE material scripts, which contain the colours and textures of Gazebo models."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.model import Rgba

MAX_BYTES = 4 * 1024 * 1024
MAX_LINES = 2000
"""Maximum lines in a material."""


@dataclass(frozen=True, slots=True)
class Script:
    """The rendered properties of a script's material."""

    diffuse: Rgba | None = None
    emissive: Rgba | None = None
    texture: Path | None = None
    texture_scale: tuple[float, float] = (1.0, 1.0)
    """The part of a surface covered by one copy of the texture."""
    missing: str | None = None
    """The texture in the script that does not exist."""


def find_script(
    name: str, places: list[Path], may_read: Callable[[Path], bool] = lambda _: True
) -> Script | None:
    """The material with this name in any script in the folders and files; None if there is none.

    Args:
        name: Material name.
        places: Folders and files.
        may_read: Whether a texture in a script may be read.
    """
    folders = [place for place in places if place.is_dir()]
    files = [place for place in places if place.is_file()]
    for folder in folders:
        files += sorted(file for file in folder.glob("*.material") if file.is_file())
    for file in files:
        try:
            lines, starts = _materials(file, file.stat().st_mtime_ns)
        except OSError:
            continue
        if name in starts:
            begin = starts[name] + 1
            body = list(_block(iter(lines[begin : begin + MAX_LINES])))
            nearby = [file.parent, file.parent.parent / "textures", *folders]
            return _read(body, nearby, may_read)
    return None


@lru_cache(maxsize=8)
def _materials(file: Path, _changed: int) -> tuple[list[str], dict[str, int]]:
    """A script's lines, and the line at which each ``material <name> { … }`` begins.

    The first one is used for duplicate names. Cached, because a world may refer to a script
    thousands of times.
    """
    text = read_regular_text(file, MAX_BYTES)
    lines = text.replace("{", "\n{\n").replace("}", "\n}\n").splitlines()
    starts: dict[str, int] = {}
    for number, line in enumerate(lines):
        words = _words(line)
        if len(words) >= 2 and words[0] == "material":
            starts.setdefault(words[1].rstrip(":"), number)
    return lines, starts


def _block(lines: Iterator[str]) -> Iterator[list[str]]:
    depth = 0
    for line in lines:
        words = _words(line)
        if words == ["{"]:
            depth += 1
        elif words == ["}"]:
            depth -= 1
            if depth <= 0:
                return
        elif words:
            yield words


def _words(line: str) -> list[str]:
    return line.partition("//")[0].replace('"', " ").split()


def _read(
    statements: list[list[str]], nearby: list[Path], may_read: Callable[[Path], bool]
) -> Script:
    """Reads the first pass: additional passes add effects that are not rendered."""
    diffuse = emissive = ambient = None
    texture: Path | None = None
    scale: tuple[float, float] | None = None
    missing: str | None = None
    for key, *values in statements:
        if key == "diffuse" and diffuse is None:
            diffuse = _colour(values)
        elif key == "ambient" and ambient is None:
            ambient = _colour(values)
        elif key == "emissive" and emissive is None:
            emissive = _colour(values)
        elif key == "texture" and values and texture is None and missing is None:
            named = [folder / values[0] for folder in nearby]
            found = [path for path in named if may_read(path) and path.is_file()]
            texture = found[0] if found else None
            missing = None if found else values[0]
        elif key == "scale" and scale is None and texture is not None:
            scale = _scale(values)
    if diffuse is None and texture is None:
        diffuse = ambient
    return Script(diffuse, emissive, texture, scale or (1.0, 1.0), missing)


def _scale(values: list[str]) -> tuple[float, float] | None:
    try:
        across, along = (float(value) for value in values)
    except ValueError:
        return None
    finite = math.isfinite(across) and math.isfinite(along)
    return (across, along) if finite and across and along else None


def _colour(values: list[str]) -> Rgba | None:
    try:
        numbers = [max(0.0, min(1.0, float(value))) for value in values[:4]]
    except ValueError:
        return None  # "vertexcolour", which follows the mesh
    if len(numbers) < 3:
        return None
    return (numbers[0], numbers[1], numbers[2], numbers[3] if len(numbers) > 3 else 1.0)
