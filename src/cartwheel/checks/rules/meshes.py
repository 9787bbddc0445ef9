"""Meshes and textures: whether they exist, are readable and have a plausible size."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import ABSENT, Robot, Subject
from cartwheel.codes import files as files_codes
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Mesh
from cartwheel.description.node import Node
from cartwheel.description.solids import Solid
from cartwheel.errors import DescriptionError, Diagnostic

GIANT = 30.0
"""Minimum ratio of an implausibly large shape to the rest of the robot."""
GIANT_MESH = 6.0
"""The same for meshes: a missing scale is more common than a wrong length."""
DWARF = 300.0
HUGE = 100.0
"""m; no robot link is this long, so the unit was probably millimetres."""
_PACKAGE = re.compile(r"(?:package://|model://|\$\(find )([\w.-]+)")
_SHOWN = 3


@rule(files_codes.FILE_MISSING)
def file_missing(subject: Subject) -> Iterator[Diagnostic]:
    absences: dict[tuple[object, ...], list[Diagnostic]] = {}
    for each in _absent(subject):
        values = each.values
        several = absences.setdefault((each.code, values.get("kind"), values.get("name")), [])
        if all(str(each.origin) != str(other.origin) for other in several):
            several.append(each)
    for first, *more in absences.values():
        if not more:
            yield first
            continue
        places = ", ".join(str(each.origin) for each in more[:_SHOWN])
        places += ", …" if len(more) > _SHOWN else ""
        yield replace(
            first,
            message=f"{_cause(first)}; it is used in {len(more) + 1} places",
            values={**first.values, "places": len(more) + 1},
            hint=f"{first.hint.strip()} Also at {places}.".strip(),
        )


def _cause(absence: Diagnostic) -> str:
    kind, name = absence.values.get("kind"), absence.values.get("name")
    if absence.code is files_codes.FILE_ON_NETWORK:
        return f'"{name}" is on the network'
    if absence.code is not files_codes.FILE_MISSING:
        return absence.message
    return f'the {kind} "{name}" ' + (
        "was not found" if kind in ("model", "package") else "does not exist"
    )


def _absent(subject: Subject) -> Iterator[Diagnostic]:
    yield from (each for each in subject.failures if each.code in ABSENT)
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        if diagnostic.code in ABSENT and subject.in_sdf(diagnostic.origin):
            yield _of_sdf(subject, diagnostic)
    if not subject.is_urdf:
        return
    for node in nodes.walk(subject.root):
        uri = nodes.text_of(node, "filename")
        if node.tag not in ("mesh", "texture") or not uri:
            continue
        try:
            subject.packages.resolve(uri, node.origin, what=node.tag)
        except DescriptionError as error:
            meant = _meant(subject, uri, node, str(error.values.get("meant", "")))
            yield replace(
                error.diagnostic("error" if node.tag == "mesh" else "warning"),
                origin=node.origin,
                instead=f'filename="{meant}"' if meant else "",
                place="attribute" if meant else "",
                mark=uri,
            )


def _of_sdf(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    """A reader's diagnostic for a missing file, with the corrected URI."""
    node = subject.node_at(diagnostic.origin)
    uri = nodes.child(node, "uri") or (node if node and node.tag == "uri" else None)
    near = str(diagnostic.values.get("meant", ""))
    meant = _meant(subject, uri.text.strip(), uri, near) if uri is not None else ""
    severity = diagnostic.severity
    if diagnostic.code is files_codes.FILE_ON_NETWORK:
        severity = "info"  # Gazebo downloads the file.
    elif diagnostic.values.get("kind") == "model":
        severity = "warning"
    return replace(
        diagnostic,
        severity=severity,
        origin=uri.origin if uri is not None and meant else diagnostic.origin,
        instead=nodes.written("uri", {}, meant) if meant else "",
        place="element" if meant else "",
        mark=nodes.text_of(node, "filename") if node is not None else "",
    )


def _meant(subject: Subject, uri: str, node: Node, near: str) -> str:
    """The URI with the likely package or file name, if that file exists."""
    if not near:
        return ""
    package, name = _PACKAGE.match(uri), Path(uri).name
    tries = [uri.removesuffix(name) + near] if spelling.meant(name, [near]) else []
    if package is not None:
        tries.append(uri[: package.start(1)] + near + uri[package.end(1) :])
    for each in tries:
        try:
            subject.packages.resolve(each, node.origin, folder=True)
        except DescriptionError:
            continue
        return each
    return ""


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


RULES = (file_missing, shape_size)
