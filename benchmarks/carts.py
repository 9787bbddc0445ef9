"""Driving carts, simulated with Cartwheel or with MuJoCo alone."""

from __future__ import annotations

import functools
from typing import Any

import mujoco
import numpy as np

import cartwheel as cw

READ = ("/odom", "/tf", "/joint_states", "/imu/data")
IMAGE = "/cart_0/camera1/image_raw"


class Listener:
    """Subscribes to topics and keeps the last message of each, as a typical subscriber does."""

    def __init__(self, world: cw.World, topics: tuple[str, ...]) -> None:
        self.count = 0
        self.last: dict[str, Any] = {}
        for topic in topics:
            world.subscribe(topic, functools.partial(self._take, topic))

    def _take(self, topic: str, message: Any) -> None:
        self.count += 1
        self.last[topic] = message


def driving(count: int = 1, world: str = "empty") -> cw.World:
    """Returns a world with a row of carts that drive in circles at constant speed."""
    carts = cw.World(world)
    for index in range(count):
        carts.spawn("rosbots.xacro", name=f"cart_{index}", y=8.0 * index)
    carts.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.3)
    carts.run(3)
    return carts


class Bare:
    """MuJoCo alone, with the same compiled model, state and controls."""

    def __init__(self, world: cw.World) -> None:
        simulation = world.session.simulation
        self.model = simulation.model
        self.data = mujoco.MjData(self.model)
        kind = mujoco.mjtState.mjSTATE_INTEGRATION.value
        state = np.empty(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, simulation.data, state, kind)
        mujoco.mj_setState(self.model, self.data, state, kind)

    def step(self, seconds: float) -> None:
        """Steps with one call per step, as in a typical program."""
        model, data = self.model, self.data
        for _ in range(round(seconds / model.opt.timestep)):
            mujoco.mj_step(model, data)

    def steps(self, seconds: float) -> None:
        """Makes all steps in one call."""
        mujoco.mj_step(self.model, self.data, round(seconds / self.model.opt.timestep))
