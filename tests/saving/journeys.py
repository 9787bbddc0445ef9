"""Drives a robot, and saves and restores its world. Other processes import this file."""

from __future__ import annotations

import hashlib
from pathlib import Path

from tests.golden.commanding import Commands
from tests.golden.trial import resting_height

import cartwheel as cw
from cartwheel.messages import encode_cdr

PERIOD = 0.05
LARGE = 500
"""Degrees of freedom from which shorter times are simulated."""
ROBOTS = Path(__file__).parents[1] / "golden" / "robots"
IMAGES = ("/Image", "/CompressedImage", "/DisparityImage")


class Journey:
    """A robot with commands under way, whose messages and states are hashed.

    Args:
        file: A robot or a world.
        images: Whether the images of cameras are subscribed to.
        height: Height at which the robot is spawned, m; None if it is to rest on the ground.
    """

    def __init__(self, file: Path, *, images: bool = True, height: float | None = None) -> None:
        self.file, self._images = file, images
        if file.suffix in (".world", ".sdf"):
            self.world = cw.World(file, lenient=True)
        else:
            self.world = cw.World(lenient=True)
            description = cw.load_robot(file) if hasattr(cw, "load_robot") else _load(file)
            self.height = resting_height(description) if height is None else height
            from tests.golden.adapter import controller_files

            self.world.spawn(description, z=self.height, controllers=controller_files(description))
        self._sum = hashlib.sha256()
        self.counts: dict[str, int] = {}
        self._topics: set[str] = set()
        self.listen()
        self._commands = Commands(self.world)

    def listen(self) -> None:
        """Subscribes to the topics that are new."""
        for topic in self.world.graph.topics():
            if topic.name in self._topics or not topic.publishers:
                continue
            self._topics.add(topic.name)
            if not self._images and topic.type.endswith(IMAGES):
                continue
            self.world.graph.subscribe(
                topic.name, self._hasher(topic.name), type_name=topic.type, node="test"
            )

    def _hasher(self, topic):
        def add(message):
            self._sum.update(topic.encode())
            self._sum.update(bytes(encode_cdr(message)))
            self.counts[topic] = self.counts.get(topic, 0) + 1

        return add

    def set_out(self, seconds: float = 1.0) -> None:
        """Starts motions, goals and drives, and runs."""
        for step in range(round(seconds / PERIOD)):
            self._commands.give({2: 0.5, 4: 1.5, 6: 2.5}.get(step, 0.5 + step * PERIOD))
            self.world.run(PERIOD)

    def continue_(self, seconds: float = 0.5, start: float = 1.0) -> tuple[str, dict[str, int]]:
        """Runs with further commands; returns a digest of the states and messages, and the number
        of messages by topic.
        """
        self._sum, self.counts = hashlib.sha256(), {}
        commands = Commands(self.world)
        commands._done = {"joints", "topics", "actions", "topics back"}
        for step in range(round(seconds / PERIOD)):
            commands.give(start + step * PERIOD + (2.5 if step == 4 else 0.0))
            self.world.run(PERIOD)
            data = self.world.session.simulation.data
            for each in (data.qpos, data.qvel, data.qacc, data.ctrl, data.qfrc_applied):
                self._sum.update(each.tobytes())
            self._sum.update(str(self.world.session.simulation.time_ns).encode())
        return self._sum.hexdigest(), self.counts


def _load(file):
    from cartwheel.description import load_robot

    return load_robot(file)


def continued(file: Path, state, seconds: float, images: bool, height: float | None):
    """What `Journey.continue_` returns in a new world that restores a state."""
    journey = Journey(file, images=images, height=height)
    with journey.world as world:
        world.restore(state)
        return journey.continue_(seconds)
