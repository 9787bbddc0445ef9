"""Surfaces with an image on them, as the browser reads them."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.description.pictures import thumbnail
from cartwheel.viewer.shapes import Surface

_LARGEST = 1024
"""Pixels of an image's longer edge: a browser without a GPU has to draw it too."""


def glb_of(surface: Surface) -> bytes:
    """A surface with its image, as the browser reads it.

    Raises:
        PictureError: The image cannot be read.
    """
    import trimesh

    visual: Any = trimesh.visual
    picture = surface.picture
    assert picture is not None
    # glTF's factors are of light, and not of what a screen is sent for it.
    factor = [*(channel**2.2 for channel in picture.tint[:3]), 1.0]
    material = visual.material.PBRMaterial(
        baseColorTexture=_reduced(picture.image),
        baseColorFactor=np.round(255 * np.array(factor)).astype(np.uint8),
        metallicFactor=0.0,
        roughnessFactor=0.9,
    )
    mesh = trimesh.Trimesh(
        vertices=surface.vertices,
        faces=surface.faces,
        visual=visual.TextureVisuals(uv=picture.uv, material=material),
        process=False,
    )
    made: Any = mesh.export(file_type="glb", include_normals=True)
    return bytes(made)


@lru_cache(maxsize=8)
def _reduced(source: Path | bytes) -> Any:
    reduced = thumbnail(source, _LARGEST)
    # By this name it is written into the file: a photograph takes a tenth of what it would as PNG.
    reduced.format = "JPEG"
    return reduced
