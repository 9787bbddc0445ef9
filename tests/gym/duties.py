"""A task of the tests. Other processes import it."""

from __future__ import annotations

from typing import Any

import numpy as np

import cartwheel as cw
from cartwheel.gym import Task, vary


def pose(world: cw.World) -> list[float]:
    """x, y and yaw of the cart."""
    place = world.model("rosbots").pose
    return [place.x, place.y, place.yaw]


def progress(before: Any, actions: Any, after: Any) -> Any:
    """Movement along x, m."""
    return after["pose"][:, 0] - before["pose"][:, 0]


def arrived(after: Any) -> Any:
    """Whether the cart is at x = 0.2 m."""
    return after["pose"][:, 0] > 0.2


def task(**options: Any) -> Task:
    """Drive forward."""
    given: dict[str, Any] = {
        "built": cw.build("empty", ["rosbots.xacro"]),
        "act": {"/part2_cmr/cmd_vel": {"linear.x": (-1.0, 1.0), "angular.z": (-1.0, 1.0)}},
        "obs": {"/imu/data": ["angular_velocity.z"], "pose": pose},
        "reward": progress,
        "ended": arrived,
        "seconds": 1.0,
        "vary": vary(
            "rosbots", mass=(0.8, 1.2), friction=(0.5, 1.0), damping=(0.5, 2.0), light=(0.5, 1.0),
            pose={"yaw": (-0.2, 0.2)},
        ),
    }  # fmt: skip
    return Task(**{**given, **options})


FORWARD = np.array([1.0, 0.0], np.float32)


def relative(world: cw.World, random: np.random.Generator) -> None:
    """Changes of all kinds that depend on what they change, or add something."""
    cart = world.model("rosbots")
    cart.link("base_link").mass *= float(random.uniform(0.5, 2.0))
    cart.link("wheel_left_link").friction = cart.link("wheel_left_link").friction[0] * 0.9
    cart.joints["wheel_left_joint"].damping += 0.01
    world.gravity = (0.0, 0.0, world.gravity[2] * 1.01)
    world.light("sun").intensity *= 0.9
    world.fault("/imu/data", noise={"angular_velocity.z": 0.1})
    world.subscribe("/odom", print_nothing)
    world.every(20.0, lambda: cart.push(force=(2.0, 0.0, 0.0), seconds=0.01))
    world.spawn("object.urdf", name="box", x=3.0 + float(random.uniform(0.0, 1.0)))


def print_nothing(message: Any) -> None:
    """Receives messages."""
