"""Converts shapes to MuJoCo geoms."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from cartwheel.description import meshes
from cartwheel.description.appearance.images import PictureError, thumbnail
from cartwheel.description.model import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Heightmap,
    Mesh,
    Plane,
    Polyline,
    Shape,
    Sphere,
)
from cartwheel.description.shapes import outline
from cartwheel.description.shapes.terrain import heights_of
from cartwheel.errors import Origin
from cartwheel.geometry import Array, Pose, quat_between, to_wxyz

_CONE_SIDES = 32
_PLANE_HALF_SIZE = 200.0
"""Drawn half size of an infinite plane, m."""
_ENDLESS = 50.0
"""m; a plane with at least this size is a ground, which is drawn to the horizon."""
_LARGEST_TEXTURE = 1024
"""Pixels in each direction: no camera resolves more of a surface."""
_FLAT = 1e-6
"""Relative thickness below which a mesh is flat."""
_PLATE = 1e-3
"""m; thickness of a flat mesh that collides, and of a moving plane."""
_HULL_CORNERS = 2000
"""Maximum hull vertices. Larger hulls of finely meshed curves take seconds and differ by 0.1 %."""
_BELOW = 1.0
"""Solid ground below the lowest point of a heightmap, m."""


class Assets:
    """The meshes and textures of a spec, each created once."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        self._meshes: dict[object, str] = {}
        self._materials: dict[object, str] = {}
        self._textures: dict[object, str] = {}
        self._heightmaps: dict[Heightmap, tuple[str, float]] = {}

    def mesh(self, key: object, vertices: Any, faces: Any, *, uv: Any = None) -> str:
        """The name of a mesh asset, which is created from the arrays if `key` is new.

        Without faces, it is the convex hull of the vertices.
        """
        if key not in self._meshes:
            name = f"mesh_{len(self._meshes)}"
            # Shell inertia also works for open surfaces; it never affects the mass.
            mesh = self._spec.add_mesh(
                name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            )
            mesh.maxhullvert = _HULL_CORNERS
            mesh.uservert = _four(vertices).ravel()
            if faces is not None:
                mesh.userface = np.asarray(faces, dtype=np.int32).ravel()
            if uv is not None:
                mesh.usertexcoord = _four(uv).ravel()
            self._meshes[key] = name
        return self._meshes[key]

    def heightmap(self, shape: Heightmap, origin: Origin) -> tuple[str, float]:
        """The name of a heightmap asset, and the height of its lowest point, m."""
        if shape not in self._heightmaps:
            heights = heights_of(shape, origin=origin)
            low, high = float(heights.min()), float(heights.max())
            name = f"heightmap_{len(self._heightmaps)}"
            x, y = shape.size[0] / 2, shape.size[1] / 2
            # The engine scales the data by the third number.
            self._spec.add_hfield(
                name=name,
                nrow=heights.shape[0],
                ncol=heights.shape[1],
                size=[x, y, max(high - low, 1e-6), _BELOW],
                userdata=heights[::-1].ravel().tolist(),
            )
            # MuJoCo's native method finds contacts that push sideways where a box or a robot falls
            # on a heightmap, and throws it away.
            self._spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_NATIVECCD
            self._heightmaps[shape] = (name, low)
        return self._heightmaps[shape]

    def material(self, image: Path | bytes | None, emission: float) -> str:
        """The name of a material with an image (path or encoded bytes) and emission.

        Args:
            image: None for no image; unreadable images are omitted.
            emission: Emitted light, as a factor on the colour.
        """
        key = (image, emission)
        if key not in self._materials:
            name = f"material_{len(self._materials)}"
            material = self._spec.add_material(name=name, emission=emission)
            texture = self._texture(image) if image is not None else None
            if texture is not None:
                role = mujoco.mjtTextureRole.mjTEXROLE_RGB
                material.textures[role] = texture
            self._materials[key] = name
        return self._materials[key]

    def _texture(self, image: Path | bytes) -> str | None:
        """The texture of an image; None if it is unreadable, see `picture_error` for the reason."""
        if image not in self._textures:
            name = f"texture_{len(self._textures)}"
            pixels = _pixels(image, _changed(image))
            if isinstance(pixels, PictureError):
                return None
            texture = self._spec.add_texture(
                name=name,
                type=mujoco.mjtTexture.mjTEXTURE_2D,
                width=pixels.shape[1],
                height=pixels.shape[0],
                nchannel=3,
            )
            texture.data = pixels.tobytes()
            self._textures[image] = name
        return self._textures[image]


def _four(rows: Any) -> Any:
    """At least four rows, with the last one repeated: the engine rejects single triangles."""
    some = np.asarray(rows, dtype=np.float64)
    return np.concatenate([some, np.repeat(some[-1:], max(0, 4 - len(some)), axis=0)])


def picture_error(image: Path | bytes) -> PictureError | None:
    """Why an image cannot be shown, or None."""
    found = _pixels(image, _changed(image))
    return found if isinstance(found, PictureError) else None


def _changed(image: Path | bytes) -> int:
    """When a file was modified, ns; 0 if it does not exist."""
    try:
        return image.stat().st_mtime_ns if isinstance(image, Path) else 0
    except OSError:
        return 0


@lru_cache(maxsize=256)
def _pixels(image: Path | bytes, _changed: int) -> Any:
    """An image as the engine needs it, shape (height, width, 3); cached across spawns.

    Returns the error if the image cannot be read.
    """
    try:
        small = thumbnail(image, _LARGEST_TEXTURE)
    except PictureError as error:
        # A new error: the raised one refers to frames that contain the image.
        return PictureError(error.name, error.reason, error.hint, code=error.code)
    return np.ascontiguousarray(np.asarray(small)[::-1])


def place(
    shape: Shape, pose: Pose, origin: Origin, assets: Assets, *, moves: bool = False
) -> tuple[dict[str, Any], Pose]:
    """Geom arguments and pose of a visual shape; the pose may include a plane's normal.

    A mesh is one geom, regardless of its parts and colours. A moving plane becomes a thin plate,
    because the engine's planes are fixed.

    Raises:
        CartwheelError: The shape's file cannot be used.
    """
    geom = mujoco.mjtGeom
    match shape:
        case Box(size=(x, y, z)):
            return {"type": geom.mjGEOM_BOX, "size": [x / 2, y / 2, z / 2]}, pose
        case Cylinder(radius=radius, length=length):
            return {"type": geom.mjGEOM_CYLINDER, "size": [radius, length / 2, 0]}, pose
        case Sphere(radius=radius):
            return {"type": geom.mjGEOM_SPHERE, "size": [radius, 0, 0]}, pose
        case Capsule(radius=radius, length=length):
            return {"type": geom.mjGEOM_CAPSULE, "size": [radius, length / 2, 0]}, pose
        case Ellipsoid(radii=radii):
            return {"type": geom.mjGEOM_ELLIPSOID, "size": list(radii)}, pose
        case Plane(normal=normal, size=size):
            turned = pose @ Pose((0, 0, 0), quat_between((0, 0, 1), normal))
            x, y = (side / 2 if side < _ENDLESS else _PLANE_HALF_SIZE for side in size)
            if moves:
                return {"type": geom.mjGEOM_BOX, "size": [x, y, _PLATE / 2]}, turned
            # The third number is the grid spacing: one cell, because software rendering is slow.
            return {"type": geom.mjGEOM_PLANE, "size": [x, y, max(x, y)]}, turned
        case Mesh() | Cone() | Polyline():
            return {"type": geom.mjGEOM_MESH, "meshname": _mesh(shape, assets)}, pose
        case Heightmap(position=position):
            name, bottom = assets.heightmap(shape, origin)
            placed = pose @ Pose((position[0], position[1], position[2] + bottom))
            return {"type": geom.mjGEOM_HFIELD, "hfieldname": name}, placed


def solids(
    shape: Shape, pose: Pose, origin: Origin, assets: Assets, *, moves: bool = True
) -> list[tuple[dict[str, Any], Pose]]:
    """Geom arguments and poses of the convex parts of a collision shape.

    A moving mesh becomes its convex hull; a fixed mesh keeps its surface.

    Args:
        shape: The shape.
        pose: Pose in its link.
        origin: Origin for errors.
        assets: The spec's assets.
        moves: Whether the link can move.

    Raises:
        CartwheelError: The shape's file cannot be used.
    """
    parts: list[tuple[object, Any, Any]] = []
    if isinstance(shape, Polyline):
        parts = [
            (("prism", piece, shape.height), *_prism(piece, shape))
            for piece in outline.convex_pieces(shape)
        ]
    elif isinstance(shape, Mesh) and moves:
        plate = _plate(shape)
        parts = [] if plate is None else [(("plate", shape), plate, None)]
    elif isinstance(shape, Mesh):
        pieces = meshes.standing_parts(shape).pieces
        parts = [((shape, number), piece, None) for number, piece in enumerate(pieces)]
    if not parts:
        return [place(shape, pose, origin, assets)]
    kind = mujoco.mjtGeom.mjGEOM_MESH
    return [({"type": kind, "meshname": assets.mesh(*part)}, pose) for part in parts]


def pose_arguments(pose: Pose) -> dict[str, Any]:
    """``pos`` and ``quat`` in MuJoCo's format."""
    return {"pos": list(pose.position), "quat": list(to_wxyz(pose.orientation))}


def _mesh(shape: Mesh | Cone | Polyline, assets: Assets) -> str:
    """The mesh asset of a shape; collisions use its convex hull."""
    match shape:
        case Cone():
            return assets.mesh(shape, *_cone(shape))
        case Polyline():
            return assets.mesh(shape, *outline.solid(shape))
        case Mesh():
            return assets.mesh(("hull", shape), *meshes.surface_of(shape))


def _plate(shape: Mesh) -> Any:
    """The corners of a flat mesh, extruded to a plate because it has no hull; otherwise None."""
    vertices, _ = meshes.surface_of(shape)
    centred = np.asarray(vertices, dtype=np.float64)
    centred = centred - centred.mean(axis=0)
    _, extents, axes = np.linalg.svd(centred, full_matrices=False)
    if len(extents) < 3 or extents[2] > _FLAT * max(extents[0], _FLAT):
        return None
    half = axes[2] * _PLATE / 2
    return np.concatenate([vertices + half, vertices - half])


def _prism(piece: outline.Loop, shape: Polyline) -> tuple[Any, Any]:
    """A convex piece of an outline, extruded."""
    return outline.solid(Polyline(points=piece, height=shape.height))


def _cone(shape: Cone) -> tuple[Array, Any]:
    """Vertices and faces of a centred cone with its tip up."""
    angles = [2 * math.pi * i / _CONE_SIDES for i in range(_CONE_SIDES)]
    rim = [
        (shape.radius * math.cos(a), shape.radius * math.sin(a), -shape.length / 2) for a in angles
    ]
    vertices = np.array([*rim, (0, 0, -shape.length / 2), (0, 0, shape.length / 2)])
    base, tip = _CONE_SIDES, _CONE_SIDES + 1
    faces = []
    for i in range(_CONE_SIDES):
        j = (i + 1) % _CONE_SIDES
        faces += [(i, j, tip), (j, i, base)]
    return vertices, np.array(faces, dtype=np.int32)
