"""Converts separate indices of positions, normals and texture coordinates to common vertices.

OBJ and COLLADA index the three separately; renderers and physics need a single index.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.meshes.polygons import triangulate
from cartwheel.description.meshes.submesh import Submesh, build_submesh

if TYPE_CHECKING:
    from cartwheel.description.model import Rgba

Indices = NDArray[np.int64]


def weld(
    name: str,
    counts: Indices,
    points: tuple[NDArray[Any], Indices],
    *,
    normals: tuple[NDArray[Any], Indices] | None = None,
    uv: tuple[NDArray[Any], Indices] | None = None,
    rgba: Rgba | None = None,
    texture: Path | bytes | None = None,
) -> Submesh | None:
    """Creates a submesh from polygons; None if no triangle remains.

    Args:
        name: Name of the submesh.
        counts: Number of corners of each polygon.
        points: The positions (n, 3), and the index of each corner.
        normals: The same for normals, (k, 3).
        uv: The same for texture coordinates, (k, 2).
        rgba: Diffuse colour.
        texture: Image.

    Raises:
        ValueError: An index is out of range, or the polygons do not match the corners.
    """
    tables = [points, *(table for table in (normals, uv) if table is not None)]
    for values, indices in tables:
        if indices.size and (indices.min() < 0 or indices.max() >= len(values)):
            raise ValueError(
                f"a face of the mesh contains the index {int(indices.max())}, but only "
                f"{len(values)} entries exist"
            )
    key = points[1]
    for values, indices in tables[1:]:
        key = key * max(1, len(values)) + indices
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    triangles = triangulate(counts, points[0][points[1]])
    return build_submesh(
        name,
        points[0][points[1][first]],
        inverse.reshape(-1)[triangles],
        normals=normals[0][normals[1][first]] if normals else None,
        uv=uv[0][uv[1][first]] if uv else None,
        rgba=rgba,
        texture=texture,
    )
