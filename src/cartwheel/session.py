"""Everything of one simulation put together: world, graph, plugins, clock."""

from __future__ import annotations

from typing import Any

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.geometry import Pose
from cartwheel.graph import Graph
from cartwheel.messages import message_class, stamp
from cartwheel.plugins.registry import attach
from cartwheel.simulation import Simulation
from cartwheel.simulation.pacing import Pacer

CLOCK_RATE = 100.0
"""Hz of simulation time."""


class Session:
    """A simulation with its graph.

    Args:
        world: What stands in it from the start.
        seed: Of all noise.
        strict: Treat every warning about a file as an error.
    """

    def __init__(self, world: WorldDescription, *, seed: int = 0, strict: bool = False) -> None:
        self.graph = Graph()
        self.strict = strict
        self.simulation = Simulation(world, attach=lambda part: attach(part, self.graph), seed=seed)
        self.graph.post = self.simulation.post
        self._clock = self.graph.advertise(
            "/clock", "rosgraph_msgs/msg/Clock", node="cartwheel", rate=CLOCK_RATE
        )
        self.simulation.schedule(
            CLOCK_RATE, after=self._publish_clock, active=lambda: self._clock.wanted
        )
        self._check(0)

    def spawn(
        self, description: RobotDescription, *, name: str | None = None, pose: Pose | None = None
    ) -> str:
        """`Simulation.spawn`, strict where the session is; on the owner's thread."""
        before = len(self.simulation.diagnostics)
        spawned = self.simulation.spawn(description, name=name, pose=pose)
        try:
            self._check(before)
        except CartwheelError:
            self.simulation.delete(spawned)
            raise
        return spawned

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """All that was reported so far."""
        return tuple(self.simulation.diagnostics)

    def pacer(self, *, until_ns: int | None = None) -> Pacer:
        """Runs the session against the wall clock."""
        return Pacer(self.simulation, until_ns=until_ns)

    def close(self) -> None:
        """Frees what the simulation holds."""
        self.simulation.close()

    def _check(self, start: int) -> None:
        if not self.strict:
            return
        for diagnostic in self.simulation.diagnostics[start:]:
            if diagnostic.severity != "info":
                raise CartwheelError(
                    diagnostic.message,
                    origin=diagnostic.origin,
                    hint="--strict makes every warning an error.",
                )

    def _publish_clock(self) -> None:
        message: Any = message_class("rosgraph_msgs/msg/Clock")(
            clock=stamp(self.simulation.time_ns)
        )
        self._clock.publish(message)
