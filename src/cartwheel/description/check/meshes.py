"""Meshes and textures: whether they are there, can be read, and have the size of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median

import numpy as np

from cartwheel.codes import files as files_codes
from cartwheel.codes import robot as robot_codes
from cartwheel.description.check import nodes, spelling
from cartwheel.description.check.rule import rule
from cartwheel.description.check.solids import Solid
from cartwheel.description.check.subject import MISSING, Robot, Subject
from cartwheel.description.model import Mesh
from cartwheel.description.node import Node
from cartwheel.errors import Code, DescriptionError, Diagnostic, Severity

GIANT = 30.0
"""Times the size of all the rest of the robot."""
GIANT_MESH = 6.0
"""The same of a mesh: a scale is forgotten more easily than a length is mistaken."""
DWARF = 300.0
HUGE = 100.0
"""m: no link of a robot is as long; millimetres were meant."""
_LEFT_OUT = re.compile(
    r"(.* is left out(?: and touches nothing)?|the material .*, as .* was not found)\.?(.*)",
    re.DOTALL,
)
_OF_A_FILE = re.compile(r"\bmesh\b|heightmap|texture|polyline|names no model|the folder of")
_DID_YOU_MEAN = re.compile(r'^Did you mean "([^"]*)"')
_PACKAGE = re.compile(r"(?:package://|model://|\$\(find )([\w.-]+)")
_WHY = re.compile(r'the (?:package|model) "[^"]*" was not found|^"[^"]*" is on the network')
_CAUSE = re.compile(_WHY.pattern + r'|^the [a-z ]+ "[^"]*" does not exist')
_SHOWN = 3


@dataclass
class _Absence:
    """Something that is not there, with all that names it."""

    cause: str
    """Such as ``the package "arm_description" was not found``."""
    first: Diagnostic
    places: list[str] = field(default_factory=list)


@rule(files_codes.FILE_MISSING)
def file_missing(subject: Subject) -> Iterator[Diagnostic]:
    found: dict[str, _Absence] = {}
    for remark in _absent(subject):
        cause = _cause(remark.message)
        absence = found.setdefault(cause, _Absence(cause, remark))
        if (place := str(remark.origin)) not in absence.places:
            absence.places.append(place)
    for absence in found.values():
        first, more = absence.first, absence.places[1:]
        if not more:
            yield first
            continue
        shown = ", ".join(more[:_SHOWN]) + (", …" if len(more) > _SHOWN else "")
        yield replace(
            first,
            message=f"{absence.cause}: {len(absence.places)} places need it",
            hint=f"{first.hint.strip()} Also at {shown}.".strip(),
        )


def _absent(subject: Subject) -> Iterator[Diagnostic]:
    for each in subject.failures:
        if MISSING.search(each.message):
            yield replace(each, code=files_codes.FILE_MISSING)
    for remark in left_out(subject, files_codes.FILE_MISSING, missing=True):
        if subject.in_sdf(remark.origin):
            yield remark
    if not subject.is_urdf:
        return
    for node in nodes.walk(subject.root):
        uri = nodes.text_of(node, "filename")
        if node.tag not in ("mesh", "texture") or not uri:
            continue
        try:
            subject.packages.resolve(uri, node.origin, what=node.tag)
        except DescriptionError as error:
            meant = _meant(subject, uri, node, error.hint or "")
            yield files_codes.FILE_MISSING.diagnostic(
                severity="error" if node.tag == "mesh" else "warning",
                message=error.message,
                origin=node.origin,
                instead=f'filename="{meant}"' if meant else "",
                place="attribute" if meant else "",
                mark=uri,
                hint=error.hint or "",
            )


def _meant(subject: Subject, uri: str, node: Node, hint: str) -> str:
    """The URI with the package or the file that was likely meant, where that is there."""
    match = _DID_YOU_MEAN.search(hint)
    if match is None:
        return ""
    package, name = _PACKAGE.match(uri), Path(uri).name
    tries = [uri.removesuffix(name) + match[1]] if spelling.meant(name, [match[1]]) else []
    if package is not None:
        tries.append(uri[: package.start(1)] + match[1] + uri[package.end(1) :])
    for each in tries:
        try:
            subject.packages.resolve(each, node.origin, folder=True)
        except DescriptionError:
            continue
        return each
    return ""


def _cause(message: str) -> str:
    match = _CAUSE.search(message)
    return match[0] if match is not None else message


@rule(files_codes.MESH_UNREADABLE)
def mesh_unreadable(subject: Subject) -> Iterator[Diagnostic]:
    yield from (
        each
        for each in left_out(subject, files_codes.MESH_UNREADABLE)
        if _OF_A_FILE.search(each.message)
    )


def left_out_otherwise(subject: Subject) -> Iterator[Diagnostic]:
    """What is left out, though all its files are there: something in it cannot be read."""
    yield from (
        each
        for each in left_out(subject, files_codes.UNREADABLE)
        if not _OF_A_FILE.search(each.message)
    )


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


def left_out(subject: Subject, code: Code, *, missing: bool = False) -> Iterator[Diagnostic]:
    """What the readers left out for want of its file, or because the file cannot be used."""
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        match = _LEFT_OUT.fullmatch(diagnostic.message)
        if match is None or diagnostic.severity == "info":
            continue
        why = _WHY.search(diagnostic.message)
        if diagnostic.severity != "error" and why is None:
            continue
        if missing == bool(why or MISSING.search(diagnostic.message)):
            node = nodes.at(subject.root, diagnostic.origin) if diagnostic.origin else None
            uri = nodes.child(node, "uri") or (node if node and node.tag == "uri" else None)
            hint = match[2].strip()
            meant = _meant(subject, uri.text.strip(), uri, hint) if uri is not None else ""
            if (end := _end_meant(node, diagnostic.message, hint)) is not None:
                yield code.diagnostic(
                    severity="error",
                    message=match[1],
                    origin=end.origin,
                    instead=nodes.written(end.tag, {}, _DID_YOU_MEAN.match(hint)[1]),  # type: ignore[index]
                    place="element",
                    mark=end.text.strip(),
                )
                continue
            yield code.diagnostic(
                severity=_severity(diagnostic.message),
                message=match[1],
                origin=uri.origin if uri is not None and meant else diagnostic.origin,
                instead=nodes.written("uri", {}, meant) if meant else "",
                place="element" if meant else "",
                hint=hint,
                mark=nodes.text_of(node, "filename") if node is not None else "",
            )


def _end_meant(joint: Node | None, message: str, hint: str) -> Node | None:
    """The misspelt parent or child of a joint, where its name is surely meant for another."""
    meant = _DID_YOU_MEAN.match(hint)
    if joint is None or joint.tag != "joint" or meant is None:
        return None
    for end in joint.children:
        name = end.text.strip()
        if end.tag in ("parent", "child") and f'"{name}" does not exist' in message:
            return end if spelling.meant(name, [meant[1]]) else None
    return None


def _severity(message: str) -> Severity:
    """An error where it can be nowhere; Gazebo fetches models by itself."""
    if "is on the network" in message:
        return "info"
    return "warning" if 'the model "' in message else "error"


def _factor(solid: Solid, usual: float, others: float, reach: float) -> float | None:
    """By what a shape should be scaled; None where it looks right.

    Args:
        solid: The shape.
        usual: The median of all shapes.
        others: The largest of the other links.
        reach: How far the farthest link is from the robot's frame, m.
    """
    extent, mesh = solid.extent, isinstance(solid.part.shape, Mesh)
    giant = GIANT_MESH if mesh else GIANT
    if extent > HUGE:
        return 0.001
    # Two wheels that are giants both are none beside each other, but beside the rest.
    alone = (extent > 2.0 and extent > giant * others) or (extent > 10.0 and extent > 100 * usual)
    # A car's body is long, but would be no body any more with a thousandth of its length.
    if alone and extent / 1000 > usual / 100:
        return 0.001
    # A tiny box or ball stands for nothing on purpose; a tiny mesh was scaled twice.
    if mesh and extent < min(usual / DWARF, 0.001) and usual > 0.01 and reach < 10:
        return 1000.0
    return None


def _is_lost(robot: Robot, solid: Solid) -> bool:
    """Whether a mesh is all that is seen of a link, and a speck beside its collision."""
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
        f"shapes are about {usual:.3g} m",
        values={"link": solid.link, "tag": what, "size": solid.extent, "usual": usual},
        hint="Is it in millimetres?" if factor < 1 else "Is it scaled twice?",
        origin=shape.origin if shape is not None else part.origin,
        instead=instead,
        place="attribute" if place == "attribute" else "element" if place else "",
        mark="scale" if isinstance(part.shape, Mesh) else "",
    )


def _scaled(text: str, factor: float) -> str:
    values = [nodes.number(word) for word in text.split()]
    return " ".join(nodes.short(value * factor) for value in values if value is not None)


RULES = (file_missing, mesh_unreadable, shape_size)
