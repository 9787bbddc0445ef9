"""Hardware components of ROS 2's controller manager, one for each ``<ros2_control>`` tag."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from cartwheel.codes import running
from cartwheel.description.model import Element
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.interfaces import (
    JointInterfaces,
    SensorInterfaces,
    hardware_of,
)
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.messages import message_class

_MESSAGES = "controller_manager_msgs_ros2/msg"
_LABELS = {1: "unconfigured", 2: "inactive", 3: "active", 4: "finalized"}
"""Source: lifecycle_msgs, State."""
_ACTIVE, _FINALIZED = 3, 4


class HardwareComponents:
    """The hardware components with their interfaces and states. All are active initially.

    Args:
        systems: The ``<ros2_control>`` tags.
        joints: All joints in these tags.
        sensors: All sensors in these tags.
    """

    def __init__(
        self,
        systems: Iterable[Element],
        joints: Sequence[JointInterfaces],
        sensors: Sequence[SensorInterfaces],
    ) -> None:
        self._systems = {each.attribute("name") or "": each for each in systems}
        self._states = dict.fromkeys(self._systems, _ACTIVE)
        commands = {joint.name: joint.commands for joint in joints}
        states = {joint.name: joint.states for joint in joints}
        states |= {sensor.name: sensor.states for sensor in sensors}
        self._commands: dict[str, list[str]] = {}
        self._measures: dict[str, list[str]] = {}
        for name, system in self._systems.items():
            parts = {each.attribute("name") or "": None for each in system.find_all("joint")}
            sensed = [each.attribute("name") or "" for each in system.find_all("sensor")]
            self._commands[name] = _joined(parts, commands)
            self._measures[name] = _joined([*parts, *sensed], states)

    def lacks(self, controller: Controller | None) -> bool:
        """Whether a controller commands an interface of a component that is not active."""
        if controller is None:
            return False
        wanted = {f"{joint}/{kind}" for joint, kind in controller.interfaces.items()}
        return any(
            state != _ACTIVE and not wanted.isdisjoint(self._commands[name])
            for name, state in self._states.items()
        )

    def change(self, name: str, target: Any) -> None:
        """Changes the state of a component.

        Args:
            name: The component.
            target: ``lifecycle_msgs/State``, with an ID or a label.

        Raises:
            UnknownNameError: The component or the state does not exist.
            GraphError: The component is finalized, which cannot be undone.
        """
        if name not in self._systems:
            raise UnknownNameError(
                "hardware component", name, self._systems, code=running.HARDWARE_COMPONENT
            )
        by_label = {label: number for number, label in _LABELS.items()}
        wanted = int(target.id) or by_label.get(target.label, 0)
        if wanted not in _LABELS:
            raise UnknownNameError(
                "hardware state",
                target.label or str(target.id),
                by_label,
                code=running.HARDWARE_COMPONENT,
            )
        if self._states[name] == _FINALIZED and wanted != _FINALIZED:
            raise GraphError(
                f'hardware component "{name}" is finalized',
                code=running.HARDWARE_COMPONENT,
                values={"component": name},
            )
        self._states[name] = wanted

    def state(self, name: str) -> Any:
        """Returns ``lifecycle_msgs/State`` of a component; ``unknown`` if it does not exist."""
        number = self._states.get(name, 0)
        return message_class("lifecycle_msgs/msg/State")(
            id=number, label=_LABELS.get(number, "unknown")
        )

    def interfaces(self, controllers: Iterable[Controller]) -> tuple[list[Any], list[Any]]:
        """Returns the messages of all command interfaces and of all state interfaces."""
        claimed = _claimed(controllers)
        commands = [
            one for name in self._systems for one in self._command_interfaces(name, claimed)
        ]
        states = [one for name in self._systems for one in self._state_interfaces(name)]
        return commands, states

    def messages(self, controllers: Iterable[Controller], rate: int) -> list[Any]:
        """Returns the messages of all components. `rate` is the manager's update rate in Hz."""
        claimed = _claimed(controllers)
        return [
            message_class(f"{_MESSAGES}/HardwareComponentState")(
                name=name,
                type=system.attribute("type") or "system",
                rw_rate=rate,
                plugin_name=hardware_of(system),
                state=self.state(name),
                command_interfaces=self._command_interfaces(name, claimed),
                state_interfaces=self._state_interfaces(name),
            )
            for name, system in self._systems.items()
        ]

    def _state_interfaces(self, name: str) -> list[Any]:
        available = self._states[name] != 1
        return [_interface(each, available=available) for each in self._measures[name]]

    def _command_interfaces(self, name: str, claimed: set[str]) -> list[Any]:
        active = self._states[name] == _ACTIVE
        return [
            _interface(each, available=active, claimed=each in claimed)
            for each in self._commands[name]
        ]


def _joined(names: Iterable[str], known: Any) -> list[str]:
    return [f"{name}/{kind}" for name in names for kind in known.get(name, ())]


def _claimed(controllers: Iterable[Controller]) -> set[str]:
    return {
        f"{joint}/{kind}"
        for each in controllers
        if each.running
        for joint, kind in each.interfaces.items()
    }


def _interface(name: str, *, available: bool, claimed: bool = False) -> Any:
    return message_class(f"{_MESSAGES}/HardwareInterface")(
        name=name, data_type="double", is_available=available, is_claimed=claimed
    )
