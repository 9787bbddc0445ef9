"""Moves a model with all its links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import mujoco
import numpy as np

from cartwheel.description.model import Joint, Link, RobotDescription
from cartwheel.geometry import Pose, Vec3, cross, to_wxyz
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.waking import keep_awake
from cartwheel.world.entry import ModelEntry
from cartwheel.world.joints import limits_of


def place_model(engine: Engine, entry: ModelEntry, pose: Pose, linear: Vec3, angular: Vec3) -> None:
    """Moves a free model as a rigid body: its free links keep their relative poses.

    Args:
        engine: The engine with the model.
        entry: The model.
        pose: Pose of its frame in the world.
        linear: Velocity of the frame's origin, m/s, in world axes.
        angular: rad/s, in world axes.
    """
    engine.forward()
    description = entry.description
    here = engine.link_pose(entry.name, description.canonical_link)
    step = pose @ description.canonical_pose @ here.inverse()
    places = {
        joint: step @ engine.link_pose(entry.name, link.name)
        for link in description.links
        if (joint := engine.free_joint(entry.name, link.name)) >= 0
    }
    keep_awake(engine, places)
    _stop(engine, entry)
    for joint, place in places.items():
        carried = _carried(place, pose, linear, angular)
        engine.place(joint, place, carried, angular)


def put_fixed(engine: Engine, entry: ModelEntry) -> list[int]:
    """Writes a pose to the model, without the places in the data that depend on it.

    Args:
        engine: The engine with the model.
        entry: A model that is fixed to the world, with its new pose.

    Returns:
        The bodies of its links without a parent link.
    """
    model = engine.model
    bodies = fixed_roots(engine, entry)
    for link, body in zip(_roots(entry.description), bodies, strict=True):
        pose = entry.pose @ link.pose
        turn = np.array(to_wxyz(pose.orientation))
        mujoco.mju_normalize4(turn)
        model.body_pos[body], model.body_quat[body] = pose.position, turn
        free = engine.free_joint(entry.name, link.name)
        if free >= 0:
            # Where it is after a reset.
            start = int(model.jnt_qposadr[free])
            model.qpos0[start : start + 7] = (*pose.position, *turn)
            model.qpos_spring[start : start + 7] = model.qpos0[start : start + 7]
    return bodies


def fixed_roots(engine: Engine, entry: ModelEntry) -> list[int]:
    """The bodies of a model's links without a parent link."""
    return [engine.body_id(entry.name, link.name) for link in _roots(entry.description)]


def push_off(engine: Engine, entry: ModelEntry, linear: Vec3, angular: Vec3) -> None:
    """Sets the velocity of a free model as a rigid body, where it is.

    Args:
        engine: The engine with the model, whose poses are computed.
        entry: The model.
        linear: Velocity of its frame's origin, m/s, in world axes.
        angular: rad/s, in world axes.
    """
    pose = engine.model_pose(entry)
    _stop(engine, entry)
    for link in entry.description.links:
        joint = engine.free_joint(entry.name, link.name)
        if joint >= 0:
            place = engine.link_pose(entry.name, link.name)
            engine.set_velocity(joint, _carried(place, pose, linear, angular), angular)


def _carried(place: Pose, pose: Pose, linear: Vec3, angular: Vec3) -> Vec3:
    """The velocity of a link's origin that moves with a frame as a rigid body, m/s."""
    arm = np.subtract(place.position, pose.position)
    vx, vy, vz = (np.asarray(linear) + cross(angular, arm)).tolist()
    return vx, vy, vz


def with_mimics(
    description: RobotDescription, positions: Mapping[str, float], *, offsets: bool = True
) -> dict[str, float]:
    """The positions, extended by joints that mimic them directly or indirectly, up to their limits.

    Args:
        description: The model.
        positions: By joint, rad or m; or velocities without `offsets`, rad/s or m/s.
        offsets: Whether to add the offsets of the positions.
    """
    found = dict(positions)
    joints = [joint for joint in description.joints if joint.mimic is not None]
    for _ in joints:
        for joint in joints:
            mimic = joint.mimic
            if mimic is not None and joint.name not in positions and mimic.joint in found:
                target = mimic.multiplier * found[mimic.joint]
                found[joint.name] = _limited(joint, target + mimic.offset) if offsets else target
    return found


def _limited(joint: Joint, position: float) -> float:
    """The position nearest to a follower's target within its limits."""
    bounds = limits_of(joint, joint.axis, follows=True)
    return position if bounds is None else min(max(position, bounds[0]), bounds[1])


def _stop(engine: Engine, entry: ModelEntry) -> None:
    bodies = [engine.body_id(entry.name, link.name) for link in entry.description.links]
    for body in bodies:
        start, count = engine.model.body_dofadr[body], engine.model.body_dofnum[body]
        if count:
            engine.data.qvel[start : start + count] = 0.0


def _roots(description: RobotDescription) -> Iterator[Link]:
    """The links without a parent link."""
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    for link in description.links:
        if link.name not in inbound or inbound[link.name].parent == "world":
            yield link
