"""Puts a model somewhere else with all that belongs to it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.engine import Engine
from cartwheel.world.entry import ModelEntry


def place_model(engine: Engine, entry: ModelEntry, pose: Pose, linear: Vec3, angular: Vec3) -> None:
    """Moves a free model as one body: its free links keep their places to each other.

    Args:
        engine: With the model in it.
        entry: The model.
        pose: Of its frame in the world.
        linear: m/s, of the frame's origin, in the world's axes.
        angular: rad/s, in the world's axes.
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
    """The positions, and those of the joints that mimic them, one of another too."""
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
