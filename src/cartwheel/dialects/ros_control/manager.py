"""The controller manager, which loads, starts, updates and unloads controllers."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from cartwheel.codes import devices, running
from cartwheel.dialects.ros_control.catalogue import find_type
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.files import ControllerEntry
from cartwheel.dialects.ros_control.robot import ControlledRobot
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.ros_control.switching import (
    SharedJoints,
    plan_switch,
    update_order,
    with_leaders,
    wrong_state,
)
from cartwheel.errors import Origin
from cartwheel.graph import Publisher

_ROUNDING = 1e-6
"""Fraction of an update by which the number of updates in an interval may err."""


@dataclass(frozen=True, slots=True)
class LoadedController:
    """A controller from which it can be loaded again."""

    name: str
    type: str
    settings: Settings
    remappings: Mapping[str, str] | None

    def equals(self, other: LoadedController | None) -> bool:
        """Whether both are the same controller with the same parameters."""
        return (
            other is not None
            and self.type == other.type
            and self.settings.flat() == other.settings.flat()
        )


class ControllerManager:
    """The controllers of one robot. Used only on the thread that owns the simulation.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: ControlledRobot) -> None:
        self.robot = robot
        self._hardware, self._clock = robot.hardware, robot.plugin.part.clock
        self._controllers: dict[str, Controller] = {}
        self._order: list[Controller] = []
        """Controllers in the order of updates: those that command other controllers first."""
        self._begun: set[str] = set()
        """Names of controllers that have been started before."""
        self._starting: list[Controller] = []
        self._stopping: list[Controller] = []
        self._last_ns: int | None = None
        self.sensed: list[Publisher] = []
        """Topics of quantities that are only known after a step."""
        self._sensing: list[Controller] = []
        """The running controllers that publish such quantities."""
        self._shares = SharedJoints(robot.priorities)
        robot.take_over = self.take_over
        self.writes = True
        """Whether each update applies the commands to the joints; otherwise `write` does."""

    @property
    def controllers(self) -> list[Controller]:
        """The loaded controllers, in the order of loading."""
        return list(self._controllers.values())

    def find(self, name: str) -> Controller | None:
        """Returns the loaded controller with this name, or None."""
        return self._controllers.get(name)

    def state(self, controller: Controller) -> str:
        """Returns ``initialized``, ``running`` or ``stopped``."""
        if controller.running:
            return "running"
        return "stopped" if controller.name in self._begun else "initialized"

    def load(self, name: str, settings: Settings, type_name: str) -> Controller:
        """Creates a controller.

        Raises:
            CartwheelError: The controller is already loaded, its type does not exist, or its
                parameters or joints are invalid. Nothing has changed.
        """
        if name in self._controllers:
            raise wrong_state(name, "is already loaded")
        file = self.robot.plugin.part.description.origin.file
        family = find_type(type_name, ros2=self.robot.ros2, file=file)
        interval = self._interval(settings) if self.robot.ros2 else 0
        controller = family(name, type_name.strip().replace("::", "/"), settings, self.robot)
        settings.ignore("type")
        controller.interval_ns = interval
        unread = settings.unread()
        if unread:
            self.robot.plugin.warn(
                devices.CONTROLLER_PARAMETER_UNKNOWN,
                f'controller "{name}" ignores unknown parameters: {", ".join(unread)}',
                at=Origin(file=settings.source) if settings.source else None,
                values={"controller": name, "parameters": tuple(unread)},
            )
        self._controllers[name] = controller
        if type(controller).sense is not Controller.sense:
            self.sensed += controller.publishers
        self._order = update_order(self._controllers)
        return controller

    def _interval(self, settings: Settings) -> int:
        """The time between two updates of a controller, ns; 0 for that of the manager.

        Each controller of ROS 2 has the parameter ``update_rate``, in Hz. It is not updated more
        often, and 0 stands for the rate of the manager. Source: controller_interface.

        Raises:
            PluginError: The rate is negative.
        """
        rate = settings.number("update_rate", 0.0)
        if rate < 0:
            raise settings.invalid("update_rate", rate, "0 or positive")
        own = self.robot.period_ns
        updates = math.ceil(1e9 / (rate * own) - _ROUNDING) if rate else 1
        return own * updates if updates > 1 else 0

    def load_entry(self, entry: ControllerEntry) -> Controller:
        """Creates a controller from a file; see `load`."""
        self.robot.remappings[entry.name] = entry.remappings
        self.robot.spaces[entry.name] = entry.space
        return self.load(entry.name, entry.settings(), entry.type)

    def unload(self, name: str) -> None:
        """Closes a controller that is not running.

        Raises:
            GraphError: The controller is not loaded, or is running.
        """
        controller = self._controllers.get(name)
        if controller is None:
            raise wrong_state(name, "is not loaded")
        if controller.running:
            raise wrong_state(name, "is running", hint="Stop the controller first.")
        del self._controllers[name]
        for publisher in controller.publishers:
            if publisher in self.sensed:
                self.sensed.remove(publisher)
        self._order = update_order(self._controllers)
        self._begun.discard(name)
        controller.close()

    def unload_all(self, *, force: bool, active: str) -> None:
        """Closes all controllers.

        Args:
            force: Stop those that run.
            active: Their state, as it follows the name in the message.

        Raises:
            GraphError: Without `force`, if a controller is running.
        """
        running = [each.name for each in self.controllers if each.running]
        if running and not force:
            raise wrong_state(running[0], active, hint="Stop all controllers first.")
        self.switch([], running)
        for each in self.controllers:
            self.unload(each.name)

    def switch(
        self,
        start: Sequence[str],
        stop: Sequence[str],
        *,
        strict: bool = True,
        sharing: Collection[str] = (),
    ) -> None:
        """Stops some controllers and starts others at the next update.

        Args:
            start: Names of the controllers to start.
            stop: Names of the controllers to stop.
            strict: Change nothing if one of them cannot be switched; otherwise switch all that can
                be.
            sharing: See `plan_switch`.

        Raises:
            GraphError: With `strict`, if a controller is not loaded, already is in the requested
                state, or would command a joint of another controller.
        """
        switch = plan_switch(
            self._controllers,
            self._order,
            start=start,
            stop=stop,
            report=None if strict else self.robot.report_error,
            sharing=sharing,
        )
        for controller in switch.stopping:
            controller.running = False
            if controller in self._starting:
                self._starting.remove(controller)
            self._stopping.append(controller)
        for controller in switch.starting:
            controller.running = True
            self._begun.add(controller.name)
            self._starting.append(controller)
        self._sensing = [
            each
            for each in self._controllers.values()
            if each.running and type(each).sense is not Controller.sense
        ]

    def take_over(self, name: str) -> None:
        """Starts a controller at the next update, and stops those that command one of its joints.

        Raises:
            GraphError: See `switch`.
        """
        claims = self._controllers[name].claims.keys()
        others = [
            each.name
            for each in self.controllers
            if each.running and each.name != name and not claims.isdisjoint(each.claims)
        ]
        self.switch([name], others)

    def with_leaders(self, names: Sequence[str]) -> list[str]:
        """Returns the names, and those of all running controllers that command them.

        These must stop together.
        """
        return with_leaders(self._order, names)

    def update(self) -> None:
        """Starts, stops and updates controllers, and commands the joints."""
        time_ns = self._clock.time_ns
        last_ns, self._last_ns = self._last_ns, time_ns
        if last_ns is None:
            seconds = self.robot.period_ns / 1e9
            self._hardware.start()
        else:
            seconds = (time_ns - last_ns) / 1e9
        if self._stopping:
            for controller in self._stopping:
                with self._shares.kept(controller):
                    controller.end(time_ns)
                self._shares.end(controller)
            self._stopping.clear()
        if self._starting:
            for controller in self._starting:
                self._shares.begin(controller)
                with self._shares.kept(controller):
                    controller.begin(time_ns)
                self._report_shared(controller)
            self._starting.clear()
        shared = self._shares.any
        for controller in self._order:
            if controller.running:
                if time_ns >= controller.next_ns:
                    since = seconds
                    if controller.interval_ns:
                        since = controller.since_update(time_ns)
                        if not since:
                            continue
                    if shared:
                        with self._shares.kept(controller):
                            controller.update(time_ns, since)
                    else:
                        controller.update(time_ns, since)
            else:
                controller.idle(time_ns)
        if self.writes:
            self._hardware.write(seconds)

    def _report_shared(self, controller: Controller) -> None:
        for joint, interface, other, followed in self._shares.lost(controller):
            self.robot.plugin.warn(
                running.JOINT_SHARED,
                f'joint "{joint.name}" ignores the {interface} commands of controller '
                f'"{other.name}", because another controller commands its {followed}, as in Gazebo',
                at=joint.interfaces.origin,
                values={"joint": joint.name, "controller": other.name, "followed": followed},
            )

    def write(self) -> None:
        """Applies the commands to the joints between updates; called at every step."""
        clock = self._clock
        if self._last_ns is not None:
            lead = (clock.time_ns - self._last_ns) / 1e9
            self._hardware.write(clock.step_ns / 1e9, lead=lead)

    def sense(self) -> None:
        """Lets controllers publish quantities that are only known after a step."""
        time_ns = self._clock.time_ns
        for controller in self._controllers.values():
            if controller.started:
                controller.sense(time_ns)

    def senses(self) -> bool:
        """Whether a running controller has such quantities to publish."""
        for controller in self._sensing:  # noqa: SIM110 - any() costs more than the answer
            if controller.senses:
                return True
        return False

    def reset(self) -> None:
        """Restarts the running controllers after a reset of the simulation."""
        self._last_ns = None
        self._stopping.clear()
        self._starting = [each for each in self._controllers.values() if each.running]
        self._shares.clear()
        for controller in self._starting:
            controller.interrupt()
            controller.started = False

    def structure(self) -> tuple[LoadedController, ...]:
        """The loaded controllers, for `rebuild`."""
        remappings = self.robot.remappings
        return tuple(
            LoadedController(each.name, each.type, each.settings, remappings.get(each.name))
            for each in self._controllers.values()
        )

    def rebuild(self, structure: Sequence[LoadedController]) -> None:
        """Unloads and loads controllers, so that they are those of a saved `structure`.

        Raises:
            CartwheelError: A controller cannot be loaded.
        """
        wanted = {each.name: each for each in structure}
        for each in self.structure():
            if not each.equals(wanted.get(each.name)):
                self._controllers[each.name].running = False
                self.unload(each.name)
        for name, each in wanted.items():
            if name not in self._controllers:
                if each.remappings is not None:
                    self.robot.remappings[name] = each.remappings
                self.load(name, each.settings, each.type)
        self._controllers = {name: self._controllers[name] for name in wanted}
        self._order = update_order(self._controllers)

    def close(self) -> None:
        """Unloads all controllers."""
        for controller in self._controllers.values():
            controller.close()
        self._controllers.clear()
        self._order = []
