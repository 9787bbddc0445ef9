"""URDF's ``<inertial>``: masses, and inertias that are physically possible."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from cartwheel.codes import robot
from cartwheel.description.elements.xml import Node
from cartwheel.description.inertia import (
    HEAVIEST,
    REFUSES,
    TOLERANCE,
    TOLERANCE_OF_GZ,
    impossibility,
    made_possible,
    principal_moments,
    refused_groups,
)
from cartwheel.description.model import MOMENTS, Inertial
from cartwheel.description.urdf.context import UrdfContext, read_origin
from cartwheel.errors import DescriptionError, Diagnostic
from cartwheel.geometry import Pose


def read_inertial(node: Node) -> Inertial | None:
    """The mass and inertia of a link; None without a mass, which `cut_links` reports."""
    stated = node.child("mass")
    if stated is None or stated.get("value") is None:
        node.mark()
        return None
    mass = stated.number_of("value")
    if mass > HEAVIEST:
        raise node.fail(f"a mass must be at most {HEAVIEST:g} kg (got {mass:g})")
    tensor = node.child("inertia")
    values = {key: tensor.number_of(key, 0.0) if tensor is not None else 0.0 for key in MOMENTS}
    pose = read_origin(node)
    return Inertial(mass=mass, pose=pose, added_mass=(), origin=node.origin, **values)


def judged_inertia(inertial: Inertial, link: str, *, rigid: bool, ctx: UrdfContext) -> Inertial:
    """A link's inertia, or the nearest physically possible one.

    Many published arms contain a link with an impossible inertia. Gazebo uses whatever is stated;
    an energy-conserving engine cannot.

    Args:
        inertial: Inertial with a positive mass.
        link: Link name.
        rigid: Whether the link is fixed to another link, so that its inertia is only part of a sum.
        ctx: Receives the diagnostics.

    Raises:
        DescriptionError: No principal moment is positive.
    """
    i = inertial
    diagonal, products = i.diagonal, i.products
    moments = principal_moments(diagonal, products)
    found = impossibility(moments, TOLERANCE_OF_GZ if ctx.simulator == "gz" else TOLERANCE)
    if found is None:
        return inertial
    message, hint = found
    if not any((*diagonal, *products)):
        if rigid:
            ctx.warn(
                robot.INERTIA_IMPOSSIBLE,
                f'link "{link}" is a point mass: its inertia is 0',
                origin=i.origin,
                severity="info",
                values={"link": link},
            )
        return inertial  # a rotating part without any inertia gets one as a whole
    if moments[2] <= 0:
        raise DescriptionError(
            f'link "{link}": {message}',
            code=robot.INERTIA_IMPOSSIBLE,
            origin=i.origin,
            hint=hint,
            values={"link": link, "moments": moments},
        )
    (ixx, iyy, izz), (ixy, ixz, iyz) = made_possible(diagonal, products)
    made = replace(i, ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
    smaller = principal_moments(made.diagonal, made.products)
    ctx.warn(
        robot.INERTIA_IMPOSSIBLE,
        f'link "{link}": {message}; Cartwheel increases the smaller moments to '
        f"{smaller[0]:.4g} and {smaller[1]:.4g}",
        origin=i.origin,
        hint=hint,
        severity="info" if rigid else "warning",
        values={"link": link, "moments": moments, "used": smaller},
    )
    return made


def mark_refused(
    inertials: Mapping[str, Inertial],
    poses: Mapping[str, Pose],
    lumps: Iterable[Iterable[str]],
    ctx: UrdfContext,
) -> None:
    """Adds to the diagnostics about impossible inertias that gz-sim does not load the robot.

    It merges links across fixed joints first. Nothing is added if the robot may be for Gazebo
    Classic, which loads it.

    Args:
        inertials: The inertias as stated, by link.
        poses: The poses of the links.
        lumps: The links that Gazebo merges into each link.
        ctx: Contains the diagnostics.
    """
    reported = {each.values.get("link") for each in ctx.diagnostics if _is_impossible(each)}
    if ctx.simulator != "gz" or not reported:
        return
    refused = refused_groups(
        {name: (poses[name], inertials[name]) for name in names if name in inertials}
        for names in lumps
    )
    ctx.diagnostics[:] = [
        replace(
            each,
            severity="warning",
            message=f"{each.message}; {REFUSES}",
            values={**each.values, "refused": True},
        )
        if _is_impossible(each) and each.values.get("link") in refused
        else each
        for each in ctx.diagnostics
    ]


def _is_impossible(each: Diagnostic) -> bool:
    return each.code is robot.INERTIA_IMPOSSIBLE and "moments" in each.values


def _listed(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)
