"""Inertias: whether they are physically possible and plausible for the geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import cast

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.masses import (
    LIGHT,
    in_fixed_groups,
    inertia_of_geometry,
    inertials,
    is_stated,
    links_with_mass,
    moments_of,
    ratio_text,
    shape_inertia,
    stated_inertials,
)
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.inertia import (
    LIGHTEST,
    REFUSES,
    TOLERANCE,
    TOLERANCE_OF_GZ,
    impossibility,
    is_refused,
    refused_groups,
)
from cartwheel.description.kinematics import held_parts
from cartwheel.description.model import MOMENTS, Inertial, Link
from cartwheel.description.solids import bounds
from cartwheel.errors import Diagnostic, Origin
from cartwheel.geometry import Pose, Vec3

TOO_LARGE = 1.5
"""Maximum ratio to the inertia of the same mass placed at the corners of the geometry's box."""
_WITHOUT_MESHES = 1000.0
"""The same if the geometry lacks meshes, which may be larger than the rest of it."""
TOO_SMALL = 20.0
"""Maximum ratio of the inertia of a solid of the same shape to the stated inertia."""
_MARKER = 1e-3
"""Size of the geometry of a link that only marks a place, m. The inertia of such a body would be
too small for Gazebo."""
_LIGHTEST_IN_KG = 0.1
_ROUNDED = 1e-9
"""Relative rounding error of a value that should be 0."""
_NEVERTHELESS = "Gazebo Classic simulates this inertia anyway"
_INCREASED = "Cartwheel increases the smaller moments."
_WITHOUT = "Gazebo Classic divides by zero. Cartwheel computes the inertia from the geometry."


@rule(robot_codes.INERTIA_MISSING)
def inertia_missing(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot in subject.robots:
        if robot.description.static:
            continue
        bases = held_parts(robot.description.joints)
        for root, parts in robot.rigid_groups.items():
            # An SDF link without an <inertial> has a mass of 1 kg.
            group = [name for name in parts if name not in robot.in_sdf]
            if root == "world" or root in robot.mended or root in robot.in_sdf:
                continue
            holder = robot.inbound.get(root)
            held = holder is not None and holder.type == "fixed"
            if held and root not in bases:
                continue
            if held:
                # Gazebo merges no link into the world.
                merged = frozenset(bases[root])
                group = [name for name in group if name in merged]
            if any(is_stated(robot.links[name]) for name in group):
                continue
            shaped = next((name for name in group if robot.solids(name)), None)
            link = robot.links[shaped or root]
            what, consequence = f'the root link "{root}"', "does not load the robot"
            if holder is not None:
                what = (
                    f'link "{root}", which is fixed to the world,'
                    if held
                    else f'the moving link "{root}"'
                )
                consequence = "ignores the link and everything attached to it"
            yield robot_codes.INERTIA_MISSING.diagnostic(
                message=f"{what} has no <inertial>, so Gazebo {consequence}",
                values={"link": root},
                origin=link.origin,
                instead=_inertial_text(shape_inertia(robot, link), 1.0),
                place="inside",
                mark=f'name="{link.name}"',
                hint="The suggested values are for 1 kg. For a different mass, multiply the mass "
                "and the inertia by the same factor.",
            )


@rule(robot_codes.INERTIA_IMPOSSIBLE)
def inertia_impossible(subject: Subject) -> Iterator[Diagnostic]:
    for failure in subject.failures:
        if "moments" in failure.values:
            yield replace(failure, severity="warning")
    yield from _impossible_in_sdf(subject)
    held = in_fixed_groups(subject)
    refused = _refused(subject)
    tolerance = TOLERANCE_OF_GZ if subject.simulator == "gz" else TOLERANCE
    for link, inertial in inertials(subject):
        tensor = nodes.child(inertial, "inertia")
        moments = moments_of(inertial)
        mass = nodes.number(nodes.text_of(nodes.child(inertial, "mass"), "value"))
        if moments is None or mass is None or mass < LIGHTEST:
            continue
        wrong = impossibility(moments, tolerance)
        name = nodes.name_of(link)
        if wrong is None or (not any(moments) and name in held):
            continue
        place = tensor or inertial
        negative = min(moments) < -_ROUNDED * max(moments)
        # The inertia is a small part of the sum with a heavier link that this one is fixed to.
        part = name not in refused and _is_part(subject, name, max(moments))
        is_error = negative or name in refused
        yield robot_codes.INERTIA_IMPOSSIBLE.diagnostic(
            severity="info" if part else "error" if is_error else None,
            message=f'link "{name}": {wrong[0]}{f"; {REFUSES}" if name in refused else ""}',
            values={"link": name, "moments": moments},
            origin=place.origin,
            instead=_inertia_text(inertia_of_geometry(subject, name), mass),
            place="element" if tensor is not None else "inside",
            hint="" if part or is_error else _fate(moments) if any(moments) else _WITHOUT,
        )


def _fate(moments: Vec3) -> str:
    """What simulators do with an impossible inertia."""
    return (
        f"{_NEVERTHELESS}{', but gz-sim rejects it' if is_refused(moments) else ''}. {_INCREASED}"
    )


def _refused(subject: Subject) -> frozenset[str]:
    """The links of a URDF that gz-sim merges into ones for which it does not load the robot.

    Empty for a robot that may be for Gazebo Classic.
    """
    if subject.simulator != "gz":
        return frozenset()
    stated = dict(stated_inertials(subject))
    groups: dict[str, dict[str, tuple[Pose, Inertial]]] = {}
    for robot in subject.robots:
        for name in stated.keys() & robot.placed:
            group = groups.setdefault(robot.merged_root(name), {})
            group[name] = robot.links[name].pose, stated[name]
    return refused_groups(groups.values())


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
        moments = cast(Vec3, values["moments"])
        wrong = impossibility(moments, TOLERANCE_OF_GZ)
        like = shape_inertia(robot, link) if robot is not None and link is not None else None
        mass = link.inertial.mass if link is not None and link.inertial is not None else 1.0
        refused = values.get("refused") is True
        yield robot_codes.INERTIA_IMPOSSIBLE.diagnostic(
            severity="error" if refused else diagnostic.severity,
            message=f'link "{values["link"]}": {wrong[0]}{f"; {REFUSES}" if refused else ""}'
            if wrong
            else diagnostic.message,
            values=values,
            origin=diagnostic.origin,
            instead=_inertia_text(like, mass, sdf=True),
            hint="" if refused else _fate(moments),
        )


@rule(robot_codes.INERTIA_GEOMETRY_MISMATCH)
def inertia_unlike_geometry(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        yield from _assumed(robot)
    for robot, link, inertial in links_with_mass(subject):
        solids = [solid.vertices for solid in robot.solids(link.name)]
        box = bounds(robot.rigid_cloud(link.name))
        if box is None:
            continue
        whole = robot.whole(link.name)
        centre = np.array(inertial.pose.position)
        corner = np.maximum(np.abs(box[0] - centre), np.abs(box[1] - centre))
        if float(np.max(box[1] - box[0])) < _MARKER:
            continue
        stated = sum(inertial.diagonal) / 2
        largest = inertial.mass * float(corner @ corner)
        like = shape_inertia(robot, link)
        in_sdf = link.name in robot.in_sdf
        advice = _inertia_text(like, inertial.mass, sdf=in_sdf)
        if stated > (TOO_LARGE if whole else _WITHOUT_MESHES) * largest:
            yield robot_codes.INERTIA_GEOMETRY_MISMATCH.diagnostic(
                severity=None if _matters(robot, link, stated) else "info",
                message=f'the inertia of link "{link.name}" is {ratio_text(stated / largest)} '
                f"times the largest inertia that a {_weight(inertial.mass)} body of this geometry "
                "can have",
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
        if not solids or like is None or not whole:
            continue
        solid = sum(like.diagonal) / 2 * inertial.mass / like.mass
        if 0 < stated < solid / TOO_SMALL:
            light = inertial.mass < LIGHT * robot.description.mass
            yield robot_codes.INERTIA_GEOMETRY_MISMATCH.diagnostic(
                severity="info" if light else None,
                message=f'the inertia of link "{link.name}" is {ratio_text(solid / stated)} times '
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


def _assumed(robot: Robot) -> Iterator[Diagnostic]:
    """Links of SDF on movable joints for which the defaults 1 kg and 1 kg m² are used."""
    if robot.description.static:
        return
    for joint in robot.joints.values():
        link = robot.links.get(joint.child)
        if link is None or link.name not in robot.in_sdf or joint.type == "fixed":
            continue
        inertial, like = link.inertial, shape_inertia(robot, link)
        box = bounds(robot.rigid_cloud(link.name))
        if inertial is None or is_stated(link) or like is None or box is None:
            continue
        if len(robot.rigid_groups[robot.rigid_root(link.name)]) > 1:
            continue  # The other links may account for the inertia.
        corner = np.maximum(np.abs(box[0]), np.abs(box[1]))
        ratio = sum(inertial.diagonal) / 2 / (inertial.mass * float(corner @ corner))
        if ratio > TOO_LARGE:
            tensor = _inertia_text(like, 1.0, sdf=True)
            yield robot_codes.INERTIA_GEOMETRY_MISMATCH.diagnostic(
                message=f'link "{link.name}" has no <inertial>, so its mass is 1 kg and its '
                f"moments of inertia are 1 kg m², {ratio_text(ratio)} times the largest ones that "
                "a 1 kg body of this geometry can have",
                values={
                    "link": link.name,
                    "ratio": ratio,
                    "mass": inertial.mass,
                    "attribute": "large",
                },
                origin=link.origin,
                instead=nodes.written("inertial", {}, f"<mass>1</mass>{tensor}"),
                place="inside",
                mark="<link",
                hint="The suggested values are for 1 kg. For a different mass, multiply the mass "
                "and the inertia by the same factor.",
            )


def _is_part(subject: Subject, name: str, moment: float) -> bool:
    """Whether a link's inertia is negligible compared with the links it is fixed to."""
    robots = [robot for robot in subject.robots if name in robot.links]
    return bool(robots) and not any(_matters(one, one.links[name], moment) for one in robots)


def _inertia_text(like: Inertial | None, mass: float, *, sdf: bool = False) -> str:
    if like is None:
        # Without a shape, assume a ball of water.
        moment = 0.4 * mass * (3 * mass / 4000 / math.pi) ** (2 / 3)
        values = dict.fromkeys(("ixx", "iyy", "izz"), moment)
    else:
        values = like.scaled(mass)
    largest = max(values["ixx"], values["iyy"], values["izz"])
    shown = {
        key: nodes.short(value) if abs(value) > 1e-3 * largest else "0"
        for key in MOMENTS
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


def _weight(mass: float) -> str:
    return f"{1000 * mass:.3g} g" if mass < _LIGHTEST_IN_KG else f"{mass:.3g} kg"
