"""Shapes of a description as MuJoCo geoms."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from cartwheel.description import meshes
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
from cartwheel.errors import Origin, WorldError
from cartwheel.geometry import Array, Pose, quat_between, to_wxyz

_CONE_SIDES = 32
_PLANE_HALF_SIZE = 200.0
"""m, drawn half size of an endless plane."""


class Assets:
    """The meshes and textures of one spec, each made once."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        self._meshes: dict[object, str] = {}
        self._materials: dict[object, str] = {}

    def mesh(self, key: object, vertices: Any, faces: Any, *, uv: Any = None) -> str:
        """The name of a mesh asset; made from the arrays when `key` is new."""
        if key not in self._meshes:
            name = f"mesh_{len(self._meshes)}"
            # A shell's inertia also exists for surfaces that are not closed; no mass comes from it.
            mesh = self._spec.add_mesh(
                name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            )
            mesh.uservert = np.asarray(vertices, dtype=np.float64).ravel()
            mesh.userface = np.asarray(faces, dtype=np.int32).ravel()
            if uv is not None:
                mesh.usertexcoord = np.asarray(uv, dtype=np.float64).ravel()
            self._meshes[key] = name
        return self._meshes[key]

    def texture_material(self, image: Any) -> str:
        """The name of a material that shows an image (a path or its encoded bytes)."""
        if image not in self._materials:
            import io

            from PIL import Image

            name = f"texture_{len(self._materials)}"
            source = io.BytesIO(image) if isinstance(image, bytes) else image
            with Image.open(source) as opened:
                pixels = np.asarray(
                    opened.convert("RGB").transpose(Image.Transpose.FLIP_TOP_BOTTOM)
                )
            texture = self._spec.add_texture(
                name=name,
                type=mujoco.mjtTexture.mjTEXTURE_2D,
                width=pixels.shape[1],
                height=pixels.shape[0],
                nchannel=3,
            )
            texture.data = np.ascontiguousarray(pixels).tobytes()
            material = self._spec.add_material(name=name)
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
            self._materials[image] = name
        return self._materials[image]


def place(shape: Shape, pose: Pose, origin: Origin, assets: Assets) -> tuple[dict[str, Any], Pose]:
    """Geom arguments of a shape, and its pose: a plane's normal may turn it.

    A mesh is one geom whose convex hull collides, whatever parts and colours it has.

    Raises:
        WorldError: The shape is not built yet.
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
        case Plane(normal=normal):
            turned = pose @ Pose((0, 0, 0), quat_between((0, 0, 1), normal))
            # The third number is the spacing of the drawn grid: one cell, since a software
            # renderer pays for each.
            size = [_PLANE_HALF_SIZE, _PLANE_HALF_SIZE, _PLANE_HALF_SIZE]
            return {"type": geom.mjGEOM_PLANE, "size": size}, turned
        case Mesh() | Cone():
            return {"type": geom.mjGEOM_MESH, "meshname": _hull(shape, assets)}, pose
        case Heightmap():
            raise WorldError("a heightmap is not supported yet", origin=origin)
        case Polyline():
            raise WorldError("a polyline is not supported yet", origin=origin)


def pose_arguments(pose: Pose) -> dict[str, Any]:
    """``pos`` and ``quat`` as MuJoCo takes them."""
    return {"pos": list(pose.position), "quat": list(to_wxyz(pose.orientation))}


def _hull(shape: Mesh | Cone, assets: Assets) -> str:
    """The mesh asset whose convex hull collides."""
    if isinstance(shape, Cone):
        return assets.mesh(shape, *_cone(shape))
    return assets.mesh(("hull", shape), *meshes.convex_hull_input(meshes.load_mesh(shape)))


def _cone(shape: Cone) -> tuple[Array, Any]:
    """Vertices and faces of a cone, centred, tip up."""
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
