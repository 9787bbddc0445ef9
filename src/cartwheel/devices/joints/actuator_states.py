"""States of actuated joints, with freely assigned interfaces."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.periodic import Periodic
from cartwheel.geometry import Array
from cartwheel.messages import Form, message_class, zero
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
        fields = ["header.stamp", "position", "velocity", "effort"]
        self._form = Form(self._template, *fields)
        count = len(config.kinds) + len(config.others)
        values = [f"interface_values.{index}.values" for index in range(count)]
        self._dynamic_form = Form(self._dynamic_template, "header.stamp", *values)

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
        if self._publisher.wanted:
            self._publisher.publish_values(self._form, (time_ns, *self._columns()))
        if self._dynamic is not None and self._dynamic.wanted:
            self._dynamic.publish_values(self._dynamic_form, (time_ns, *self._rows()))

    def _columns(self) -> Iterator[Array]:
        """Positions, velocities and efforts."""
        others = self._config.others.values()
        constants = zip(*others, strict=True) if others else [()] * 3
        for source, more in zip(self._config.sources, constants, strict=True):
            yield np.array([*(value(each, source) for each in self._joints), *more])

    def _rows(self) -> Iterator[Array]:
        """The interfaces of each joint on the dynamic topic."""
        for joint, kinds in zip(self._joints, self._config.kinds, strict=True):
            yield np.array([value(joint, kind) for kind in kinds])
        for values in self._config.others.values():
            yield np.array(values)

    def _template(self) -> Any:
        template, still = zero(_STATES), np.zeros(len(self._names))
        template.header.frame_id, template.name = self._config.frame, self._names
        template.position = template.velocity = template.effort = still
        return template

    def _dynamic_template(self) -> Any:
        template, config = zero(_DYNAMIC), self._config
        template.header.frame_id, template.joint_names = config.frame, self._names
        InterfaceValue = message_class(f"control_msgs{TWIN}/msg/InterfaceValue")
        template.interface_values = [
            InterfaceValue(interface_names=list(kinds), values=np.zeros(len(kinds)))
            for kinds in (*config.kinds, *[_ALL] * len(config.others))
        ]
        return template


def value(joint: JointActuator, kind: str) -> float:
    """Returns the value of a state interface; NaN if it does not exist."""
    return float(getattr(joint, kind)) if kind in _ALL else math.nan
