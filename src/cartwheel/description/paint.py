"""What lies on a visual's surface: a colour, or an image and the colour that tints it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.meshes import Submesh
from cartwheel.description.model import Material, Rgba

_WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class Paint:
    """A colour, times an image's where there is one."""

    colour: Rgba | None
    """None where nobody states one."""
    image: Path | bytes | None = None
    """A file, or a file's contents."""


def paint_of(material: Material, part: Submesh | None = None) -> Paint:
    """What lies on a shape, or on a part of a mesh, of a material.

    An image in the mesh's own file comes with its colour, the material's with the material's.
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
