"""Shapes as coloured triangles for the browser."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.appearance.images import PictureError, thumbnail
from cartwheel.description.meshes import load_mesh
from cartwheel.description.model import (
    Collision,
    Heightmap,
    Material,
    Mesh,
    Plane,
    Polyline,
    Rgba,
    Shape,
    Visual,
)
from cartwheel.description.paint import Paint, paint_of
from cartwheel.description.shapes import outline
from cartwheel.description.shapes.terrain import heights_of
from cartwheel.description.shapes.texture_coordinates import scaled, wrapped
from cartwheel.description.shapes.triangles import triangles_of as primitive
from cartwheel.geometry import Pose, matrix_from_quat, quat_between

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

DEFAULT: Rgba = (0.72, 0.74, 0.76, 1.0)
"""Colour of shapes without a colour."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """An image on a surface."""

    image: Path | bytes
    """A file, or its contents."""
    uv: Floats
    """Texture coordinates from the image's lower left corner, shape (n, 2)."""
    tint: Rgba
    """Factor for its colours."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles with one colour; smooth surfaces share vertices."""

    vertices: Floats
    """Shape (n, 3), m."""
    faces: Ints
    """Shape (m, 3), counter-clockwise from outside."""
    rgba: Rgba
    picture: Picture | None = None
    """The image on the surface; `rgba` is then its mean colour."""


def surfaces_of_visual(visual: Visual) -> list[Surface]:
    """Surfaces of a visual in its link's frame.

    Raises:
        MeshError: The file cannot be used.
    """
    opacity = 1.0 - visual.transparency
    return [
        replace(
            surface,
            vertices=place(visual.pose, surface.vertices),
            rgba=(*surface.rgba[:3], surface.rgba[3] * opacity),
        )
        for surface in _coloured(visual.shape, visual.material)
    ]


def surfaces_of_collision(collision: Collision, rgba: Rgba) -> list[Surface]:
    """Surfaces of a collision in its link's frame, with a single colour.

    Raises:
        MeshError: The file cannot be used.
    """
    return [
        Surface(place(collision.pose, surface.vertices), surface.faces, rgba)
        for surface in _coloured(collision.shape, Material(diffuse=rgba))
    ]


def merge(surfaces: Iterable[Surface]) -> list[Surface]:
    """One surface per colour and image: few large meshes are drawn faster than many small ones."""
    by_look: dict[Hashable, list[Surface]] = {}
    for surface in surfaces:
        picture = surface.picture
        image = None if picture is None else (picture.image, picture.tint)
        colour = tuple(round(255 * channel) for channel in surface.rgba)
        by_look.setdefault((colour, image), []).append(surface)
    merged = []
    for group in by_look.values():
        offsets = np.cumsum([0, *(len(surface.vertices) for surface in group)])
        faces = [
            surface.faces + offset for surface, offset in zip(group, offsets[:-1], strict=True)
        ]
        first = group[0].picture
        uv = [surface.picture.uv for surface in group if surface.picture is not None]
        merged.append(
            Surface(
                np.concatenate([surface.vertices for surface in group]).astype(np.float32),
                np.concatenate(faces).astype(np.int32),
                group[0].rgba,
                None if first is None else replace(first, uv=np.concatenate(uv)),
            )
        )
    return merged


def bounds_of(surfaces: Iterable[Surface]) -> tuple[Floats, Floats] | None:
    """Lowest and highest corner of all surfaces, m; None if there are none."""
    clouds = [surface.vertices for surface in surfaces if len(surface.vertices)]
    if not clouds:
        return None
    points = np.concatenate(clouds)
    return points.min(axis=0), points.max(axis=0)


def place(pose: Pose, vertices: Floats) -> Floats:
    """Transforms points from a frame to its parent frame."""
    if pose == Pose():
        return vertices
    turned = vertices @ matrix_from_quat(pose.orientation).T.astype(np.float32)
    return np.asarray(turned + np.asarray(pose.position, dtype=np.float32), dtype=np.float32)


def _coloured(shape: Shape, material: Material) -> list[Surface]:
    if isinstance(shape, Mesh):
        return [
            _painted(part.vertices, part.faces, paint_of(material, part), part.uv, material)
            for part in load_mesh(shape)
        ]
    paint = paint_of(material)
    surface = wrapped(shape) if paint.image is not None else None
    if surface is not None:
        vertices, faces = surface.vertices.astype(np.float32), surface.faces.astype(np.int32)
        return [_painted(vertices, faces, paint, surface.uv, material)]
    return [_painted(*triangles_of(shape), paint, None, material)]


def _painted(vertices: Floats, faces: Ints, paint: Paint, uv: Any, material: Material) -> Surface:
    if paint.image is None or paint.colour is None:
        return Surface(vertices, faces, paint.colour or DEFAULT)
    mean = _mean_colour(paint.image)
    if mean is None:
        return Surface(vertices, faces, paint.colour)
    red, green, blue, alpha = (a * b for a, b in zip(mean, paint.colour, strict=True))
    picture = None
    if uv is not None:
        laid = scaled(uv, material.texture_scale).astype(np.float32)
        picture = Picture(paint.image, laid, paint.colour)
    return Surface(vertices, faces, (red, green, blue, alpha), picture)


@lru_cache(maxsize=128)
def _mean_colour(image: Path | bytes) -> Rgba | None:
    try:
        small = thumbnail(image, 64, "RGBA").resize((16, 16))
    except PictureError:
        return None
    mean = np.asarray(small).reshape(-1, 4).mean(axis=0)
    red, green, blue, alpha = (float(channel) / 255 for channel in mean)
    return (red, green, blue, alpha)


@lru_cache(maxsize=256)
def triangles_of(shape: Shape) -> tuple[Floats, Ints]:
    """Vertices and faces of a shape in its own frame; sharp edges share no vertices."""
    found = primitive(shape)
    if found is not None:
        return found[0].astype(np.float32), found[1]
    match shape:
        case Plane(normal=normal, size=size):
            x, y = size[0] / 2, size[1] / 2
            corners = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], dtype=np.float32)
            pose = Pose((0, 0, 0), quat_between((0, 0, 1), normal))
            return place(pose, corners), np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)
        case Heightmap():
            return _heightmap(shape)
        case Polyline():
            return outline.solid(shape)
    raise TypeError(f"{type(shape).__name__} has no triangles")


def _heightmap(shape: Heightmap) -> tuple[Floats, Ints]:
    heights = heights_of(shape, most=129)
    rows, columns = heights.shape
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, columns), np.linspace(0.5, -0.5, rows))
    points = np.stack([x * shape.size[0], y * shape.size[1], heights], axis=-1).reshape(-1, 3)
    points += np.asarray(shape.position)
    corner = np.arange(rows * columns).reshape(rows, columns)[:-1, :-1].reshape(-1)
    right, below = corner + 1, corner + columns
    faces = np.concatenate(
        [np.stack([corner, below, right], axis=1), np.stack([right, below, below + 1], axis=1)]
    )
    return points.astype(np.float32), faces.astype(np.int32)
