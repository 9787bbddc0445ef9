"""Differences of descriptions that can be applied to a compiled model."""

from __future__ import annotations

from dataclasses import replace

from cartwheel.description.model import Axis, Collision, Joint, Link, RobotDescription


def differ_in_place(before: RobotDescription, after: RobotDescription) -> bool:
    """Whether two descriptions differ only in what can be applied to a compiled model."""
    if replace(after, links=before.links, joints=before.joints) != before:
        return False
    if len(after.links) != len(before.links) or len(after.joints) != len(before.joints):
        return False
    return all(map(_link_fits, before.links, after.links)) and all(
        map(_joint_fits, before.joints, after.joints)
    )


def _link_fits(before: Link, after: Link) -> bool:
    if before is after:
        return True
    same = replace(
        after,
        inertial=before.inertial,
        gravity=before.gravity,
        collisions=before.collisions,
        visuals=before.visuals,
    )
    return (
        same == before
        and (before.inertial is None) == (after.inertial is None)
        and len(before.collisions) == len(after.collisions)
        and all(map(_collision_fits, before.collisions, after.collisions))
        and len(before.visuals) == len(after.visuals)
        and all(
            one is two or replace(two, material=one.material) == one
            for one, two in zip(before.visuals, after.visuals, strict=True)
        )
    )


def _collision_fits(before: Collision, after: Collision) -> bool:
    if before is after:
        return True
    was = before.surface
    surface = replace(after.surface, mu1=was.mu1, mu2=was.mu2, kp=was.kp, kd=was.kd)
    return replace(after, surface=surface) == before


def _joint_fits(before: Joint, after: Joint) -> bool:
    if before is after:
        return True
    if (before.axis2 is None) != (after.axis2 is None):
        return False
    axis2 = None
    if before.axis2 is not None and after.axis2 is not None:
        axis2 = _with_properties(after.axis2, before.axis2)
    return replace(after, axis=_with_properties(after.axis, before.axis), axis2=axis2) == before


def _with_properties(axis: Axis, other: Axis) -> Axis:
    return replace(
        axis,
        damping=other.damping,
        friction=other.friction,
        lower=other.lower,
        upper=other.upper,
        effort=other.effort,
        velocity=other.velocity,
        spring_stiffness=other.spring_stiffness,
        spring_reference=other.spring_reference,
    )
