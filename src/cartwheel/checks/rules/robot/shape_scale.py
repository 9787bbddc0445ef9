"""Shapes that are far larger or smaller than the rest of the robot."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Mesh
from cartwheel.description.solids import Solid
from cartwheel.errors import Diagnostic

GIANT = 30.0
"""Minimum ratio of an implausibly large shape to the rest of the robot."""
GIANT_MESH = 6.0
"""The same for meshes: a missing scale is more common than a wrong length."""
DWARF = 300.0
HUGE = 100.0
"""m; no robot link is this long, so the unit was probably millimetres."""


@rule(robot_codes.SHAPE_OUT_OF_SCALE)
def shape_size(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static:
            continue
        solids = [
            solid
            for link in robot.links
            for solid in (*robot.collisions[link], *robot.visuals[link])
        ]
        usual = median(solid.extent for solid in solids) if solids else 1.0
        largest: dict[str, float] = {}
        for solid in solids:
            largest[solid.link] = max(largest.get(solid.link, 0.0), solid.extent)
        first, second = (*sorted(largest.values(), reverse=True), 0.0, 0.0)[:2]
        reach = _reach(robot)
        for solid in solids:
            others = second if largest[solid.link] == first else first
            factor = _factor(solid, usual, others, reach)
            if factor is None and _is_lost(robot, solid):
                factor = 1000.0
            if factor is not None and (len(largest) > 2 or solid.extent > HUGE):
                yield _remark(robot, solid, factor, usual)


def _factor(solid: Solid, usual: float, others: float, reach: float) -> float | None:
    """The factor by which a shape should be scaled; None if its size is plausible.

    Args:
        solid: The shape.
        usual: Median size of all shapes, m.
        others: Largest size among the other links, m.
        reach: Distance of the farthest link from the robot's frame, m.
    """
    extent, mesh = solid.extent, isinstance(solid.part.shape, Mesh)
    giant = GIANT_MESH if mesh else GIANT
    if extent > HUGE:
        return 0.001
    # Two equally oversized wheels look normal to each other, but not to the rest.
    alone = (extent > 2.0 and extent > giant * others) or (extent > 10.0 and extent > 100 * usual)
    # A car body is long, but a thousandth of its length would be too small.
    if alone and extent / 1000 > usual / 100:
        return 0.001
    # A tiny box or sphere is often a deliberate placeholder; a tiny mesh was scaled twice.
    if mesh and extent < min(usual / DWARF, 0.001) and usual > 0.01 and reach < 10:
        return 1000.0
    return None


def _is_lost(robot: Robot, solid: Solid) -> bool:
    """Whether a link's only visual is a mesh far smaller than the link's collision."""
    seen, felt = robot.visuals[solid.link], robot.collisions[solid.link]
    if not felt or all(one is not solid for one in seen) or not isinstance(solid.part.shape, Mesh):
        return False
    return max(one.extent for one in seen) < max(one.extent for one in felt) / 200


def _reach(robot: Robot) -> float:
    points = [np.linalg.norm(link.pose.position) for link in robot.description.links]
    return float(max(points, default=0.0))


def _remark(robot: Robot, solid: Solid, factor: float, usual: float) -> Diagnostic:
    part = solid.part
    what = "visual" if part in robot.links[solid.link].visuals else "collision"
    node = robot.node_at(part.origin)
    geometry = nodes.child(node, "geometry")
    shape = geometry.children[0] if geometry is not None and geometry.children else None
    instead, place = "", ""
    if isinstance(part.shape, Mesh):
        scale = " ".join(nodes.short(value * factor) for value in part.shape.scale)
        instead = f'scale="{scale}"' if shape is not None else f"<scale>{scale}</scale>"
        place = "attribute" if shape is not None else ""
    elif shape is not None:
        instead = nodes.changed(
            shape, **{name: _scaled(text, factor) for name, text in shape.attributes.items()}
        )
        place = "element"
    return robot_codes.SHAPE_OUT_OF_SCALE.diagnostic(
        message=f'a {what} of link "{solid.link}" is {solid.extent:.4g} m long, while the other '
        f"shapes are about {usual:.3g} m long",
        values={"link": solid.link, "tag": what, "size": solid.extent, "usual": usual},
        hint="Is the size in millimetres?" if factor < 1 else "Is the shape scaled twice?",
        origin=shape.origin if shape is not None else part.origin,
        instead=instead,
        place="attribute" if place == "attribute" else "element" if place else "",
        mark="scale" if isinstance(part.shape, Mesh) else "",
    )


def _scaled(text: str, factor: float) -> str:
    values = [nodes.number(word) for word in text.split()]
    return " ".join(nodes.short(value * factor) for value in values if value is not None)
