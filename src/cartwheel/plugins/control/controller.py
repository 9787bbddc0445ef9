"""What every controller is."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Protocol

from cartwheel.description.model import Sensor
from cartwheel.errors import CartwheelError, Code, GraphError, Origin, Value
from cartwheel.graph import Graph, JointInput, Publisher, Qos, Service, resolve_name
from cartwheel.messages import message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.control.chaining import Reference
from cartwheel.plugins.control.hardware import Hardware, JointHardware
from cartwheel.plugins.control.ros2_parameters import ParameterServices
from cartwheel.plugins.control.settings import Settings
from cartwheel.plugins.ft_sensor import JointLoad
from cartwheel.plugins.inertial_unit import InertialUnit
from cartwheel.plugins.inputs import obeyable, obeyable_positions
from cartwheel.simulation import Part
from cartwheel.simulation.clock import NANOSECONDS, Beat
from cartwheel.simulation.pushing import BodyDriveHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class SensedLink:
    """A sensor whose measurements controllers tell."""

    name: str
    type: str
    """imu or force_torque."""
    sensor: Sensor
    unit: InertialUnit | JointLoad
    """Measures, whichever controller asks."""


class Closable(Protocol):
    """Something on the graph."""

    def close(self) -> None:
        """Takes it off."""


class Rig:
    """What controllers get of a robot.

    Args:
        plugin: The manager's.
        hardware: The joints.
        namespace: Of the controllers.
        ros2: Whether names and defaults are those of ros2_control.
        sensors: That broadcasters may tell of.
        push: A servo of the whole robot, where it was spawned with one.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        hardware: Hardware,
        *,
        namespace: str,
        ros2: bool,
        sensors: Sequence[SensedLink] = (),
        push: BodyDriveHandle | None = None,
    ) -> None:
        self.plugin = plugin
        self.hardware = hardware
        self.namespace = namespace
        self.ros2 = ros2
        self.sensors = {each.name: each for each in sensors}
        self.push = push
        """Moves the whole robot, for wheels that our friction cannot make do so."""
        self.period_ns = 0
        """Of control."""
        self.remappings: dict[str, Mapping[str, str]] = {}
        """Of controllers' names of topics, by controller."""

    def report(
        self,
        code: Code,
        message: str,
        *,
        at: Origin | None = None,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
    ) -> None:
        """Reports a warning, at the plugin's place unless another is given; see `Plugin.warn`."""
        self.plugin.warn(code, message, at=at, hint=hint, values=values)


class Controller:
    """Base of all controllers; made when it is loaded.

    A subclass names its `types`, reads its settings in `configure`, and there says which
    joints it commands by `claim`. While it runs, `update` is called at the manager's rate.
    """

    types: ClassVar[tuple[str, ...]]
    """As ROS 1 and ROS 2 write them."""

    def __init__(self, name: str, type_name: str, settings: Settings, rig: Rig) -> None:
        self.name = name
        self.type = type_name
        self.settings = settings
        self.rig = rig
        self.running = False
        """Whether it was told to run."""
        self.started = False
        """Whether `start` was called since; what is heard before waits for it."""
        self._early: list[Callable[[], None]] = []
        self.claims: dict[str, JointHardware] = {}
        """The joints it commands."""
        self.interfaces: dict[str, str] = {}
        """By which interface."""
        self.references: list[Reference] = []
        """What other controllers may command of it."""
        self._open: list[Closable | Service] = []
        self._input: JointInput | None = None
        if rig.ros2:
            self.graph.nodes[self.node] = resolve_name(name, rig.namespace)
        try:
            self.configure(settings)
        except CartwheelError:
            Controller.close(self)
            raise
        if rig.ros2:
            values = {**settings.flat(), "type": type_name, "use_sim_time": True}
            ParameterServices(self._offer_parameters, self.graph.nodes[self.node], values)

    def configure(self, settings: Settings) -> None:
        """Reads parameters, claims joints, advertises and subscribes.

        Raises:
            PluginError: A parameter makes no sense.
            UnknownNameError: A joint does not exist.
        """
        raise NotImplementedError

    def begin(self, time_ns: int) -> None:
        """Starts it, and lets it hear what came too early."""
        self.start(time_ns)
        self.started = True
        early, self._early = self._early, []
        for call in early:
            call()
        if self._input is not None and not self.chained:
            self.graph.joint_inputs.add(self._input)

    def end(self, time_ns: int) -> None:
        """Stops it."""
        self.started = False
        self._early.clear()
        self._leave_joints()
        self.stop(time_ns)

    def start(self, time_ns: int) -> None:
        """It runs from now on; its joints are at their commands."""

    def update(self, time_ns: int, seconds: float) -> None:
        """Commands its joints.

        Args:
            time_ns: Simulation time.
            seconds: Since the last update, s.
        """

    def idle(self, time_ns: int) -> None:
        """In place of `update` while it does not run: tells that its action is there."""

    senses: bool = False
    """Whether `sense` has anything to do."""

    def sense(self, time_ns: int) -> None:
        """Tells what only a settled state shows: accelerations and forces."""

    def stop(self, time_ns: int) -> None:
        """It runs no longer."""

    def close(self) -> None:
        """It is unloaded: takes everything off the graph."""
        self.graph.nodes.pop(self.node, None)
        self._leave_joints()
        for item in self._open:
            if isinstance(item, Service):
                self.rig.plugin.graph.withdraw(item)
            else:
                item.close()
        self._open.clear()
        for each in self.references:
            self.rig.hardware.references.pop(each.full_name, None)
        self.references.clear()

    def claim(self, joint: str, interface: str) -> JointHardware:
        """A joint that it commands while it runs.

        Raises:
            UnknownNameError: There is none of that name.
            PluginError: It does not take such commands.
        """
        hardware = self.rig.hardware.joint(joint, interface)
        self.claims[joint] = hardware
        self.interfaces[joint] = interface
        return hardware

    def export(self, joint: JointHardware, interface: str) -> Reference:
        """Lets other controllers command it: a reference in place of the joint itself."""
        made = Reference(self.name, joint, interface)
        self.references.append(made)
        self.rig.hardware.references[made.full_name] = made
        return made

    @property
    def chained(self) -> bool:
        """Whether another controller commands it."""
        return any(each.taken for each in self.references)

    def state_interfaces(self) -> list[str]:
        """What it measures, for listings: ``joint/position``; of the joints that it commands."""
        return [
            f"{joint.name}/{kind}"
            for joint in self.claims.values()
            for kind in joint.interfaces.states
        ]

    def resolve(self, name: str) -> str:
        """A name of a topic: below the controller's own unless it begins with ``/``; remapped."""
        full = self._full(f"~/{name}")
        for source, target in self.rig.remappings.get(self.name, {}).items():
            if self._full(source) == full:
                full = self._full(target)
                break
        return self.rig.plugin.resolve(full)

    def _full(self, name: str) -> str:
        """A name as a node resolves it: ``~/…`` is below its own."""
        space = self.rig.namespace.strip("/")
        if name.startswith("~/"):
            name, space = name.removeprefix("~/"), f"{space}/{self.name}"
        return resolve_name(name, space)

    def advertise(
        self, topic: str, type_name: str, *, rate: float | None = None, qos: Qos = "default"
    ) -> Publisher:
        """A publisher that closes with the controller; see `resolve`."""
        publisher = self.rig.plugin.graph.advertise(
            self.resolve(topic), type_name, node=self.node, rate=rate, qos=qos
        )
        self._open.append(publisher)
        return publisher

    def subscribe(
        self,
        topic: str,
        type_name: str,
        callback: Callable[[Any], None],
        *,
        always: bool = False,
    ) -> None:
        """A subscription that closes with the controller; heard while it runs, or `always`.

        Messages with a number that is too large are ignored, with a warning. NaN and infinities
        mean different things to different controllers, which look at them.
        """
        callback = obeyable(callback, self.part, self.warn, unset=True)

        def heard(message: Any) -> None:
            if self.running and not self.started:
                self._early.append(lambda: callback(message))
            elif self.running or always:
                callback(message)

        self._open.append(
            self.rig.plugin.graph.subscribe(
                self.resolve(topic), heard, type_name=type_name, node=self.node
            )
        )

    def take_positions(self, put: Callable[[Mapping[str, float], float], None]) -> None:
        """Takes positions for its joints by hand too while it runs; see `JointInput`."""
        self._input = JointInput(
            model=self.part.name,
            owner=self.name,
            joints=tuple(claim.joint for claim in self.claims.values()),
            put=obeyable_positions(put, self.part),
        )

    def hear(self, topic: str, type_name: str, **fields: object) -> None:
        """Says to itself on one of its topics what another node could have said."""
        self.graph.publish(self.resolve(topic), type_name, message_class(type_name)(**fields))

    def _leave_joints(self) -> None:
        if self._input is not None:
            self.graph.joint_inputs.remove(self._input)

    def keep(self, closable: Closable) -> None:
        """Closes it with the controller."""
        self._open.append(closable)

    def _offer_parameters(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> None:
        """A service of its parameters; left to another robot's controller of the same name."""
        with contextlib.suppress(GraphError):
            self._open.append(self.graph.serve(name, type_name, handler, node=self.node))

    def serve(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> None:
        """A service that closes with the controller."""
        self._open.append(
            self.rig.plugin.graph.serve(self.resolve(name), type_name, handler, node=self.node)
        )

    def frame(self, name: str) -> str:
        """A frame's name with the robot's prefix."""
        return self.rig.plugin.frame(name)

    @property
    def part(self) -> Part:
        """The robot's part of the simulation."""
        return self.rig.plugin.part

    @property
    def graph(self) -> Graph:
        """Where it publishes."""
        return self.rig.plugin.graph

    @property
    def node(self) -> str:
        """Who publishes, for listings."""
        return f"{self.rig.plugin.part.name}/{self.name}"

    def warn(
        self,
        code: Code,
        message: str,
        *,
        at: Origin | None = None,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
    ) -> None:
        """Reports a warning about this controller; see `Plugin.warn`."""
        values = {"controller": self.name, **(values or {})}
        self.rig.report(
            code, f'controller "{self.name}": {message}', at=at, hint=hint, values=values
        )


class Rhythm:
    """Whether something is due, at fixed multiples of its period since time zero.

    Args:
        rate: Hz; 0 is always.
    """

    def __init__(self, rate: float) -> None:
        period = (
            Fraction(NANOSECONDS) / Fraction(rate).limit_denominator(1_000_000) if rate > 0 else 1
        )
        self._beat = Beat(max(Fraction(period), Fraction(1)))
        self._due = 0

    def start(self, time_ns: int) -> None:
        """Is due at the first multiple from now on."""
        self._due = self._beat.due(time_ns)

    def due(self, time_ns: int) -> bool:
        """Whether it is due since the last time it was asked; the next is then."""
        if self._due > time_ns:
            return False
        self._due = self._beat.due(time_ns + 1)
        return True
