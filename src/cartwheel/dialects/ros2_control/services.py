"""The services of ROS 2's controller manager, which ``ros2 control`` and ``spawner`` call."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from cartwheel.codes import running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros2_control.components import HardwareComponents
from cartwheel.dialects.ros_control.catalogue import find_type
from cartwheel.dialects.ros_control.chaining import Reference, owners
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.files import (
    ControllerEntry,
    controller_entry,
    read_ros2,
    remappings,
    ros2_file,
)
from cartwheel.dialects.ros_control.manager import ControllerManager
from cartwheel.dialects.ros_control.parameter_services import ParameterServices
from cartwheel.dialects.ros_control.services import ManagerServices
from cartwheel.dialects.ros_control.switching import wrong_state
from cartwheel.errors import CartwheelError, GraphError
from cartwheel.messages import message_class

_MESSAGES = "controller_manager_msgs_ros2"


class Ros2ManagerServices(ManagerServices):
    """``controller_manager/list_controllers`` and the other services, in the manager's namespace.

    A controller is unconfigured, inactive or active. The controller manager has only configured
    ones; this class has the others. Controllers that start automatically are configured and active,
    although a launch file may still load and configure them. The first request to configure such a
    controller stops it, so that it is inactive as the spawner expects. Source: ros2_control,
    controller_manager.

    Args:
        plugin: The plugin of the controller manager.
        manager: The manager of the configured controllers.
        name: Name of the manager's node.
        entries: The controllers in the robot's files.
        components: The hardware components.
        check: Reports the parameters of a controller that ROS 2 refuses, with the files in which
            they are, besides those of the robot.
    """

    package = _MESSAGES
    base = "controller_interface::ControllerInterface"

    def __init__(
        self,
        plugin: Plugin[Any],
        manager: ControllerManager,
        *,
        name: str,
        entries: Sequence[ControllerEntry],
        components: HardwareComponents,
        check: Callable[[ControllerEntry, Sequence[Path]], None],
    ) -> None:
        super().__init__(manager, name)
        self._check = check
        self._components = components
        self._entries = {entry.name: entry for entry in entries}
        self._by_itself = {each.name for each in manager.controllers}
        """Controllers that started automatically and that no request has named yet."""
        self._unconfigured: dict[str, ControllerEntry] = {}
        self._name = name
        plugin.graph.nodes[plugin.node] = self._prefix
        stated = {f"{entry.name}.type": entry.type for entry in entries}
        self._parameters = ParameterServices(
            plugin.serve,
            self._prefix,
            {"update_rate": self._rate, "use_sim_time": True, **stated},
            open_=True,
        )
        handlers: dict[str, Callable[[Any], Any]] = {
            "ListControllers": self._list,
            "ListControllerTypes": self._types,
            "LoadController": self._answer("LoadController", self._load),
            "ConfigureController": self._answer("ConfigureController", self._configure),
            "CleanupController": self._answer("CleanupController", self._cleanup),
            "UnloadController": self._answer("UnloadController", self._unload),
            "ReloadControllerLibraries": self._answer("ReloadControllerLibraries", self._reload),
            "SwitchController": self._switch,
            "ListHardwareInterfaces": self._list_interfaces,
            "ListHardwareComponents": self._list_components,
            "SetHardwareComponentState": self._set_component,
        }
        self._offer(plugin, handlers)

    # -- controllers

    def _list(self, request: Any) -> Any:  # noqa: ARG002
        states = [self._state(each) for each in self._manager.controllers]
        states += [
            _controller_state(name=entry.name, type=entry.type, state="unconfigured")
            for entry in self._unconfigured.values()
        ]
        return self._response("ListControllers", controller=states)

    def _state(self, controller: Controller) -> Any:
        commands = [f"{joint}/{kind}" for joint, kind in controller.interfaces.items()]
        return _controller_state(
            name=controller.name,
            type=controller.type,
            state="active" if controller.running else "inactive",
            update_rate=round(1e9 / controller.interval_ns)
            if controller.interval_ns
            else self._rate,
            claimed_interfaces=commands if controller.running else [],
            required_command_interfaces=commands,
            required_state_interfaces=controller.state_interfaces(),
            is_chainable=bool(controller.references),
            is_chained=controller.chained,
            reference_interfaces=[each.own_name for each in controller.references],
            chain_connections=[
                message_class(f"{_MESSAGES}/msg/ChainConnection")(
                    name=owner,
                    reference_interfaces=[
                        each.full_name
                        for each in controller.claims.values()
                        if isinstance(each, Reference) and each.owner == owner
                    ],
                )
                for owner in owners(controller.claims.values())
            ],
        )

    @property
    def _rate(self) -> int:
        period_ns = self._manager.robot.period_ns
        return round(1e9 / period_ns) if period_ns else 0

    def _load(self, request: Any) -> None:
        name = request.name
        if name in self._unconfigured or self._manager.find(name) is not None:
            raise wrong_state(name, "is already loaded")
        entry = self._entry(name)
        find_type(entry.type, ros2=True)
        self._unconfigured[name] = entry

    def _entry(self, name: str) -> ControllerEntry:
        """Returns a controller's type and parameters; parameters that were set override files.

        Raises:
            CartwheelError: The type is not specified, or a file cannot be read.
        """
        stated = self._parameters.below(name)
        namespace = self._manager.robot.namespace
        entry = self._entries.get(name)
        if entry is None:
            entry = ControllerEntry(
                name=name, type="", values={}, namespace=namespace, source="parameters"
            )
        paths = self._param_files(name)
        if paths:
            robot = self._manager.robot.plugin.part.description
            contents = [read_ros2(path, robot) for path in paths]
            read = ros2_file(contents, namespace, self._name)
            more = controller_entry(read, name, namespace, ", ".join(map(str, paths)))
            values = {**entry.values, **more.values}
            entry = replace(more, type=more.type or entry.type, values=values)
        kind = stated.get("type") or entry.type
        if not kind:
            raise GraphError(
                f'the type of controller "{name}" is not specified because there is no parameter '
                f"{name}.type",
                code=running.CONTROLLER_TYPE_MISSING,
                hint="Specify it in a <parameters> file, or pass --param-file to the spawner.",
                values={"controller": name, "parameter": f"{name}.type"},
            )
        renamed = remappings(stated.get("node_options_args", []))
        return replace(entry, type=kind, remappings={**entry.remappings, **renamed})

    def _param_files(self, name: str) -> list[Path]:
        """The files that the spawner gives to a controller."""
        files = self._parameters.below(name).get("params_file", [])
        return [Path(each) for each in ([files] if isinstance(files, str) else files)]

    def _configure(self, request: Any) -> None:
        name = request.name
        controller = self._manager.find(name)
        if controller is None:
            if name not in self._unconfigured:
                raise wrong_state(name, "is not loaded")
            entry = self._unconfigured[name]
            self._check(entry, self._param_files(name))
            self._manager.load_entry(entry)
            del self._unconfigured[name]
        elif name in self._by_itself:
            self._by_itself.discard(name)
            if controller.running:
                self._manager.switch([], self._manager.with_leaders([name]))
        elif controller.running:
            raise wrong_state(name, "is active, so it cannot be configured")
        else:
            entry = replace(self._entry(name), type=controller.type)
            self._manager.unload(name)
            self._unconfigured[name] = entry
            self._manager.load_entry(entry)
            del self._unconfigured[name]

    def _cleanup(self, request: Any) -> None:
        if request.name in self._unconfigured:
            return
        entry = self._entry(request.name)
        self._manager.unload(request.name)
        self._by_itself.discard(request.name)
        self._unconfigured[request.name] = entry

    def _unload(self, request: Any) -> None:
        if self._unconfigured.pop(request.name, None) is None:
            self._manager.unload(request.name)
            self._by_itself.discard(request.name)

    def _reload(self, request: Any) -> None:
        self._manager.unload_all(force=request.force_kill, active="is active")
        self._unconfigured.clear()
        self._by_itself.clear()

    def _switch(self, request: Any) -> Any:
        strict = request.strictness not in (0, request.BEST_EFFORT)
        start, stop = list(request.activate_controllers), list(request.deactivate_controllers)
        try:
            unready = [name for name in start if name in self._unconfigured]
            away = [name for name in start if self._components.lacks(self._manager.find(name))]
            if strict and unready:
                raise wrong_state(unready[0], "is not configured")
            if strict and away:
                raise GraphError(
                    f'the hardware of controller "{away[0]}" is not active',
                    code=running.HARDWARE_COMPONENT,
                    values={"controller": away[0]},
                )
            wanted = [name for name in start if name not in (*unready, *away)]
            names = [each.name for each in self._manager.controllers]
            self._manager.switch(wanted, stop, strict=strict, sharing=names)
        except CartwheelError as error:
            self._manager.robot.report_error(error)
            return self._response("SwitchController", ok=False, message=error.message)
        self._by_itself.difference_update(start, stop)
        return self._response("SwitchController", ok=True, message="")

    # -- hardware

    def _list_interfaces(self, request: Any) -> Any:  # noqa: ARG002
        commands, states = self._components.interfaces(self._manager.controllers)
        return self._response(
            "ListHardwareInterfaces", command_interfaces=commands, state_interfaces=states
        )

    def _list_components(self, request: Any) -> Any:  # noqa: ARG002
        return self._response(
            "ListHardwareComponents",
            component=self._components.messages(self._manager.controllers, self._rate),
        )

    def _set_component(self, request: Any) -> Any:
        try:
            self._components.change(request.name, request.target_state)
            away = [
                each.name
                for each in self._manager.controllers
                if each.running and self._components.lacks(each)
            ]
            self._manager.switch([], self._manager.with_leaders(away))
        except CartwheelError as error:
            self._manager.robot.report_error(error)
            return self._response(
                "SetHardwareComponentState", ok=False, state=self._components.state(request.name)
            )
        return self._response(
            "SetHardwareComponentState", ok=True, state=self._components.state(request.name)
        )


def _controller_state(**fields: Any) -> Any:
    empty: Mapping[str, Any] = {
        "is_async": False,
        "update_rate": 0,
        "claimed_interfaces": [],
        "required_command_interfaces": [],
        "required_state_interfaces": [],
        "is_chainable": False,
        "is_chained": False,
        "exported_state_interfaces": [],
        "reference_interfaces": [],
        "chain_connections": [],
    }
    return message_class(f"{_MESSAGES}/msg/ControllerState")(**{**empty, **fields})
