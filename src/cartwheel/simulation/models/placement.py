"""Moves a model with all its links."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.engine import Engine
from cartwheel.world.entry import ModelEntry


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
        link.name: step @ engine.link_pose(entry.name, link.name)
        for link in description.links
        if engine.free_joint(entry.name, link.name) >= 0
    }
    _stop(engine, entry)
    for link, place in places.items():
        arm = np.subtract(place.position, pose.position)
        vx, vy, vz = (np.asarray(linear) + np.cross(angular, arm)).tolist()
        engine.place(engine.free_joint(entry.name, link), place, (vx, vy, vz), angular)


def with_mimics(description: RobotDescription, positions: Mapping[str, float]) -> dict[str, float]:
    """The positions, extended by joints that mimic them directly or indirectly."""
    found = dict(positions)
    mimics = {joint.name: joint.mimic for joint in description.joints if joint.mimic is not None}
    for _ in mimics:
        for name, mimic in mimics.items():
            if name not in positions and mimic.joint in found:
                found[name] = mimic.offset + mimic.multiplier * found[mimic.joint]
    return found


def _stop(engine: Engine, entry: ModelEntry) -> None:
    bodies = [engine.body_id(entry.name, link.name) for link in entry.description.links]
    for body in bodies:
        start, count = engine.model.body_dofadr[body], engine.model.body_dofnum[body]
        if count:
            engine.data.qvel[start : start + count] = 0.0
