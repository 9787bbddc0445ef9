"""What the worlds of the tests receive and return. Other processes import it."""

from __future__ import annotations

import multiprocessing
import os

import numpy as np

import cartwheel as cw

ACT = {"/part2_cmr/cmd_vel": ["linear.x", "angular.z"]}


def pose(world: cw.World) -> list[float]:
    """x, y and yaw of the cart."""
    place = world.model("rosbots").pose
    return [place.x, place.y, place.yaw]


def words(world: cw.World) -> list[str]:
    """No numbers."""
    return ["no", "numbers"]


def as_many_as_time(world: cw.World) -> list[float]:
    """A different number in each world."""
    return [0.0] * (1 + int(abs(world.model("rosbots").pose.x) > 0.05))


def dying(world: cw.World) -> list[float]:
    """Ends its process once the cart has moved, unless it is that of the tests."""
    if multiprocessing.parent_process() and world.model("rosbots").pose.x > 0.01:
        os._exit(3)
    return [0.0]


def heavier(world: cw.World, random: np.random.Generator) -> None:
    """Changes the mass."""
    world.model("rosbots").link("base_link").mass = random.uniform(5.0, 50.0)


def placed(world: cw.World, random: np.random.Generator) -> None:
    """Changes the place."""
    world.model("rosbots").pose = cw.Pose((random.uniform(0.0, 1.0), 0.0, 0.0))


def drive(world: cw.World, action: np.ndarray) -> None:
    """Drives at a speed and turn rate."""
    speed, turn = action.tolist()
    world.publish("/part2_cmr/cmd_vel", linear_x=speed, angular_z=turn)


OBS = {
    "/imu/data": ["angular_velocity.z", "linear_acceleration.x"],
    "speed": ("/odom", "twist.twist.linear.x"),
    "covariance": ("/odom", "pose.covariance"),
    "pose": pose,
}
