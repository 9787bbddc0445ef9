"""Appearance of models: colours, emission and textures."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import mujoco
import numpy as np

from cartwheel.description import meshes
from cartwheel.description.model import Material, Mesh, Rgba, Visual
from cartwheel.description.paint import Paint, paint_of
from cartwheel.description.shapes.texture_coordinates import scaled, wrapped
from cartwheel.world.shapes import Assets, place, pose_arguments

VISUAL_GROUP = 1
HIDDEN_GROUP = 5
"""Temporary geom group for geoms that a sensor ignores; otherwise unused."""
_LIT = 0.65
"""Visible fraction of a colour without lamps, lit by the ambient light and the headlight."""
_GREY: Rgba = (0.7, 0.7, 0.7, 1.0)
_LEAST_AREA = 1e-12
"""m²; the engine rejects meshes with an area below 1e-15 m²."""
SMALL = 1e-4
"""m; a larger part of a mesh has a visible area."""


def invisible(part: meshes.Submesh) -> bool:
    """Whether a part of a mesh is too small for the engine and for any camera."""
    if len(part.vertices) and float(np.ptp(part.vertices, axis=0).max()) > SMALL:
        return False
    corners = np.asarray(part.vertices, dtype=np.float64)[part.faces]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(doubled, axis=1).sum()) / 2 < _LEAST_AREA


def add_visual(body: Any, visual: Visual, assets: Assets, *, moves: bool) -> None:
    """Adds a visual to its body as geoms without collision; the body may move.

    Parts of a mesh that are `invisible` are omitted.
    """
    common: dict[str, Any] = {
        "group": VISUAL_GROUP,
        "contype": 0,
        "conaffinity": 0,
        "density": 0,
        "userdata": [visual.laser_retro or 0.0],
    }
    material, shape = visual.material, visual.shape
    opacity = 1.0 - visual.transparency
    scale = material.texture_scale
    if isinstance(shape, Mesh):
        for index, part in enumerate(meshes.load_mesh(shape)):
            if invisible(part):
                continue
            paint = paint_of(material, part)
            laid = paint.image is not None and part.uv is not None
            mesh = assets.mesh(
                ("visual", shape, index, scale if laid else None),
                part.vertices,
                part.faces,
                uv=scaled(part.uv, scale) if laid else None,
            )
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=mesh,
                **_look(material, paint, opacity, assets),
                **common,
                **pose_arguments(visual.pose),
            )
        return
    arguments, pose = place(shape, visual.pose, visual.origin, assets, moves=moves)
    paint = paint_of(material)
    surface = wrapped(shape) if paint.image is not None else None
    if surface is not None:
        name = assets.mesh(
            ("wrapped", shape, scale),
            surface.vertices,
            surface.faces,
            uv=scaled(surface.uv, scale),
        )
        arguments = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}
    body.add_geom(
        **arguments,
        **_look(material, paint, opacity, assets),
        **common,
        **pose_arguments(pose),
    )


def plain_colour(visuals: Iterable[Visual]) -> Rgba | None:
    """The colour of a link's geoms, if all its visuals have the same one.

    Returns:
        The colour of one of two layers, as in a compiled model; None if the visuals have a texture,
        emit light, or have no colour of their own.
    """
    found: set[Rgba] = set()
    for visual in visuals:
        material = visual.material
        if material.texture is not None or any(material.emissive[:3]):
            return None
        if material.diffuse is None or material.yields_to_mesh:
            return None
        red, green, blue, alpha = material.diffuse
        found.add((red, green, blue, _layer(alpha * (1.0 - visual.transparency))))
    return found.pop() if len(found) == 1 else None


def _layer(opacity: float) -> float:
    """The opacity of one of the two layers in which the engine draws transparent geoms."""
    return 1.0 - math.sqrt(1.0 - opacity)


def _look(material: Material, paint: Paint, opacity: float, assets: Assets) -> dict[str, Any]:
    """A geom's colour and material.

    The engine's emission is a factor on the colour. Emission and colour are chosen to add up to the
    material's two colours. The engine draws transparent geoms twice, so the opacity is that of one
    of two layers.
    """
    colour = paint.colour or _GREY
    emission = max(material.emissive[:3])
    if emission > 0:
        red, green, blue = (
            min((glow + _LIT * lit) / (emission + _LIT), 1.0)
            for glow, lit in zip(material.emissive[:3], colour[:3], strict=True)
        )
        colour = (red, green, blue, colour[3])
    look: dict[str, Any] = {"rgba": [*colour[:3], _layer(colour[3] * opacity)]}
    if paint.image is not None or emission > 0:
        look["material"] = assets.material(paint.image, emission)
    return look
