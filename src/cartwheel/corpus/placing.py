"""The world in which a robot is tested, and its place in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cartwheel.api import Model, World
from cartwheel.corpus.flying.thrusters import is_in_space
from cartwheel.description.model import RobotDescription
from cartwheel.description.solids import bounds, solid_of
from cartwheel.dialects.sinking import is_in_water
from cartwheel.geometry import Pose

HIGH = 5.0
"""m."""
_WATER = """<sdf version="1.9"><world name="water"><gravity>0 0 -9.8</gravity>
<plugin name="buoyancy" filename="gz-sim-buoyancy-system"/></world></sdf>"""
"""A world filled with water, for vehicles in water."""
_SPACE = """<sdf version="1.9"><world name="space"><gravity>0 0 0</gravity></world></sdf>"""
"""A world without gravity and ground, for spacecraft."""


def surroundings(robot: RobotDescription) -> str:
    """The world in which a robot is tested."""
    if is_in_water(robot):
        return _WATER
    return _SPACE if is_in_space(robot) else "empty"


def put(world: World, robot: RobotDescription, controllers: Sequence[Path]) -> Model:
    """The robot, on the ground of the world or above it."""
    pose = place(robot)
    return world.spawn(
        robot, name=name_in(world, robot), x=pose.x, y=pose.y, z=pose.z,
        roll=pose.rpy[0], pitch=pose.rpy[1], yaw=pose.rpy[2], controllers=controllers,
    )  # fmt: skip


def name_in(world: World, robot: RobotDescription) -> str:
    """A name for the robot that is part of its topics. A ground_plane already exists."""
    return f"{robot.name}_tried" if robot.name in world.models else robot.name


def place(robot: RobotDescription) -> Pose:
    """The pose at which the lowest collision touches the ground; well above it for a fixed robot.

    An arm may extend below its base.
    """
    if robot.static:
        return robot.pose
    clouds = [
        solid.placed(robot.pose @ link.pose)
        for link in robot.links
        for collision in link.collisions
        if (solid := solid_of(collision, link.name)) is not None
    ]
    box = bounds(clouds)
    if any(joint.parent == "world" for joint in robot.joints):
        lowest = 0.0 if box is None else float(np.round(box[0][2], 6))
        return Pose((0.0, 0.0, HIGH + max(0.0, -lowest))) @ robot.pose
    if box is None:
        return robot.pose
    x, y, z = robot.pose.position
    return Pose((x, y, z - float(np.round(box[0][2], 6))), robot.pose.orientation)
