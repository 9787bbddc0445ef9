"""Drives a robot, and saves and restores its world. Other processes import this file."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.golden.adapter import controller_files
from tests.golden.commanding import PERIOD, Commands
from tests.golden.trial import resting_height

import cartwheel as cw
from cartwheel.description import load_robot, load_world
from cartwheel.description.model import (
    CameraIntrinsics,
    Link,
    RobotDescription,
    Sensor,
    WorldDescription,
)
from cartwheel.messages import encode_cdr

ROBOTS = Path(__file__).parents[1] / "golden" / "robots"
DUE = {2: 0.5, 4: 1.5, 6: 2.5}
"""Steps at which joints, topics and actions get their commands, with the times that `Commands` has
for them."""


IMAGE = (64, 48)
"""Most pixels of an image in each direction: images of the usual size take most of the time."""


@dataclass(frozen=True)
class Traveller:
    """What the worlds of several journeys contain."""

    world: WorldDescription
    robot: RobotDescription | None = None
    """What is spawned, if the world does not contain it."""
    height: float = 0.0
    """Where it is spawned, m."""


def traveller(file: Path, height: float | None = None) -> Traveller:
    """Reads a robot, or a world with a robot.

    Args:
        file: The file.
        height: Height at which the robot is spawned, m; None if it is to rest on the ground.
    """
    if file.suffix == ".world":
        world = load_world(file)
        models = tuple(_with_small_images(each) for each in world.models)
        return Traveller(dataclasses.replace(world, models=models))
    robot = _with_small_images(load_robot(file))
    return Traveller(_empty(), robot, resting_height(robot) if height is None else height)


@functools.cache
def _empty() -> WorldDescription:
    return load_world("empty")


def _with_small_images(robot: RobotDescription) -> RobotDescription:
    def small(lens: CameraIntrinsics) -> CameraIntrinsics:
        width, height = min(lens.width, IMAGE[0]), min(lens.height, IMAGE[1])
        return dataclasses.replace(lens, width=width, height=height)

    def sensors(link: Link) -> tuple[Sensor, ...]:
        return tuple(
            dataclasses.replace(each, cameras=tuple(map(small, each.cameras)))
            for each in link.sensors
        )

    links = (dataclasses.replace(each, sensors=sensors(each)) for each in robot.links)
    return dataclasses.replace(robot, links=tuple(links))


class Journey:
    """A robot with commands under way, whose messages and states are hashed.

    Args:
        who: The robot, or its world.
        seed: Seed of the noise.
    """

    def __init__(self, who: Traveller, seed: int = 0) -> None:
        self.world = cw.World(who.world, seed=seed, lenient=True)
        if who.robot is not None:
            files = controller_files(who.robot)
            self.world.spawn(who.robot, z=who.height, controllers=files)
        self._sum = hashlib.sha256()
        self._counts: dict[str, int] = {}
        for topic in self.world.graph.topics():
            if topic.publishers:
                self.world.graph.subscribe(
                    topic.name, self._hasher(topic.name), type_name=topic.type, node="test"
                )
        # Latched messages are those of before.
        self.world.session.simulation.drain()
        self._commands = Commands(self.world)

    def _hasher(self, topic: str) -> Callable[[Any], None]:
        def add(message: Any) -> None:
            self._sum.update(topic.encode() + bytes(encode_cdr(message)))
            self._counts[topic] = self._counts.get(topic, 0) + 1

        return add

    def set_out(self, seconds: float = 1.0) -> None:
        """Starts motions, goals and drives, and runs."""
        for step in range(round(seconds / PERIOD)):
            self._commands.give(DUE.get(step, 0.5 + step * PERIOD))
            self.world.run(PERIOD)

    def go_on(self, seconds: float = 0.5) -> tuple[str, dict[str, int]]:
        """Runs with further commands.

        Returns:
            A digest of all states and messages, and the number of messages of each topic.
        """
        self._sum, self._counts = hashlib.sha256(), {}
        self._commands = Commands(self.world)
        for step in range(round(seconds / PERIOD)):
            # A drive at each step, and everything else while the commands of before are under way.
            self._commands.give(5.0 if step == 4 else 0.4 + step * PERIOD / 4)
            self.world.run(PERIOD)
            simulation = self.world.session.simulation
            data = simulation.data
            for each in (data.qpos, data.qvel, data.qacc, data.ctrl, data.qfrc_applied):
                self._sum.update(each.tobytes())
            self._sum.update(str(simulation.time_ns).encode())
        return self._sum.hexdigest(), self._counts


def continued(
    file: Path, state: cw.State, height: float, seconds: float
) -> tuple[str, dict[str, int]]:
    """What `Journey.go_on` returns in a new world that restores a state."""
    journey = Journey(traveller(file, height))
    with journey.world as world:
        world.restore(state)
        return journey.go_on(seconds)
