"""Driving carts, with and without Cartwheel around the physics."""

from __future__ import annotations

import functools
from typing import Any

import mujoco
import numpy as np

import cartwheel as cw

READ = ("/odom", "/tf", "/joint_states", "/imu/data")
IMAGE = "/cart_0/camera1/image_raw"


class Listener:
    """Gets every message of some topics, and holds the last of each as a reader would."""

    def __init__(self, world: cw.World, topics: tuple[str, ...]) -> None:
        self.count = 0
        self.last: dict[str, Any] = {}
        for topic in topics:
            world.subscribe(topic, functools.partial(self._take, topic))

    def _take(self, topic: str, message: Any) -> None:
        self.count += 1
        self.last[topic] = message


def driving(count: int = 1, world: str = "empty") -> cw.World:
    """Carts in a row that drive in circles, past the ramp of their wheels."""
    made = cw.World(world)
    for index in range(count):
        made.spawn("rosbots.xacro", name=f"cart_{index}", y=8.0 * index)
    made.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.3)
    made.run(3)
    return made


class Bare:
    """The same compiled model in the same state with the same controls, and MuJoCo alone."""

    def __init__(self, world: cw.World) -> None:
        simulation = world.session.simulation
        self.model = simulation.model
        self.data = mujoco.MjData(self.model)
        kind = mujoco.mjtState.mjSTATE_INTEGRATION.value
        state = np.empty(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, simulation.data, state, kind)
        mujoco.mj_setState(self.model, self.data, state, kind)

    def step(self, seconds: float) -> None:
        """One call for each step, as anybody would write it."""
        model, data = self.model, self.data
        for _ in range(round(seconds / model.opt.timestep)):
            mujoco.mj_step(model, data)

    def steps(self, seconds: float) -> None:
        """One call for all steps."""
        mujoco.mj_step(self.model, self.data, round(seconds / self.model.opt.timestep))
