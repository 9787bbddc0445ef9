"""The base class of controllers."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.dialects.ros_control.chaining import Reference
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.parameter_services import ParameterServices
from cartwheel.dialects.ros_control.parameters import read_parameters_of
from cartwheel.dialects.ros_control.robot import ControlledRobot
from cartwheel.dialects.ros_control.scope import ControllerScope
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import CartwheelError, Code, GraphError, Origin, Severity, Value
from cartwheel.graph import JointInput, resolve_name
from cartwheel.messages import message_class
from cartwheel.messages.typed import Kind, name_of

NEVER_NS = 1 << 62
"""A time that is never reached."""


class Controller(Component):
    """Base class of all controllers, created when a controller is loaded.

    A subclass lists its `types` and declares its `parameters`. Its `configure` calls `claim` for
    each joint that it commands. While the controller runs, `update` is called at the manager's
    rate.
    """

    types: ClassVar[tuple[str, ...]]
    """Names of the type in ROS 1 and ROS 2."""
    parameters: ClassVar[type]
    """Dataclass with fields from `parameter`."""
    faces_backward: bool = False
    """Whether a robot with steered wheels faces along negative x, as `configure` finds: its wheels
    are on the other sides, and those that are driven roll there."""

    def __init__(
        self, name: str, type_name: str, settings: Settings, robot: ControlledRobot
    ) -> None:
        self.name = name
        self.type = type_name
        self.settings = settings
        self.robot = robot
        outer, space = robot.plugin.scope, robot.spaces.get(name, "")
        super().__init__(
            ControllerScope(
                part=outer.part,
                shared=outer.shared,
                node=f"{outer.part.name}/{name}",
                title=f'controller "{name}"',
                origin=outer.origin,
                frame_prefix=outer.frame_prefix,
                input_name=name,
                name=name,
                outer=outer,
                base=resolve_name(space, robot.namespace) if space else robot.namespace,
                own=robot.remappings.get(name, {}),
            )
        )
        self.running = False
        """Whether the controller is running, or starts at the next update."""
        self.started = False
        """Whether `start` has been called. Messages that arrive earlier are kept until then."""
        self._receivers: list[Callable[[Any], None]] = []
        """The callbacks of all subscriptions."""
        self._early: list[tuple[int, Any]] = []
        """Messages that arrived early, with the indices of their receivers."""
        self.claims: dict[str, JointHardware] = {}
        """The claimed joints, by name."""
        self.interval_ns = 0
        """Time between two updates, ns; 0 for that of the controller manager."""
        self._updated_ns: int | None = None
        self.interfaces: dict[str, str] = {}
        """The claimed interface of each joint."""
        self.references: list[Reference] = []
        """Reference interfaces that other controllers can command."""
        self._input: JointInput | None = None
        if robot.ros2:
            self.graph.nodes[self.node] = resolve_name(name, robot.namespace)
        try:
            self.configure(read_parameters_of(self.parameters, settings, ros2=robot.ros2))
        except CartwheelError:
            Controller.close(self)
            raise
        if robot.ros2:
            values = {**settings.flat(), "type": type_name, "use_sim_time": True}
            ParameterServices(self._offer_parameters, self.graph.nodes[self.node], values)

    def configure(self, given: Any) -> None:
        """Claims joints, and creates publishers and subscriptions.

        Args:
            given: The parameters, an instance of `parameters`.

        Raises:
            PluginError: A parameter is not allowed.
            UnknownNameError: A joint does not exist.
        """
        raise NotImplementedError

    def begin(self, time_ns: int) -> None:
        """Starts the controller, and delivers the messages that arrived before."""
        self._updated_ns = None
        self.start(time_ns)
        self.started = True
        early, self._early = self._early, []
        for receiver, message in early:
            self._receivers[receiver](message)
        if self._input is not None and not self.chained:
            self.graph.joint_inputs.add(self._input)

    def end(self, time_ns: int) -> None:
        """Stops the controller."""
        self.started = False
        self._early.clear()
        self._leave_joints()
        self.stop(time_ns)

    def start(self, time_ns: int) -> None:
        """Called when the controller starts. The claimed joints are already active."""

    def interrupt(self) -> None:
        """Called when the simulation is reset, before the controller starts again."""

    next_ns: int = 0
    """Simulation time until which `update` need not be called, because it would change nothing."""

    def update(self, time_ns: int, seconds: float) -> None:
        """Commands the claimed joints.

        Args:
            time_ns: Simulation time.
            seconds: Time since the last update, s.
        """

    def since_update(self, time_ns: int) -> float:
        """Time since the last update of a controller with an interval of its own, s.

        It is 0 if no update is due; otherwise, the caller updates the controller.
        """
        last = self._updated_ns
        since = self.interval_ns if last is None else time_ns - last
        if since < self.interval_ns:
            return 0.0
        self._updated_ns = time_ns
        return since / 1e9

    def idle(self, time_ns: int) -> None:
        """Called instead of `update` while not running, to publish the status of the action."""

    holds: bool = True
    """Whether it holds its joints before the first command, or their motors at least do not give
    way."""

    senses: bool = False
    """Whether `sense` has messages to publish."""

    def sense(self, time_ns: int) -> None:
        """Publishes quantities that are only known after a step: accelerations and forces."""

    def stop(self, time_ns: int) -> None:
        """Called when the controller stops."""

    def close(self) -> None:
        """Removes all topics and services when the controller is unloaded."""
        self.graph.nodes.pop(self.node, None)
        self._leave_joints()
        super().close()
        for each in self.references:
            self.robot.hardware.references.pop(each.full_name, None)
        self.references.clear()

    def claim(self, joint: str, interface: str) -> JointHardware:
        """Claims a joint, which the controller commands while it runs.

        Raises:
            UnknownNameError: The joint does not exist.
            PluginError: The joint does not have this command interface.
        """
        hardware = self.robot.hardware.joint(joint, interface)
        self.claims[joint] = hardware
        self.interfaces[joint] = interface
        return hardware

    def required(self, joint: str) -> frozenset[str]:
        """The command interfaces of a claimed joint that no other controller may command."""
        return frozenset((self.interfaces[joint],))

    def export(self, joint: JointHardware, interface: str) -> Reference:
        """Creates a reference interface, by which other controllers can command the joint."""
        reference = Reference(self.name, joint, interface)
        self.references.append(reference)
        self.robot.hardware.references[reference.full_name] = reference
        return reference

    @property
    def chained(self) -> bool:
        """Whether another controller commands a reference of this one."""
        return any(each.taken for each in self.references)

    def state_interfaces(self) -> list[str]:
        """Returns the state interfaces of the claimed joints, such as ``joint/position``."""
        return [
            f"{joint.name}/{kind}"
            for joint in self.claims.values()
            for kind in joint.interfaces.states
        ]

    def subscribe(
        self,
        topic: str,
        type_name: Kind,
        callback: Callable[[Any], None],
        *,
        unset: bool = True,
        always: bool = False,
    ) -> None:
        """Creates a subscription that closes with the controller.

        Messages are received while the controller runs; with `always`, also while it does not.
        Messages with a number that is too large are ignored with a warning. Each controller decides
        what NaN and infinity mean.
        """
        checked = self.checked(callback, unset=unset)
        number = len(self._receivers)
        self._receivers.append(checked)

        def receive(message: Any) -> None:
            if self.running and not self.started:
                self._early.append((number, message))
            elif self.running or always:
                checked(message)

        topic, kind = self.resolve(topic), name_of(type_name)
        self.keep(self.graph.subscribe(topic, receive, type_name=kind, node=self.node))
        self.part.subscribed.add(topic)

    def accept_positions(self, put: Callable[[Mapping[str, float], float], None]) -> None:
        """Accepts manual joint positions while the controller runs; see `JointInput`."""
        self._input = self.joint_input([claim.joint for claim in self.claims.values()], put)

    def publish_command(self, topic: str, type_name: str, **fields: object) -> None:
        """Publishes a message on one of the controller's own command topics."""
        self.graph.publish(self.resolve(topic), type_name, message_class(type_name)(**fields))

    def warn_ignored(self, name: str) -> None:
        """Warns that a parameter has no effect."""
        self.warn(
            devices.CONTROLLER_PARAMETER_UNKNOWN,
            f'the parameter "{name}" has no effect',
            values={"parameters": (name,)},
        )

    def _leave_joints(self) -> None:
        if self._input is not None:
            self.graph.joint_inputs.remove(self._input)

    def _offer_parameters(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> None:
        """Offers a parameter service, unless another robot's controller already offers it."""
        with contextlib.suppress(GraphError):
            self._serve(name, type_name, handler)

    def serve(
        self,
        name: str,
        type_name: str,
        handler: Callable[[Any], Any],
        *,
        threaded: bool = False,
    ) -> bool:
        """Offers a service that is withdrawn with the controller.

        Raises:
            GraphError: Another controller already offers the service.
        """
        self._serve(self.resolve(name), type_name, handler, threaded=threaded)
        return True

    def _serve(
        self,
        name: str,
        type_name: str,
        handler: Callable[[Any], Any],
        *,
        threaded: bool = False,
    ) -> None:
        graph = self.graph
        service = graph.serve(name, type_name, handler, node=self.node, threaded=threaded)
        self.part.services.add(service.name)
        self._items.append(service)
        self._open.callback(graph.withdraw, service)

    def warn(
        self,
        code: Code,
        message: str,
        *,
        at: Origin | None = None,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
        severity: Severity = "warning",
    ) -> None:
        """Reports a diagnostic about this controller; see `Component.warn`."""
        values = {"controller": self.name, **(values or {})}
        message = f"{self.title}: {message}"
        super().warn(code, message, at=at, hint=hint, values=values, severity=severity)
