"""Masses and centres of mass: whether they are plausible for the geometry."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cartwheel.checks import edits, nodes
from cartwheel.checks.masses import (
    LIGHT,
    in_fixed_groups,
    inertia_of_geometry,
    inertials,
    links_with_mass,
    moments_of,
    ratio_text,
)
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.description.inertia import LIGHTEST
from cartwheel.description.model import Inertial, Link
from cartwheel.description.solids import bounds
from cartwheel.errors import Diagnostic

OUTSIDE = 0.25
"""Maximum distance of the centre of mass from the box, as a fraction of the box's diagonal."""
DENSEST = 30_000.0
"""kg/m³; the density of osmium is 22,600."""
_FOAM = 50.0
"""kg/m³; a mass with a lower density was not stated in grams."""


@rule(robot_codes.MASS_NOT_POSITIVE)
def mass_not_positive(subject: Subject) -> Iterator[Diagnostic]:
    held = in_fixed_groups(subject) - _in_groups_without_mass(subject)
    for link, inertial in inertials(subject):
        place = nodes.child(inertial, "mass")
        mass = nodes.number(nodes.text_of(place, "value"))
        if place is None or mass is None or mass >= LIGHTEST:
            continue
        if mass >= 0 and nodes.name_of(link) in held:
            continue  # a frame without geometry, which Gazebo merges into its parent
        yield robot_codes.MASS_NOT_POSITIVE.diagnostic(
            message=f'link "{nodes.name_of(link)}" has a mass of {mass:g} kg, so Gazebo ignores '
            "the link and everything attached to it",
            values={"link": nodes.name_of(link), "mass": mass},
            **edits.attribute(
                place, "value", nodes.short(-mass) if mass < 0 else _mass_of(subject, link)
            ),
            hint="" if mass < 0 else "Set the mass in kg.",
        )


def _in_groups_without_mass(subject: Subject) -> set[str]:
    """The links of each group, connected by fixed joints, in which no mass is positive."""
    heavy = {
        nodes.name_of(link)
        for link, inertial in inertials(subject)
        if (nodes.number(nodes.text_of(nodes.child(inertial, "mass"), "value")) or 0) >= LIGHTEST
    }
    return {
        name
        for robot in subject.robots
        for root, parts in robot.rigid_groups.items()
        if root != "world" and heavy.isdisjoint(parts)
        for name in parts
    }


@rule(robot_codes.CENTER_OF_MASS_OUTSIDE)
def mass_outside(subject: Subject) -> Iterator[Diagnostic]:
    for robot, link, inertial in links_with_mass(subject):
        box = bounds(robot.rigid_cloud(link.name))
        if box is None or not robot.whole(link.name):
            continue
        if inertial.mass < LIGHT * robot.description.mass:
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
    for robot, link, inertial in links_with_mass(subject):
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
            f"density of {ratio_text(density / 1000)} g/cm³ is higher than that of any metal",
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
    for robot, link, inertial in links_with_mass(subject):
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


def _mass_of(subject: Subject, link: Node) -> str:
    """Mass for which the geometry has the stated inertia, kg; 0.1 without geometry."""
    moments = moments_of(nodes.child(link, "inertial") or link)
    like = inertia_of_geometry(subject, nodes.name_of(link))
    whole = sum((like.ixx, like.iyy, like.izz)) if like is not None else 0.0
    if like is None or moments is None or whole <= 0 or sum(moments) <= 0:
        return "0.1"
    return f"{sum(moments) * like.mass / whole:.3g}"


def _mass_text(mass: float, *, sdf: bool) -> str:
    return f"<mass>{nodes.short(mass)}</mass>" if sdf else f'value="{nodes.short(mass)}"'


def _urdf_mass(robot: Robot, link: Link, inertial: Inertial) -> Node | None:
    """The ``<mass>`` element of a URDF link; None for an SDF link."""
    if link.name in robot.in_sdf:
        return None
    return nodes.child(robot.node_at(inertial.origin), "mass")
