"""Textured surfaces in the browser's file format."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.description.appearance.images import thumbnail
from cartwheel.viewer.shapes import Surface

_LARGEST = 1024
"""Maximum image edge, pixels, because browsers without a GPU must also draw it."""


def glb_of(surface: Surface) -> bytes:
    """A surface with its image as a GLB file.

    Raises:
        PictureError: The image cannot be read.
    """
    import trimesh

    visual: Any = trimesh.visual
    picture = surface.picture
    assert picture is not None
    # Factors in glTF are linear, not gamma-encoded.
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
    # The exporter uses this format: a photograph needs a tenth of the size as a JPEG.
    reduced.format = "JPEG"
    return reduced
