"""Reads PLY and glTF files with trimesh, which is imported only for such files."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from cartwheel.description.appearance.images import FORMATS, check_size
from cartwheel.description.files.regular_files import read_regular
from cartwheel.description.meshes.submesh import MOST_BYTES, Submesh, build_submesh
from cartwheel.description.model import Rgba


def read_with_trimesh(path: Path, data: bytes, _notes: list[str]) -> list[Submesh]:
    """One submesh for each geometry in the scene, placed by its nodes.

    glTF's y-up axis is unchanged: neither rviz nor Gazebo converts it to z-up.

    Raises:
        Exception: Any error of trimesh for a damaged file.
    """
    # Imported here: the import takes 0.1 s, and most robots do not need it.
    import trimesh

    # trimesh logs tracebacks of handled errors, which Python would print.
    logging.getLogger("trimesh").addHandler(logging.NullHandler())
    kind = path.suffix.lower().lstrip(".")

    class Beside(trimesh.resolvers.FilePathResolver):
        """Files that a glTF refers to: only regular files in its folder."""

        def get(self, name: str) -> bytes:
            file = (path.parent / unquote(name.strip())).resolve()
            if not file.is_relative_to(path.parent.resolve()):
                raise ValueError(f'the file refers to "{name}", which is outside its folder')
            return read_regular(file, MOST_BYTES)

    resolver = Beside(str(path))
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=resolver, process=False)
    result: list[Submesh] = []
    for node in scene.graph.nodes_geometry:
        transform, key = scene.graph[node]
        geometry = scene.geometry[key]
        if not isinstance(geometry, trimesh.Trimesh):
            continue
        matrix = np.asarray(transform, dtype=np.float64)
        linear = matrix[:3, :3]
        faces = np.asarray(geometry.faces)
        if faces.size and (faces.min() < 0 or faces.max() >= len(geometry.vertices)):
            raise ValueError("a face of the mesh contains an invalid vertex index")
        if np.linalg.det(linear) < 0:
            faces = faces[:, ::-1]
        rgba, texture = _look(geometry.visual)
        uv = getattr(geometry.visual, "uv", None)
        with np.errstate(all="ignore"):  # triangles without area
            normals = np.asarray(geometry.vertex_normals) @ np.linalg.inv(linear)
        submesh = build_submesh(
            str(key),
            np.asarray(geometry.vertices) @ linear.T + matrix[:3, 3],
            faces,
            normals=normals,
            uv=uv,
            rgba=rgba,
            texture=texture if uv is not None else None,
        )
        if submesh is not None:
            result.append(submesh)
    return result


def _look(visual: Any) -> tuple[Rgba | None, bytes | None]:
    """Colour and image of a trimesh visual."""
    if visual.kind in ("vertex", "face"):
        colours = visual.vertex_colors if visual.kind == "vertex" else visual.face_colors
        r, g, b, a = (float(c) / 255 for c in np.asarray(colours, dtype=float).mean(axis=0))
        return (r, g, b, a), None
    material = getattr(visual, "material", None)
    if visual.kind != "texture" or material is None:
        return None, None
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    colour = getattr(material, "baseColorFactor", None)
    if colour is None and image is None:
        colour = getattr(material, "main_color", None)
    rgba: Rgba | None = None
    if colour is not None:
        values = np.asarray(colour)
        values = values / 255 if values.dtype.kind in "ui" else values
        r, g, b, a = (float(c) for c in (*values[:3], values[3] if len(values) > 3 else 1.0))
        rgba = (r, g, b, a)
    if image is None:
        return rgba, None
    if image.format is not None and image.format not in FORMATS:
        return rgba, None
    check_size(image, "in the mesh")
    return rgba, _content(image)


def _content(image: Any) -> bytes:
    """The file of an image: as it is stored, or compressed if trimesh has changed the image."""
    stored = getattr(image, "fp", None)  # of an image that is opened, but not decoded
    if isinstance(stored, io.BytesIO):
        return stored.getvalue()
    stream = io.BytesIO()
    image.save(stream, format="PNG", compress_level=1)
    return stream.getvalue()
