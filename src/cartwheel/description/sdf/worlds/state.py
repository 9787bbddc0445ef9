"""SDF's ``<state>``: the positions at the time when Gazebo saved the world."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cartwheel.codes.tags import NOT_SIMULATED
from cartwheel.description.elements.numbers import FARTHEST_JOINT
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Light, Link, RobotDescription
from cartwheel.description.sdf.context import Context, read_pose, require_name
from cartwheel.description.sdf.frames import WORLD
from cartwheel.description.sdf.model import read_model
from cartwheel.errors import Diagnostic, Severity, Value
from cartwheel.geometry import Pose, quat_from_axis_angle

_NEAR = 1e-3
"""Tolerance for a saved link, m and rad: Gazebo writes six digits."""


def apply_state(
    node: Node, models: list[RobotDescription], lights: list[Light], ctx: Context
) -> tuple[list[RobotDescription], list[Light]]:
    """Models and lights with the saved state.

    The poses of models, lights and links without joints are used, and joint positions that follow
    from their links' poses. The rest is reported.
    """
    node.get("world_name")
    deletions = node.child("deletions")
    gone = {each.text.strip() for each in deletions.all("name")} if deletions is not None else set()
    known = {model.name for model in models} | {light.name for light in lights}
    for name in sorted(gone - known):
        assert deletions is not None
        ctx.report(_ignored(f'the state deletes the unknown model "{name}"', deletions, name))
    models = [model for model in models if model.name not in gone]
    lights = [light for light in lights if light.name not in gone]
    insertions = node.child("insertions")
    if insertions is not None:
        for each in insertions.all("model"):
            model = read_model(each, ctx)
            models.append(model.describe(model.pose, ctx))
    saved_models = {each.get("name") or "": each for each in node.all("model")}
    saved_lights = {each.get("name") or "": each for each in node.all("light")}
    for name in saved_models.keys() - {model.name for model in models}:
        saved_models[name].mark()
        message = f'the state refers to the unknown model "{name}"'
        ctx.report(_ignored(message, saved_models[name], name))
    models = [
        _moved(model, saved_models[model.name], ctx) if model.name in saved_models else model
        for model in models
    ]
    for name, saved in saved_lights.items():
        require_name(saved)
        pose = read_pose(saved.child("pose"))
        saved.mark()
        lights = [replace(each, pose=pose) if each.name == name else each for each in lights]
    return models, lights


def _moved(model: RobotDescription, saved: Node, ctx: Context) -> RobotDescription:
    scale = saved.child("scale")
    if scale is not None and scale.vec3() != (1.0, 1.0, 1.0):
        message = f'the scale of model "{model.name}" is not applied'
        ctx.report(_ignored(message, scale, model.name, severity="warning"))
    stated = saved.child("pose")
    pose = read_pose(stated) if stated is not None else model.pose
    links = _saved_parts(saved, "link")
    angles = {name: _angle(each) for name, each in _saved_parts(saved, "joint").items()}
    jointed = {end for joint in model.joints for end in (joint.parent, joint.child)}
    moved: list[Link] = []
    places: dict[str, Pose] = {}
    for link in model.links:
        found = links.get(link.name)
        place = found.child("pose") if found is not None else None
        if found is not None:
            _warn_motion(found, ctx)
        if place is None:
            moved.append(link)
            continue
        relative = places[link.name] = pose.inverse() @ read_pose(place)
        alone = link.name not in jointed and not _near(relative, link.pose)
        moved.append(replace(link, pose=relative) if alone else link)
    positions, lost = _positions(model, places)
    drivable = {joint.name for joint in model.joints if joint.drivable}
    for name, angle in angles.items():
        if angle is not None and name in drivable:
            positions.setdefault(name, angle)
    lost += [f'link "{name}"' for name in links.keys() - {link.name for link in model.links}]
    lost += [f'joint "{name}"' for name in angles.keys() - {joint.name for joint in model.joints}]
    if lost:
        parts = tuple(sorted(set(lost)))
        message = f'model "{model.name}": the saved state is not restored for {", ".join(parts)}'
        values = {"lost": parts}
        ctx.report(_ignored(message, saved, model.name, severity="warning", values=values))
    return replace(model, pose=pose, links=tuple(moved), joint_positions=tuple(positions.items()))


def _saved_parts(saved: Node, tag: str, prefix: str = "") -> dict[str, Node]:
    """The links or joints of a saved model; those of nested models by scoped names."""
    found = {prefix + (each.get("name") or ""): each for each in saved.all(tag)}
    for inner in saved.all("model"):
        inner.child("pose")  # the poses of its links are used instead
        found |= _saved_parts(inner, tag, f"{prefix}{inner.get('name') or ''}::")
    return found


def _angle(joint: Node) -> float | None:
    """The saved position of a joint, rad or m; None without an axis or with several."""
    axes = joint.all("angle")
    for each in axes:
        each.get("axis")
    if len(axes) != 1:
        return None
    value = axes[0].number()
    if abs(value) > FARTHEST_JOINT:
        raise axes[0].fail(
            f"angle must be between {-FARTHEST_JOINT:g} and {FARTHEST_JOINT:g} rad or m "
            f"(got {axes[0].text})",
            values={"stated": value},
        )
    return value


def _warn_motion(link: Node, ctx: Context) -> None:
    """Warns about a velocity, which is not restored: models start at rest."""
    velocity = link.child("velocity")
    if velocity is not None and any(abs(value) > _NEAR for value in velocity.vector(6)):
        name = link.attributes.get("name", "")
        message = f'the velocity of link "{name}" is not restored'
        ctx.report(_ignored(message, velocity, name, severity="warning"))


def _ignored(
    message: str,
    node: Node,
    name: str,
    *,
    severity: Severity | None = None,
    values: Mapping[str, Value] | None = None,
) -> Diagnostic:
    return NOT_SIMULATED.diagnostic(
        message,
        origin=node.origin,
        severity=severity,
        values={"tag": node.tag, "name": name, **(values or {})},
    )


def _positions(
    model: RobotDescription, places: Mapping[str, Pose]
) -> tuple[dict[str, float], list[str]]:
    """Joint positions computed from link poses in the model, and the joints without a result."""
    built = {WORLD: Pose(), **{link.name: link.pose for link in model.links}}
    places = {WORLD: Pose(), **places}
    found: dict[str, float] = {}
    lost: list[str] = []
    for joint in model.joints:
        if joint.child not in places or joint.parent not in places:
            continue
        before = built[joint.parent].inverse() @ built[joint.child]
        now = places[joint.parent].inverse() @ places[joint.child]
        if _near(before, now):
            continue
        # The joint's motion in its own frame.
        motion = (before @ joint.pose).inverse() @ now @ joint.pose
        axis = np.array(joint.axis.xyz)
        if joint.type == "prismatic":
            found[joint.name] = float(np.dot(motion.position, axis))
            stated_motion = Pose(tuple((found[joint.name] * axis).tolist()))
        elif joint.type in ("revolute", "continuous"):
            x, y, z, w = motion.orientation
            angle = 2 * math.atan2(float(np.dot((x, y, z), axis)), w)
            found[joint.name] = math.remainder(angle, 2 * math.pi)
            stated_motion = Pose((0.0, 0.0, 0.0), quat_from_axis_angle(joint.axis.xyz, angle))
        if joint.name not in found or not _near(stated_motion, motion):
            lost.append(f'joint "{joint.name}"')
    return found, lost


def _near(a: Pose, b: Pose) -> bool:
    apart = a.inverse() @ b
    return bool(
        np.abs(apart.position).max() < _NEAR and np.abs(apart.orientation[:3]).max() < _NEAR
    )
