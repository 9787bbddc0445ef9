"""The services of ROS 1's controller manager."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import TimeoutError as NotYet
from typing import Any, TypeVar

from cartwheel.calls import answered
from cartwheel.codes import running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros_control.catalogue import controller_types
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.manager import ControllerManager
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.ros_control.switching import wrong_state
from cartwheel.errors import CartwheelError, GraphError
from cartwheel.graph import resolve_name
from cartwheel.messages import message_class

T = TypeVar("T")
_MESSAGES = "controller_manager_msgs"
_BASE = "controller_interface::ControllerBase"
_PATIENCE = 30.0
"""Maximum time in s for the thread that owns the simulation to respond."""


class ManagerServices:
    """``controller_manager/list_controllers`` and the other services, in the manager's namespace.

    ``load_controller`` reads parameters, possibly from the parameter server of another process, so
    it runs on its caller's thread.
    """

    def __init__(self, plugin: Plugin[Any], manager: ControllerManager) -> None:
        self._plugin = plugin
        self._manager = manager
        namespace = manager.robot.namespace.strip("/")
        prefix = f"/{namespace}/controller_manager" if namespace else "/controller_manager"
        for name, kind, handler, threaded in (
            ("list_controllers", "ListControllers", self._list, False),
            ("list_controller_types", "ListControllerTypes", self._types, False),
            ("load_controller", "LoadController", self._load, True),
            ("unload_controller", "UnloadController", self._unload, False),
            ("switch_controller", "SwitchController", self._switch, False),
            ("reload_controller_libraries", "ReloadControllerLibraries", self._reload, False),
        ):
            plugin.serve(f"{prefix}/{name}", f"{_MESSAGES}/srv/{kind}", handler, threaded=threaded)

    def _list(self, request: Any) -> Any:  # noqa: ARG002
        return _response("ListControllers")(
            controller=[self._state(each) for each in self._manager.controllers]
        )

    def _state(self, controller: Controller) -> Any:
        by_kind: dict[str, list[str]] = {}
        for joint, interface in controller.interfaces.items():
            kind = f"hardware_interface::{interface.capitalize()}JointInterface"
            by_kind.setdefault(kind, []).append(joint)
        if not by_kind:
            by_kind = {"hardware_interface::JointStateInterface": []}
        Resources = message_class(f"{_MESSAGES}/msg/HardwareInterfaceResources")
        return message_class(f"{_MESSAGES}/msg/ControllerState")(
            name=controller.name,
            state=self._manager.state(controller),
            type=controller.type,
            claimed_resources=[
                Resources(hardware_interface=kind, resources=sorted(joints))
                for kind, joints in by_kind.items()
            ],
        )

    def _types(self, request: Any) -> Any:  # noqa: ARG002
        types = sorted(controller_types())
        return _response("ListControllerTypes")(types=types, base_classes=[_BASE] * len(types))

    def _load(self, request: Any) -> Any:
        name = request.name.strip("/ ")
        try:
            path = resolve_name(name, self._manager.robot.namespace)
        except GraphError as error:
            fault = error  # Python deletes the name of an except clause at its end.
            self._plugin.graph.post(lambda: self._manager.robot.report_error(fault))
            return _response("LoadController")(ok=False)
        values = self._plugin.graph.parameters.get(path)

        def load() -> bool:
            if not isinstance(values, dict) or not isinstance(values.get("type"), str):
                raise GraphError(
                    f'the type of controller "{name}" is not specified because there is no '
                    f"parameter {path}/type",
                    code=running.CONTROLLER_TYPE_MISSING,
                    hint="First load the controller's YAML file into that namespace.",
                    values={"controller": name, "parameter": f"{path}/type"},
                )
            settings = Settings(values, name, f"parameters of {path}")
            self._manager.load(name, settings, values["type"])
            return True

        return _response("LoadController")(ok=self._on_owner(lambda: self._try(load)))

    def _unload(self, request: Any) -> Any:
        def unload() -> bool:
            self._manager.unload(request.name)
            return True

        return _response("UnloadController")(ok=self._try(unload))

    def _switch(self, request: Any) -> Any:
        def switch() -> bool:
            self._manager.switch(
                list(request.start_controllers),
                list(request.stop_controllers),
                strict=request.strictness != request.BEST_EFFORT,
            )
            return True

        return _response("SwitchController")(ok=self._try(switch))

    def _reload(self, request: Any) -> Any:
        def reload() -> bool:
            active = [each.name for each in self._manager.controllers if each.running]
            if active and not request.force_kill:
                raise wrong_state(active[0], "is running", hint="Stop all controllers first.")
            self._manager.switch([], active)
            for each in self._manager.controllers:
                self._manager.unload(each.name)
            return True

        return _response("ReloadControllerLibraries")(ok=self._try(reload))

    def _try(self, function: Callable[[], bool]) -> bool:
        try:
            return function()
        except CartwheelError as error:
            self._manager.robot.report_error(error)
            return False

    def _on_owner(self, function: Callable[[], T]) -> T:
        future = answered(self._plugin.graph.post, function)
        try:
            return future.result(timeout=_PATIENCE)
        except NotYet:
            future.cancel()
            raise GraphError(
                "the simulation does not respond", code=running.SIMULATION_UNRESPONSIVE
            ) from None


def _response(service: str) -> Any:
    return message_class(f"{_MESSAGES}/srv/{service}_Response")
