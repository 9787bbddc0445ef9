"""The services of controller managers, and those of ROS 1's in particular."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import TimeoutError as NotYet
from typing import Any, ClassVar, TypeVar

from cartwheel.calls import answered
from cartwheel.codes import running
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros_control.catalogue import controller_types
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.manager import ControllerManager
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import CartwheelError, GraphError
from cartwheel.graph import resolve_name
from cartwheel.messages import message_class

T = TypeVar("T")
_PATIENCE = 30.0
"""Maximum time in s for the thread that owns the simulation to respond."""


class ManagerServices:
    """Base class of a controller manager's services, in ``<namespace>/<manager's name>``.

    Args:
        manager: The manager.
        name: Name of the manager's node.
    """

    package: ClassVar[str]
    """Package of the service types."""
    base: ClassVar[str]
    """Base class of the controllers, in lists of types."""

    def __init__(self, manager: ControllerManager, name: str) -> None:
        self._manager = manager
        namespace = manager.robot.namespace.strip("/")
        self._prefix = f"/{namespace}/{name}" if namespace else f"/{name}"

    def _offer(
        self,
        plugin: Plugin[Any],
        handlers: Mapping[str, Callable[[Any], Any]],
        *,
        threaded: str = "",
    ) -> None:
        """Offers services by their types; `threaded` runs on its caller's thread."""
        for kind, handler in handlers.items():
            name = "".join(f"_{each.lower()}" if each.isupper() else each for each in kind)
            plugin.serve(
                f"{self._prefix}/{name.lstrip('_')}",
                f"{self.package}/srv/{kind}",
                handler,
                threaded=kind == threaded,
            )

    def _response(self, kind: str, **fields: Any) -> Any:
        return message_class(f"{self.package}/srv/{kind}_Response")(**fields)

    def _answer(self, kind: str, function: Callable[[Any], None]) -> Callable[[Any], Any]:
        """Returns a service handler that responds with ``ok`` and reports errors."""
        return lambda request: self._response(kind, ok=self._try(lambda: function(request)))

    def _try(self, function: Callable[[], None]) -> bool:
        try:
            function()
        except CartwheelError as error:
            self._manager.robot.report_error(error)
            return False
        return True

    def _types(self, request: Any) -> Any:  # noqa: ARG002
        types = sorted(controller_types())
        bases = [self.base] * len(types)
        return self._response("ListControllerTypes", types=types, base_classes=bases)


class Ros1ManagerServices(ManagerServices):
    """``controller_manager/list_controllers`` and the other services, in the manager's namespace.

    ``load_controller`` reads parameters, possibly from the parameter server of another process, so
    it runs on its caller's thread.
    """

    package = "controller_manager_msgs"
    base = "controller_interface::ControllerBase"

    def __init__(self, plugin: Plugin[Any], manager: ControllerManager) -> None:
        super().__init__(manager, "controller_manager")
        self._plugin = plugin
        handlers: dict[str, Callable[[Any], Any]] = {
            "ListControllers": self._list,
            "ListControllerTypes": self._types,
            "LoadController": self._load,
            "UnloadController": self._answer("UnloadController", self._unload),
            "SwitchController": self._answer("SwitchController", self._switch),
            "ReloadControllerLibraries": self._answer("ReloadControllerLibraries", self._reload),
        }
        self._offer(plugin, handlers, threaded="LoadController")

    def _list(self, request: Any) -> Any:  # noqa: ARG002
        return self._response(
            "ListControllers", controller=[self._state(each) for each in self._manager.controllers]
        )

    def _state(self, controller: Controller) -> Any:
        by_kind: dict[str, list[str]] = {}
        for joint, interface in controller.interfaces.items():
            kind = f"hardware_interface::{interface.capitalize()}JointInterface"
            by_kind.setdefault(kind, []).append(joint)
        if not by_kind:
            by_kind = {"hardware_interface::JointStateInterface": []}
        Resources = message_class(f"{self.package}/msg/HardwareInterfaceResources")
        return message_class(f"{self.package}/msg/ControllerState")(
            name=controller.name,
            state=self._manager.state(controller),
            type=controller.type,
            claimed_resources=[
                Resources(hardware_interface=kind, resources=sorted(joints))
                for kind, joints in by_kind.items()
            ],
        )

    def _load(self, request: Any) -> Any:
        name = request.name.strip("/ ")
        try:
            path = resolve_name(name, self._manager.robot.namespace)
        except GraphError as error:
            fault = error  # Python deletes the name of an except clause at its end.
            self._plugin.graph.post(lambda: self._manager.robot.report_error(fault))
            return self._response("LoadController", ok=False)
        values = self._plugin.graph.parameters.get(path)

        def load() -> None:
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

        return self._response("LoadController", ok=self._on_owner(lambda: self._try(load)))

    def _unload(self, request: Any) -> None:
        self._manager.unload(request.name)

    def _switch(self, request: Any) -> None:
        self._manager.switch(
            list(request.start_controllers),
            list(request.stop_controllers),
            strict=request.strictness != request.BEST_EFFORT,
        )

    def _reload(self, request: Any) -> None:
        self._manager.unload_all(force=request.force_kill, active="is running")

    def _on_owner(self, function: Callable[[], T]) -> T:
        future = answered(self._plugin.graph.post, function)
        try:
            return future.result(timeout=_PATIENCE)
        except NotYet:
            future.cancel()
            raise GraphError(
                "the simulation does not respond", code=running.SIMULATION_UNRESPONSIVE
            ) from None
