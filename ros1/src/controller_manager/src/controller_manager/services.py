"""Calls the services of a controller manager."""

from __future__ import annotations

import sys
import time
from typing import Any

STRICT = 2
NAMES = ("load_controller", "unload_controller", "switch_controller", "list_controllers")


class ManagerError(Exception):
    """The controller manager is not available, or a call failed."""


class Manager:
    """Calls the services of one controller manager.

    Args:
        namespace: Namespace of the robot; "" for the namespace of the node.
    """

    def __init__(self, namespace: str = "") -> None:
        prefix = f"{namespace.rstrip('/')}/" if namespace else ""
        self._prefix = f"{prefix}controller_manager/"

    def wait(self, timeout: float | None) -> None:
        """Waits for the services, up to `timeout` s of wall time. None means no limit.

        Raises:
            ManagerError: The services are not available in time.
        """
        import rospy

        end = None if timeout is None else time.monotonic() + timeout
        for name in NAMES:
            service = rospy.resolve_name(self._prefix + name)
            while True:
                left = 1.0 if end is None else min(1.0, end - time.monotonic())
                try:
                    rospy.wait_for_service(service, timeout=max(left, 0.01))
                    break
                except rospy.ROSException:
                    if rospy.is_shutdown():
                        raise ManagerError("interrupted") from None
                    if end is not None and time.monotonic() >= end:
                        raise ManagerError(
                            f"the service {service} is not available after {timeout:g} s: the "
                            "robot has no controller manager in this namespace, or is not spawned"
                        ) from None

    def load(self, name: str) -> bool:
        """Loads a controller. Returns False if it fails or if the controller is already loaded."""
        from controller_manager_msgs.srv import LoadController

        return bool(self._call("load_controller", LoadController, name=name).ok)

    def unload(self, name: str) -> bool:
        """Unloads a controller. Returns whether it succeeded."""
        from controller_manager_msgs.srv import UnloadController

        return bool(self._call("unload_controller", UnloadController, name=name).ok)

    def switch(self, start: list[str], stop: list[str]) -> bool:
        """Starts and stops controllers. Returns whether all were started and stopped."""
        from controller_manager_msgs.srv import SwitchController

        return bool(
            self._call(
                "switch_controller",
                SwitchController,
                start_controllers=start,
                stop_controllers=stop,
                strictness=STRICT,
                start_asap=False,
                timeout=0.0,
            ).ok
        )

    def controllers(self) -> list[Any]:
        """Returns the ``ControllerState`` of each loaded controller."""
        from controller_manager_msgs.srv import ListControllers

        return list(self._call("list_controllers", ListControllers).controller)

    def running(self) -> list[str]:
        """Returns the names of the running controllers."""
        return [each.name for each in self.controllers() if each.state == "running"]

    def types(self) -> list[tuple[str, str]]:
        """Returns each supported type with its base class."""
        from controller_manager_msgs.srv import ListControllerTypes

        found = self._call("list_controller_types", ListControllerTypes)
        return list(zip(found.types, found.base_classes, strict=True))

    def reload(self, *, force: bool) -> bool:
        """Unloads all controllers. Returns whether it succeeded."""
        from controller_manager_msgs.srv import ReloadControllerLibraries

        answer = self._call(
            "reload_controller_libraries", ReloadControllerLibraries, force_kill=force
        )
        return bool(answer.ok)

    def _call(self, service: str, kind: Any, /, **request: Any) -> Any:
        import rospy

        try:
            return rospy.ServiceProxy(self._prefix + service, kind)(**request)
        except (rospy.ServiceException, rospy.ROSException) as error:
            raise ManagerError(str(error)) from None


def own_arguments() -> list[str]:
    """Returns the program's arguments without remappings. Does not import rospy."""
    return [word for word in sys.argv[1:] if ":=" not in word]


def join_ros(name: str) -> None:
    """Initializes the ROS node of the program."""
    import rospy

    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    # Use wall time, because simulation time may be paused.
    rospy.init_node(name, anonymous=True, disable_rostime=True)
