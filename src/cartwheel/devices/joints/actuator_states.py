"""States of actuated joints, with freely assigned interfaces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.periodic import Periodic
from cartwheel.messages import header, message_class
from cartwheel.messages.store import TWIN

_STATES = "sensor_msgs/msg/JointState"
_DYNAMIC = f"control_msgs{TWIN}/msg/DynamicJointState"
_ALL = ("position", "velocity", "effort")


@dataclass(frozen=True, kw_only=True, slots=True)
class ActuatorStatesConfig:
    topic: str
    """Topic of the positions, velocities and efforts (JointState)."""
    dynamic_topic: str = ""
    """Topic of all interfaces (DynamicJointState); empty if it is not published."""
    rate: float = 0.0
    """Publish rate, Hz; 0: at each update."""
    frame: str = ""
    """Frame of the messages."""
    names: tuple[str, ...]
    """Names of the joints in the messages."""
    sources: tuple[str, ...] = _ALL
    """The interfaces that are published as position, velocity and effort; NaN if unknown."""
    kinds: tuple[tuple[str, ...], ...] = ()
    """The interfaces of each joint on the dynamic topic."""
    others: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """Constant states of further joints."""


class ActuatorStates(Component):
    """Publishes states of joints and constants, in the order of the configuration.

    Args:
        scope: Names of the topics.
        config: Topics and contents.
        joints: The joints.
    """

    def __init__(
        self, scope: Scope, config: ActuatorStatesConfig, joints: Sequence[JointActuator]
    ) -> None:
        super().__init__(scope)
        self._config, self._joints = config, tuple(joints)
        self._publisher = self.advertise(config.topic, _STATES, rate=config.rate or None)
        self._dynamic = (
            self.advertise(config.dynamic_topic, _DYNAMIC) if config.dynamic_topic else None
        )
        self._names = [*config.names, *config.others]
        self.periodic = Periodic(config.rate)
        """Determines when the states are due. Until then, `update` need not be called."""
        self._JointState = message_class(_STATES)

    def start(self, time_ns: int) -> None:
        """Publishes at the rate from now on."""
        self.periodic.start(time_ns)

    def update(self, time_ns: int) -> None:
        """Publishes the current states when due."""
        if not self.periodic.due(time_ns):
            return
        dynamic = self._dynamic is not None and self._dynamic.wanted
        if not (self._publisher.wanted or dynamic):
            return
        config = self._config
        head = header(time_ns, config.frame)
        if self._publisher.wanted:
            others = config.others.values()
            columns = [
                np.array([*(value(each, source) for each in self._joints), *constants])
                for source, constants in zip(
                    config.sources, zip(*others, strict=True) if others else [()] * 3, strict=True
                )
            ]
            self._publisher.publish(self._JointState(head, self._names, *columns))
        if self._dynamic is not None and self._dynamic.wanted:
            self._dynamic.publish(self._dynamic_message(head))

    def _dynamic_message(self, head: Any) -> Any:
        states = [
            (list(kinds), [value(joint, kind) for kind in kinds])
            for joint, kinds in zip(self._joints, self._config.kinds, strict=True)
        ]
        states += [(list(_ALL), list(values)) for values in self._config.others.values()]
        InterfaceValue = message_class(f"control_msgs{TWIN}/msg/InterfaceValue")
        return message_class(_DYNAMIC)(
            header=head,
            joint_names=self._names,
            interface_values=[
                InterfaceValue(interface_names=kinds, values=np.array(values))
                for kinds, values in states
            ],
        )


def value(joint: JointActuator, kind: str) -> float:
    """Returns the value of a state interface; NaN if it does not exist."""
    return float(getattr(joint, kind)) if kind in _ALL else math.nan
