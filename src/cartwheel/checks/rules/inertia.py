"""Masses and inertias: whether they are physically possible and plausible for the geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import cast

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.structure import ends, inbound, link_names
from cartwheel.checks.subject import Robot, Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.inertia import impossibility, principal_moments
from cartwheel.description.model import Box, Collision, Inertial, Link, Visual
from cartwheel.description.node import Node
from cartwheel.description.sdf.inertia import inertial_of
from cartwheel.description.solids import as_collision, bounds
from cartwheel.errors import Diagnostic, Origin
from cartwheel.geometry import Pose, Vec3

TOO_LARGE = 1.5
"""Maximum ratio to the inertia of the same mass placed at the corners of the geometry's box."""
TOO_SMALL = 20.0
"""Maximum ratio of the inertia of a solid of the same shape to the stated inertia."""
OUTSIDE = 0.25
"""Maximum distance of the centre of mass from the box, as a fraction of the box's diagonal."""
_LIGHT = 0.01
"""Fraction of the robot's mass below which a link's mass hardly matters, and is often arbitrary."""
DENSEST = 30_000.0
"""kg/m³; the density of osmium is 22,600."""
_FOAM = 50.0
"""kg/m³; a mass with a lower density was not stated in grams."""
_LIGHTEST_IN_KG = 0.1
_ROUNDED = 1e-9
"""Relative rounding error of a value that should be 0."""
_NEVERTHELESS = (
    "Gazebo Classic simulates this inertia anyway, but gz-sim rejects it. Cartwheel increases the "
    "smaller moments."
)
_WITHOUT = "Gazebo Classic divides by zero. Cartwheel computes the inertia from the geometry."
_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@rule(robot_codes.INERTIA_IMPOSSIBLE)
def inertia_impossible(subject: Subject) -> Iterator[Diagnostic]:
    for failure in subject.failures:
        if "moments" in failure.values:
            yield replace(failure, severity="warning")
    yield from _impossible_in_sdf(subject)
    held = _held(subject)
    for link, inertial in _inertials(subject):
        tensor = nodes.child(inertial, "inertia")
        moments = moments_of(inertial)
        mass = nodes.number(nodes.text_of(nodes.child(inertial, "mass"), "value"))
        if moments is None or mass is None or mass <= 0:
            continue
        wrong = impossibility(moments)
        name = nodes.name_of(link)
        if wrong is None or (not any(moments) and name in held):
            continue
        place = tensor or inertial
        negative = min(moments) < -_ROUNDED * max(moments)
        # The inertia is a small part of the sum with a heavier link that this one is fixed to.
        part = _is_part(subject, name, max(moments))
        yield robot_codes.INERTIA_IMPOSSIBLE.diagnostic(
            severity="info" if part else "error" if negative else None,
            message=f'link "{name}": {wrong[0]}',
            values={"link": name, "moments": moments},
            origin=place.origin,
            instead=_inertia_text(_sketch(subject, name), mass),
            place="element" if tensor is not None else "inside",
            hint="" if part or negative else _NEVERTHELESS if any(moments) else _WITHOUT,
        )


def _impossible_in_sdf(subject: Subject) -> Iterator[Diagnostic]:
    """Impossible inertias that the SDF reader reported, with a replacement from the geometry."""
    links = {link.name: (robot, link) for robot in subject.robots for link in robot.links.values()}
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        values = diagnostic.values
        if diagnostic.code is not robot_codes.INERTIA_IMPOSSIBLE or "moments" not in values:
            continue
        if diagnostic.severity == "error" or not subject.in_sdf(diagnostic.origin):
            continue
        robot, link = links.get(str(values["link"]), (None, None))
        wrong = impossibility(cast(Vec3, values["moments"]))
        like = _shape_inertia(robot, link) if robot is not None and link is not None else None
        mass = link.inertial.mass if link is not None and link.inertial is not None else 1.0
        yield robot_codes.INERTIA_IMPOSSIBLE.diagnostic(
            severity=diagnostic.severity,
            message=f'link "{values["link"]}": {wrong[0]}' if wrong else diagnostic.message,
            values=values,
            origin=diagnostic.origin,
            instead=_inertia_text(like, mass, sdf=True),
            hint=_NEVERTHELESS,
        )


@rule(robot_codes.MASS_NOT_POSITIVE)
def mass_not_positive(subject: Subject) -> Iterator[Diagnostic]:
    held = _held(subject)
    for link, inertial in _inertials(subject):
        place = nodes.child(inertial, "mass")
        mass = nodes.number(nodes.text_of(place, "value"))
        if place is None or mass is None or mass > 0:
            continue
        if mass == 0 and nodes.name_of(link) in held:
            continue  # a frame without geometry, which Gazebo merges into its parent
        yield robot_codes.MASS_NOT_POSITIVE.diagnostic(
            message=f'link "{nodes.name_of(link)}" has a mass of {mass:g} kg, so Gazebo ignores '
            "the link and everything attached to it",
            values={"link": nodes.name_of(link), "mass": mass},
            origin=place.origin,
            instead=f'value="{nodes.short(-mass) if mass < 0 else _mass_of(subject, link)}"',
            place="attribute",
            mark="value",
            hint="" if mass < 0 else "Set the mass in kg.",
        )


@rule(robot_codes.INERTIA_MISSING)
def inertia_missing(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot in subject.robots:
        if robot.description.static:
            continue
        for root, parts in robot.rigid_groups.items():
            # An SDF link without an <inertial> has a mass of 1 kg.
            group = [name for name in parts if name not in robot.in_sdf]
            if root == "world" or root in robot.mended or root in robot.in_sdf:
                continue
            if any(_stated(robot.links[name]) for name in group):
                continue
            holder = robot.inbound.get(root)
            if holder is not None and holder.type == "fixed":
                continue  # fixed to the world
            shaped = next((name for name in group if robot.solids(name)), None)
            link = robot.links[shaped or root]
            what, consequence = f'the root link "{root}"', "does not load the robot"
            if holder is not None:
                what = f'the moving link "{root}"'
                consequence = "ignores the link and everything attached to it"
            yield robot_codes.INERTIA_MISSING.diagnostic(
                message=f"{what} has no <inertial>, so Gazebo {consequence}",
                values={"link": root},
                origin=link.origin,
                instead=_inertial_text(_shape_inertia(robot, link), 1.0),
                place="inside",
                mark=f'name="{link.name}"',
                hint="The suggested values are for 1 kg. Scale mass and inertia together.",
            )


@rule(robot_codes.INERTIA_GEOMETRY_MISMATCH)
def inertia_unlike_geometry(subject: Subject) -> Iterator[Diagnostic]:
    for robot, link, inertial in _judged(subject):
        solids = [solid.vertices for solid in robot.solids(link.name)]
        box = bounds(robot.rigid_cloud(link.name))
        if box is None or not robot.whole(link.name):
            continue
        centre = np.array(inertial.pose.position)
        corner = np.maximum(np.abs(box[0] - centre), np.abs(box[1] - centre))
        stated = sum(inertial.diagonal) / 2
        largest = inertial.mass * float(corner @ corner)
        like = _shape_inertia(robot, link)
        in_sdf = link.name in robot.in_sdf
        advice = _inertia_text(like, inertial.mass, sdf=in_sdf)
        if stated > TOO_LARGE * largest:
            yield robot_codes.INERTIA_GEOMETRY_MISMATCH.diagnostic(
                severity=None if _matters(robot, link, stated) else "info",
                message=f'the inertia of link "{link.name}" is {_ratio(stated / largest)} times '
                f"the largest inertia that a {_weight(inertial.mass)} body of this geometry can "
                "have",
                values={
                    "link": link.name,
                    "ratio": stated / largest,
                    "mass": inertial.mass,
                    "attribute": "large",
                },
                origin=_inertia_origin(robot, inertial),
                instead=advice,
                place="" if in_sdf else "element",
            )
            continue
        if not solids or like is None:
            continue
        solid = sum(like.diagonal) / 2 * inertial.mass / like.mass
        if 0 < stated < solid / TOO_SMALL:
            light = inertial.mass < _LIGHT * robot.description.mass
            yield robot_codes.INERTIA_GEOMETRY_MISMATCH.diagnostic(
                severity="info" if light else None,
                message=f'the inertia of link "{link.name}" is {_ratio(solid / stated)} times '
                f"smaller than that of a solid {_weight(inertial.mass)} body of this geometry",
                values={
                    "link": link.name,
                    "ratio": stated / solid,
                    "mass": inertial.mass,
                    "attribute": "small",
                },
                origin=_inertia_origin(robot, inertial),
                instead=advice,
                place="" if in_sdf else "element",
            )


@rule(robot_codes.CENTER_OF_MASS_OUTSIDE)
def mass_outside(subject: Subject) -> Iterator[Diagnostic]:
    for robot, link, inertial in _judged(subject):
        box = bounds(robot.rigid_cloud(link.name))
        if box is None or not robot.whole(link.name):
            continue
        if inertial.mass < _LIGHT * robot.description.mass:
            continue
        centre = np.array(inertial.pose.position)
        beyond = np.maximum(np.maximum(box[0] - centre, centre - box[1]), 0.0)
        away, across = float(np.linalg.norm(beyond)), float(np.linalg.norm(box[1] - box[0]))
        if away > max(OUTSIDE * across, 0.005):
            middle = (box[0] + box[1]) / 2
            xyz = " ".join(nodes.short(round(float(value), 6)) for value in middle)
            in_sdf = link.name in robot.in_sdf
            node = robot.node_at(inertial.origin)
            origin = nodes.child(node, "origin")
            yield robot_codes.CENTER_OF_MASS_OUTSIDE.diagnostic(
                message=f'the centre of mass of link "{link.name}" is {away:.3g} m outside the '
                f"link's geometry, which is {across:.3g} m across",
                values={"link": link.name, "distance": away, "size": across},
                origin=origin.origin if origin is not None else inertial.origin,
                instead=f"<pose>{xyz} 0 0 0</pose>" if in_sdf else f'<origin xyz="{xyz}"/>',
                place="" if in_sdf else "element" if origin is not None else "inside",
                hint="The suggested position is the centre of the geometry.",
                mark="xyz",
            )


@rule(robot_codes.MASS_IN_GRAMS)
def mass_grams(subject: Subject) -> Iterator[Diagnostic]:
    for robot, link, inertial in _judged(subject):
        box = bounds([solid.vertices for solid in robot.solids(link.name)])
        if box is None or inertial.mass < 1.0:
            continue
        volume = max(float(np.prod(box[1] - box[0])), 1e-18)
        density = inertial.mass / volume
        if density < DENSEST:
            continue
        in_grams = density / 1000 > _FOAM
        node = _urdf_mass(robot, link, inertial)
        yield robot_codes.MASS_IN_GRAMS.diagnostic(
            message=f'link "{link.name}" weighs {inertial.mass:g} kg and has a bounding box of '
            f"{' x '.join(f'{1000 * value:.3g}' for value in box[1] - box[0])} mm, so its "
            f"density of {_ratio(density / 1000)} kg/L is higher than that of any metal",
            values={"link": link.name, "mass": inertial.mass, "density": density},
            origin=node.origin if node is not None else inertial.origin,
            instead=_mass_text(inertial.mass / 1000, sdf=node is None) if in_grams else "",
            place="attribute" if node is not None and in_grams else "",
            mark="value",
            hint="Is the mass in grams?"
            if in_grams
            else f"The same volume of water weighs {1000 * volume:.3g} kg.",
        )


@rule(robot_codes.MASS_IMPLAUSIBLE)
def mass_absurd(subject: Subject) -> Iterator[Diagnostic]:
    for robot, link, inertial in _judged(subject):
        if inertial.mass > 100_000:
            node = _urdf_mass(robot, link, inertial)
            yield robot_codes.MASS_IMPLAUSIBLE.diagnostic(
                message=f'link "{link.name}" weighs {inertial.mass:g} kg',
                values={"link": link.name, "mass": inertial.mass},
                origin=node.origin if node is not None else inertial.origin,
                instead=_mass_text(inertial.mass / 1000, sdf=node is None),
                place="attribute" if node is not None else "",
                hint="Is the mass in grams?",
                mark="value",
            )


def moments_of(inertial: Node) -> Vec3 | None:
    """Principal moments of an ``<inertial>``; None if a value is not a number."""
    tensor = nodes.child(inertial, "inertia")
    values = {
        key: nodes.number("0" if tensor is None else tensor.attributes.get(key, "0"))
        for key in _KEYS
    }
    found = {key: value for key, value in values.items() if value is not None}
    if len(found) < len(_KEYS):
        return None
    return principal_moments(
        (found["ixx"], found["iyy"], found["izz"]), (found["ixy"], found["ixz"], found["iyz"])
    )


def _inertials(subject: Subject) -> Iterator[tuple[Node, Node]]:
    if not subject.is_urdf:
        return
    for link in nodes.children(subject.root, "link"):
        inertial = nodes.child(link, "inertial")
        if inertial is not None:
            yield link, inertial


def _judged(subject: Subject) -> Iterator[tuple[Robot, Link, Inertial]]:
    """Movable links with a mass stated by the author."""
    for robot in subject.robots:
        if robot.description.static:
            continue
        for link in robot.description.links:
            inertial = link.inertial
            if inertial is None or link.name in robot.mended:
                continue
            if _stated(link):
                yield robot, link, inertial


def _stated(link: Link) -> bool:
    """Whether the author stated the mass; SDF's default of 1 kg and estimates are excluded."""
    return link.inertial is not None and link.inertial.origin is not link.origin


def _held(subject: Subject) -> set[str]:
    """Links connected by fixed joints, which share one combined inertia."""
    joints, names = nodes.children(subject.root, "joint"), link_names(subject)
    holders = inbound(joints, names)
    found = {name for name, joint in holders.items() if nodes.text_of(joint, "type") == "fixed"}
    return found | {ends(holders[name])[0] for name in found}


def _is_part(subject: Subject, name: str, moment: float) -> bool:
    """Whether a link's inertia is negligible compared with the links it is fixed to."""
    robots = [robot for robot in subject.robots if name in robot.links]
    return bool(robots) and not any(_matters(one, one.links[name], moment) for one in robots)


def _shape_inertia(robot: Robot, link: Link) -> Inertial | None:
    """Inertia of a solid with the shape of the link's collisions, or of its visuals."""
    for parts in (link.collisions, link.visuals):
        found = _solid(parts, link.origin)
        if found is not None:
            return found
    box = bounds(robot.rigid_cloud(link.name))
    return None if box is None else _box_inertia(box, link.origin)


def _mass_of(subject: Subject, link: Node) -> str:
    """Mass for which the geometry has the stated inertia, kg; 0.1 without geometry."""
    moments = moments_of(nodes.child(link, "inertial") or link)
    like = _sketch(subject, nodes.name_of(link))
    whole = sum((like.ixx, like.iyy, like.izz)) if like is not None else 0.0
    if like is None or moments is None or whole <= 0 or sum(moments) <= 0:
        return "0.1"
    return f"{sum(moments) * like.mass / whole:.3g}"


def _sketch(subject: Subject, link: str) -> Inertial | None:
    for robot in subject.robots:
        if link in robot.links:
            return _shape_inertia(robot, robot.links[link])
    return None


def _solid(parts: tuple[Collision, ...] | tuple[Visual, ...], origin: Origin) -> Inertial | None:
    try:
        found = inertial_of([as_collision(part) for part in parts], [1.0] * len(parts), origin)
    except Exception:  # noqa: BLE001 - a mesh that cannot be read is another rule's finding
        return None
    if found is None:
        return None
    # The volume of an open surface is arbitrary.
    return None if impossibility(principal_moments(found.diagonal, found.products)) else found


def _box_inertia(box: tuple[np.ndarray, np.ndarray], origin: Origin) -> Inertial | None:
    low, high = box
    size = np.maximum(high - low, 1e-6)
    middle = (low + high) / 2
    part = Collision(
        name="box",
        pose=Pose((float(middle[0]), float(middle[1]), float(middle[2]))),
        shape=Box(size=(float(size[0]), float(size[1]), float(size[2]))),
        origin=origin,
    )
    return inertial_of([part], [1.0], origin)


def _mass_text(mass: float, *, sdf: bool) -> str:
    return f"<mass>{nodes.short(mass)}</mass>" if sdf else f'value="{nodes.short(mass)}"'


def _inertia_text(like: Inertial | None, mass: float, *, sdf: bool = False) -> str:
    if like is None:
        # Without a shape, assume a ball of water.
        moment = 0.4 * mass * (3 * mass / 4000 / math.pi) ** (2 / 3)
        values = dict.fromkeys(("ixx", "iyy", "izz"), moment)
    else:
        values = {key: getattr(like, key) * mass / like.mass for key in _KEYS}
    largest = max(values["ixx"], values["iyy"], values["izz"])
    shown = {
        key: nodes.short(value) if abs(value) > 1e-3 * largest else "0"
        for key in _KEYS
        for value in (values.get(key, 0.0),)
    }
    if sdf:
        return nodes.written("inertia", {}, "".join(f"<{k}>{v}</{k}>" for k, v in shown.items()))
    return nodes.written("inertia", shown)


def _inertial_text(like: Inertial | None, mass: float) -> str:
    centre = like.pose.position if like is not None else (0.0, 0.0, 0.0)
    xyz = " ".join(nodes.short(round(value, 6) + 0.0) for value in centre)
    return (
        f'<inertial><origin xyz="{xyz}"/><mass value="{mass:g}"/>'
        f"{_inertia_text(like, mass)}</inertial>"
    )


def _urdf_mass(robot: Robot, link: Link, inertial: Inertial) -> Node | None:
    """The ``<mass>`` element of a URDF link; None for an SDF link."""
    if link.name in robot.in_sdf:
        return None
    return nodes.child(robot.node_at(inertial.origin), "mass")


def _inertia_origin(robot: Robot, inertial: Inertial) -> Origin:
    tensor = nodes.child(robot.node_at(inertial.origin), "inertia")
    return tensor.origin if tensor is not None else inertial.origin


def _matters(robot: Robot, link: Link, moment: float) -> bool:
    """Whether an inertia exceeds a twentieth of the inertia of the rest of the rigid group."""
    group = robot.rigid_groups[robot.rigid_root(link.name)]
    others = [
        (other.pose @ other.inertial.pose, other.inertial)
        for name in group
        if (other := robot.links[name]) is not link and other.inertial is not None
    ]
    if not others:
        return True
    mass = sum(inertial.mass for _, inertial in others)
    places = np.array([pose.position for pose, _ in others])
    weights = np.array([inertial.mass for _, inertial in others])
    centre = weights @ places / mass
    own = sum(sum(inertial.diagonal) / 2 for _, inertial in others)
    return moment > 0.05 * (own + float(weights @ ((places - centre) ** 2).sum(axis=1)))


def _ratio(value: float) -> str:
    """A number with three digits, without an exponent up to a million times a million."""
    return f"{value:.3g}" if value < 1000 or value > 1e12 else f"{float(f'{value:.3g}'):,.0f}"


def _weight(mass: float) -> str:
    return f"{1000 * mass:.3g} g" if mass < _LIGHTEST_IN_KG else f"{mass:.3g} kg"


RULES = (
    inertia_missing,
    inertia_impossible,
    inertia_unlike_geometry,
    mass_not_positive,
    mass_outside,
    mass_grams,
    mass_absurd,
)
