"""The surface of a visual: a colour, or an image and its tint."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.meshes import Submesh
from cartwheel.description.model import Material, Rgba

_WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class Paint:
    """A colour, multiplied by an image if there is one."""

    colour: Rgba | None
    """None if no colour is stated."""
    image: Path | bytes | None = None
    """A file, or its contents."""


def paint_of(material: Material, part: Submesh | None = None) -> Paint:
    """The surface of a shape or a part of a mesh with a material.

    An image in the mesh's file is tinted with the mesh's colour, and the material's image with the
    material's colour.
    """
    if part is None:
        image = material.texture
        return Paint(material.diffuse if image is None else material.diffuse or _WHITE, image)
    own = material.diffuse is None or material.yields_to_mesh
    chosen = material.texture or (part.texture if own else None)
    if chosen is None or part.uv is None:
        return Paint(material.colour_of(part.rgba))
    tint = None if material.yields_to_mesh else material.diffuse
    return Paint(tint or _WHITE, chosen)
