"""Everything of one simulation put together: world, graph, plugins, clock."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, Diagnostic, PluginError
from cartwheel.geometry import Pose
from cartwheel.graph import Graph
from cartwheel.graph.graph import Subscription
from cartwheel.messages import message_class, stamp
from cartwheel.plugins.control.files import ControllerFiles
from cartwheel.plugins.gz_bridge import GzBridge, read_bridge
from cartwheel.plugins.registry import attach
from cartwheel.plugins.world_plugins import attach_world
from cartwheel.simulation import Simulation
from cartwheel.simulation.clock import Task
from cartwheel.simulation.pacing import Pacer

CLOCK_RATE = 100.0
"""Hz of simulation time."""


class Session:
    """A simulation with its graph.

    Args:
        world: What stands in it from the start.
        seed: Of all noise.
        strict: Treat every warning about a file as an error.
        lenient: Leave out, and report, plugins that name what their model does not have, as
            Gazebo does; else such a model is refused.
        bridge: Files of ros_gz_bridge, whose names topics have.
        allow_path: Folders whose files clients of its services may name.

    Raises:
        CartwheelError: One of these cannot be used.
    """

    def __init__(
        self,
        world: WorldDescription,
        *,
        seed: int = 0,
        strict: bool = False,
        lenient: bool = False,
        bridge: Sequence[Path] = (),
        allow_path: Sequence[Path] = (),
    ) -> None:
        self.allow_path = tuple(allow_path)
        self.graph = Graph()
        for path in bridge:
            GzBridge.of(self.graph).add(read_bridge(path))
        self.strict = strict
        self.simulation = Simulation(
            world,
            attach=lambda part: attach(part, self.graph, lenient=lenient),
            attach_world=lambda part: attach_world(part, self.graph),
            seed=seed,
        )
        self.graph.post = self.simulation.post
        self.graph.on_error = self._subscriber_failed
        self.simulation.strict = strict
        self._clock = self.graph.advertise(
            "/clock", "rosgraph_msgs/msg/Clock", node="cartwheel", rate=CLOCK_RATE
        )
        self._clock_task = self._schedule_clock(CLOCK_RATE)
        self._check(0)

    def spawn(
        self,
        description: RobotDescription,
        *,
        name: str | None = None,
        pose: Pose | None = None,
        namespace: str = "/",
        frame_prefix: str = "",
        controllers: Sequence[Path] = (),
    ) -> str:
        """`Simulation.spawn`, strict where the session is; on the owner's thread.

        Args:
            description: Of the model.
            name: In this world; the description's own when None.
            pose: Of its root link; the description's own when None.
            namespace: Of its topics and services, where a plugin names none; ROS 1's spawn_model
                says "/" as well. "" leaves it to each plugin.
            frame_prefix: Of its frames.
            controllers: YAML files whose controllers its manager starts by itself.

        Raises:
            PluginError: It has no manager of controllers to start them.
        """
        before = len(self.simulation.diagnostics)
        files = ControllerFiles.of(self.graph)
        files.paths = tuple(controllers)
        try:
            spawned = self.simulation.spawn(
                description, name=name, pose=pose, namespace=namespace, frame_prefix=frame_prefix
            )
        finally:
            left = files.take()
        if left:
            self.simulation.delete(spawned)
            raise PluginError(
                f'model "{spawned}" has no plugin that starts controllers',
                code=CONTROLLER_NOT_STARTED,
                values={"model": spawned},
                origin=description.origin,
                hint="Add the plugin libgazebo_ros_control.so, libgazebo_ros2_control.so or "
                "gz_ros2_control-system in a <gazebo> tag.",
            )
        try:
            self._check(before)
        except CartwheelError:
            self.simulation.delete(spawned)
            raise
        return spawned

    def report_unbridged(self) -> None:
        """Tells what the files of ros_gz_bridge name and is not there; on the owner's thread."""
        before = len(self.simulation.diagnostics)
        names = {topic.name for topic in self.graph.topics()}
        for fault in GzBridge.of(self.graph).faults(names):
            self.simulation.engine.report(fault)
        self._check(before)

    def set_clock_rate(self, rate: float) -> None:
        """Tells the time `rate` times a second of it; on the owner's thread.

        Args:
            rate: Hz of simulation time; 0 or more than there are steps is every step.
        """
        self.simulation.unschedule(self._clock_task)
        self._clock_task = self._schedule_clock(rate)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """All that was reported so far."""
        return tuple(self.simulation.diagnostics)

    @property
    def notes(self) -> dict[str, str]:
        """What made this simulation, for those who keep its messages."""
        import cartwheel

        simulation = self.simulation
        return {
            "version": cartwheel.__version__,
            "world": simulation.world.name,
            "seed": str(simulation.engine.seed),
            "step_ns": str(simulation.step_ns),
            "models": ", ".join(simulation.models),
        }

    def pacer(self, *, until_ns: int | None = None) -> Pacer:
        """Runs the session against the wall clock."""
        return Pacer(self.simulation, until_ns=until_ns, strict=self.strict)

    def _subscriber_failed(self, subscription: Subscription, error: Exception) -> None:
        what = f'the subscriber "{subscription.node}" of {subscription.topic}'
        self.simulation.fail(what, error)

    def close(self) -> None:
        """Ends the run; see `Simulation.close`."""
        self.simulation.close()
        ControllerFiles.of(self.graph).loaded.clear()
        self.graph.close()
        self._clock_task.forget()

    def _check(self, start: int) -> None:
        if not self.strict:
            return
        for diagnostic in self.simulation.diagnostics[start:]:
            if diagnostic.severity != "info":
                hint = f"{diagnostic.hint} " if diagnostic.hint else ""
                raise CartwheelError(
                    diagnostic.message,
                    code=diagnostic.code,
                    origin=diagnostic.origin,
                    hint=f"{hint}--strict makes every warning an error.",
                    values=diagnostic.values,
                    mark=diagnostic.mark,
                )

    def _schedule_clock(self, rate: float) -> Task:
        return self.simulation.schedule(
            rate, after=self._publish_clock, active=lambda: self._clock.wanted
        )

    def _publish_clock(self) -> None:
        message: Any = message_class("rosgraph_msgs/msg/Clock")(
            clock=stamp(self.simulation.time_ns)
        )
        self._clock.publish(message)
