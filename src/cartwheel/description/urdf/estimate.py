"""Estimates masses for movable parts without one, which the physics requires.

Published robots omit ``<inertial>`` if they are only for rviz. Gazebo drops such links with their
joints; here, their mass is computed from their geometry at SDF's default density.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from cartwheel.codes import robot
from cartwheel.description.inertia import impossibility, principal_moments
from cartwheel.description.kinematics import held_parts
from cartwheel.description.meshes import MeshError, surface_of
from cartwheel.description.model import Box, Collision, Inertial, Joint, Link, Mesh, Visual
from cartwheel.description.sdf.links.inertia import WATER, inertial_of
from cartwheel.description.urdf.context import UrdfContext
from cartwheel.description.urdf.tree import WORLD, Tree
from cartwheel.errors import Origin
from cartwheel.geometry import Pose

SPECK = 1e-3
"""Mass of a part without geometry, kg."""
_SPECK_MOMENT = 1e-6
"""Moment of inertia of such a part, kg m²: a ball of 5 cm."""
_FLATTEST = 1e-3
"""Minimum thickness of the box around a flat mesh, m."""


def with_masses(
    links: Sequence[Link], tree: Tree, ctx: UrdfContext, *, static: bool
) -> tuple[Link, ...]:
    """The links; movable rigid parts without any mass get an estimated one.

    An estimate has the link's origin.
    """
    if static:
        return tuple(links)
    parts: dict[str, list[Link]] = {}
    for link in links:
        parts.setdefault(tree.rigid_root(link.name), []).append(link)
    found: dict[str, Link] = {}
    roots = []
    for root, part in parts.items():
        if root == WORLD:
            continue
        if all(link.inertial is None for link in part):
            roots.append(root)
            found.update(_weighed(root, part))
        elif not any(_turns(link) for link in part):
            found.update(_spread(part, ctx))
    if roots:
        _warn(roots, found, tree, ctx)
    return tuple(found.get(link.name, link) for link in links)


def warn_held(links: Sequence[Link], joints: Sequence[Joint], ctx: UrdfContext) -> None:
    """Warns about parts without any mass that are fixed to the world.

    sdformat merges no link into the world. It leaves out a link without a mass and what hangs on
    it, or, since 9.10, only the link, so that the joints below it have no parent.
    """
    by_name = {link.name: link for link in links}
    for base, names in held_parts(joints).items():
        part = [by_name[name] for name in names if name in by_name]
        if not part or any(link.inertial is not None for link in part):
            continue
        link = by_name[base]
        like = _of_shapes(link) or _speck(link.origin)
        ctx.warn(
            robot.INERTIA_MISSING,
            f'neither link "{base}", which is fixed to the world, nor a link fixed to it has an '
            "<inertial>. Gazebo ignores the link and everything attached to it; Cartwheel needs no "
            "mass for it",
            origin=link.origin,
            hint=f'Add to link "{base}": {inertial_text(like)}',
            values={"links": (base,), "held": True},
        )


def inertial_text(inertial: Inertial) -> str:
    """An ``<inertial>`` as URDF text."""
    i = inertial
    xyz = " ".join(f"{round(value, 6) + 0.0:g}" for value in i.pose.position)
    largest = max(i.diagonal)
    moments = " ".join(
        f'{key}="{value if abs(value) > 1e-4 * largest else 0:.4g}"'
        for key, value in i.scaled(i.mass).items()
    )
    return (
        f'<inertial><origin xyz="{xyz}"/><mass value="{i.mass:.4g}"/><inertia {moments}/>'
        "</inertial>"
    )


def _weighed(root: str, part: Iterable[Link]) -> Mapping[str, Link]:
    found = {}
    for link in part:
        inertial = _of_shapes(link)
        if inertial is not None:
            found[link.name] = replace(link, inertial=inertial)
    if not found:
        link = next(link for link in part if link.name == root)
        found[root] = replace(link, inertial=_speck(link.origin))
    return found


def _spread(part: Sequence[Link], ctx: UrdfContext) -> Mapping[str, Link]:
    """The heaviest point mass of a part, with the extent of its link's geometry."""
    link = max(part, key=lambda each: each.inertial.mass if each.inertial else 0.0)
    stated = link.inertial
    assert stated is not None
    like = _of_shapes(link) or _speck(link.origin)
    pose = Pose(stated.pose.position)
    inertial = replace(stated, pose=pose, **like.scaled(stated.mass))
    ctx.warn(
        robot.INERTIA_IMPOSSIBLE,
        f'link "{link.name}" moves, but its inertia is 0; Cartwheel computes the inertia from '
        "the geometry",
        origin=stated.origin,
        hint=f"Use instead: {inertial_text(inertial)}",
        values={"link": link.name},
    )
    return {link.name: replace(link, inertial=inertial)}


def _turns(link: Link) -> bool:
    """Whether it has a nonzero moment of inertia."""
    i = link.inertial
    return i is not None and any(i.diagonal)


def _of_shapes(link: Link) -> Inertial | None:
    """Inertia of a solid of a link's collisions, or of its visuals; None without extent."""
    for parts in (link.collisions, link.visuals):
        solids = [solid for part in parts if (solid := _solid(part)) is not None]
        found = inertial_of(solids, [WATER] * len(solids), link.origin)
        if found is not None:
            return found
    return None


def _solid(part: Collision | Visual) -> Collision | None:
    """A shape with a volume: an open mesh is replaced by its bounding box."""
    shape, pose = part.shape, part.pose
    if isinstance(shape, Mesh):
        try:
            vertices, _ = surface_of(shape)
        except MeshError:
            return None  # reported when the mesh is read for display
        low, high = vertices.min(axis=0).astype(float), vertices.max(axis=0).astype(float)
        if not _is_solid(shape, low, high):
            x, y, z = np.maximum(high - low, _FLATTEST).tolist()
            a, b, c = ((low + high) / 2).tolist()
            shape, pose = Box(size=(x, y, z)), pose @ Pose((a, b, c))
    return Collision(name=part.name, pose=pose, shape=shape, origin=part.origin)


def _is_solid(mesh: Mesh, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether the volume enclosed by a mesh's triangles is plausible."""
    place = Origin(file=str(mesh.path))
    found = inertial_of([Collision(name="", shape=mesh, origin=place)], [1.0], place)
    if found is None or found.mass > float(np.prod(high - low)) * 1.001:
        return False
    centre = np.array(found.pose.position)
    if (centre < low).any() or (centre > high).any():
        return False
    return impossibility(principal_moments(found.diagonal, found.products)) is None


def _speck(origin: Origin) -> Inertial:
    moment = _SPECK_MOMENT
    return Inertial(mass=SPECK, ixx=moment, iyy=moment, izz=moment, origin=origin)


def _warn(roots: Sequence[str], found: Mapping[str, Link], tree: Tree, ctx: UrdfContext) -> None:
    holders = [tree.inbound.get(root) for root in roots]
    groups: dict[str, list[Link]] = {root: [] for root in roots}
    for link in found.values():
        groups.setdefault(tree.rigid_root(link.name), []).append(link)
    parts = [groups[root] for root in roots]
    weights = [sum(each.inertial.mass for each in part if each.inertial) for part in parts]
    first = parts[0][0]
    if len(roots) == 1:
        assert first.inertial is not None
        advice = "`cartwheel check` shows the missing <inertial>."
        if len(parts[0]) == 1:
            advice = f'Add to link "{first.name}": {inertial_text(first.inertial)}'
        ctx.warn(
            robot.INERTIA_MISSING,
            f"{_mover(roots[0], holders[0])}. {_fate(holders[0])}; Cartwheel uses a mass of "
            f"{weights[0]:.3g} kg{_reason(first)}",
            origin=first.origin,
            hint=advice,
            values={"links": (roots[0],), "masses": (weights[0],)},
        )
        return
    shown = ", ".join(
        f'"{root}" {mass:.3g} kg' for root, mass in zip(roots[:4], weights, strict=False)
    )
    more = f" and {len(roots) - 4} more" if len(roots) > 4 else ""
    fate = (
        "does not load such a robot" if None in holders else "ignores these links and their joints"
    )
    ctx.warn(
        robot.INERTIA_MISSING,
        f"{len(roots)} moving links have no <inertial>. Gazebo {fate}; Cartwheel computes the "
        f"masses from the geometry at {WATER:g} kg/m³: {shown}{more}",
        origin=first.origin,
        hint="`cartwheel check` prints an <inertial> for each link.",
        values={"links": tuple(roots), "masses": tuple(weights)},
    )


def _mover(root: str, holder: Joint | None) -> str:
    if holder is None:
        return f'neither the root link "{root}" nor a link fixed to it has an <inertial>'
    return f'link "{root}" moves on joint "{holder.name}" but has no <inertial>'


def _fate(holder: Joint | None) -> str:
    return (
        "Gazebo does not load such a robot"
        if holder is None
        else "Gazebo ignores the link and its joint"
    )


def _reason(link: Link) -> str:
    if not link.collisions and not link.visuals:
        return ", because the link has no geometry either"
    return f", the mass of the geometry at {WATER:g} kg/m³"
