"""Meshes and textures: whether they are there, can be read, and have the size of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import numpy as np

from cartwheel.description.check import nodes
from cartwheel.description.check.finding import Remark, rule
from cartwheel.description.check.solids import Solid
from cartwheel.description.check.subject import MISSING, Robot, Subject
from cartwheel.description.model import Mesh
from cartwheel.errors import DescriptionError

GIANT = 30.0
"""Times the size of all the rest of the robot."""
DWARF = 300.0
HUGE = 100.0
"""m: no link of a robot is as long; millimetres were meant."""
_LEFT_OUT = re.compile(r"(.* is left out(?: and touches nothing)?)\.?(.*)", re.DOTALL)


@rule("file-missing", "error", "a mesh, texture, model or package is not there")
def file_missing(subject: Subject) -> Iterator[Remark]:
    yield from (each for each in subject.failures if MISSING.search(each.message))
    if not subject.is_urdf:
        yield from _left_out(subject, missing=True)
        return
    told: set[tuple[str, str]] = set()
    for node in nodes.walk(subject.root):
        uri = nodes.text_of(node, "filename")
        if node.tag not in ("mesh", "texture") or not uri or (uri, str(node.origin)) in told:
            continue
        try:
            subject.packages.resolve(uri, node.origin, what=node.tag)
        except DescriptionError as error:
            told.add((uri, str(node.origin)))
            near = _near(error.hint or "")
            name = Path(uri).name
            yield Remark(
                severity="error" if node.tag == "mesh" else "warning",
                message=error.message,
                origin=node.origin,
                instead=f'filename="{uri.removesuffix(name)}{near}"' if near else "",
                place="attribute" if near else "",
                mark=uri,
                hint=error.hint or "",
            )


@rule("mesh-unreadable", "error", "a mesh file is damaged, empty, or of an unknown format")
def mesh_unreadable(subject: Subject) -> Iterator[Remark]:
    yield from _left_out(subject, missing=False)


@rule("shape-size", "warning", "a shape is a giant or a dwarf beside the rest of the robot")
def shape_size(subject: Subject) -> Iterator[Remark]:
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
            factor = _factor(solid.extent, usual, others, reach)
            if factor is not None and (len(largest) > 2 or solid.extent > HUGE):
                yield _remark(robot, solid, factor, usual)


def _left_out(subject: Subject, *, missing: bool) -> Iterator[Remark]:
    """What the readers left out for want of its file, or because the file cannot be used."""
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        match = _LEFT_OUT.fullmatch(diagnostic.message)
        if match is None or diagnostic.severity != "error":
            continue
        if missing == bool(MISSING.search(diagnostic.message)):
            node = nodes.at(subject.root, diagnostic.origin) if diagnostic.origin else None
            yield Remark(
                message=match[1],
                origin=diagnostic.origin,
                hint=match[2].strip(),
                mark=nodes.text_of(node, "filename") if node is not None else "",
            )


def _factor(extent: float, usual: float, others: float, reach: float) -> float | None:
    """By what a shape should be scaled; None where it looks right.

    Args:
        extent: Its size, m.
        usual: The median of all shapes.
        others: The largest of the other links.
        reach: How far the farthest link is from the robot's frame, m.
    """
    if extent > HUGE:
        return 0.001
    # Two wheels that are giants both are none beside each other, but beside the rest.
    if (extent > 2.0 and extent > GIANT * others) or (extent > 10.0 and extent > 100 * usual):
        return 0.001
    if extent < usual / DWARF and extent < 0.001 and usual > 0.01 and reach < 10:
        return 1000.0
    return None


def _reach(robot: Robot) -> float:
    points = [np.linalg.norm(link.pose.position) for link in robot.description.links]
    return float(max(points, default=0.0))


def _remark(robot: Robot, solid: Solid, factor: float, usual: float) -> Remark:
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
    return Remark(
        message=f'a {what} of link "{solid.link}" is {solid.extent:.4g} m long, while the other '
        f"shapes of the robot are of some {usual:.3g} m: "
        + ("millimetres for metres?" if factor < 1 else "scaled twice?"),
        origin=shape.origin if shape is not None else part.origin,
        instead=instead,
        place="attribute" if place == "attribute" else "element" if place else "",
        mark="scale" if isinstance(part.shape, Mesh) else "",
    )


def _scaled(text: str, factor: float) -> str:
    values = [nodes.number(word) for word in text.split()]
    return " ".join(nodes.short(value * factor) for value in values if value is not None)


def _near(hint: str) -> str:
    """The file that a hint says was likely meant."""
    start, _, rest = hint.partition('Did you mean "')
    return rest.partition('"')[0] if not start else ""


RULES = (file_missing, mesh_unreadable, shape_size)
