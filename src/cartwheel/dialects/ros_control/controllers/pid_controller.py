"""``pid_controller``: PID controllers of joints, with references from a topic or a controller."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.devices.joints.pid_joint import UNKNOWN, PidLoop, PidLoopConfig
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.gains import GAINS, read_ros2_gains
from cartwheel.dialects.ros_control.interfaces import COMMANDS
from cartwheel.dialects.ros_control.parameters import OWN, ignored, parameter
from cartwheel.messages import header, message_class, zero
from cartwheel.messages.store import TWIN

_COMMAND = f"control_msgs{TWIN}/msg/MultiDOFCommand"
_STATE = f"control_msgs{TWIN}/msg/MultiDOFStateStamped"
_ONE_STATE = f"control_msgs{TWIN}/msg/SingleDOFState"


@dataclass(frozen=True, kw_only=True, slots=True)
class PidControllerParameters:
    joints: tuple[str, ...] = parameter(
        "dof_names", role="joint", interface=OWN, doc="Joints that are commanded."
    )
    states: tuple[str, ...] = parameter(
        "reference_and_state_dof_names",
        default=(),
        doc="Joints that are measured, and names of the references. Default: `dof_names`.",
    )
    kinds: tuple[str, ...] = parameter(
        "reference_and_state_interfaces",
        doc="Measured quantity: `position`, `velocity`, `effort`, or `position` and `velocity`.",
    )
    interface: str = parameter(
        "command_interface", role="interface", doc="Interface of the commands."
    )
    external: bool = parameter(
        "use_external_measured_states",
        default=False,
        doc="Use the measurements on the topic `measured_state`.",
    )
    feedforward: bool = parameter(
        "enable_feedforward", default=True, doc="Add the feedforward term to the output."
    )
    starts_at_state: bool = parameter(
        "set_current_state_as_first_setpoint",
        default=True,
        doc="Hold the current state until the first reference.",
    )
    gains: None = ignored(
        "gains/{joint}",
        doc=f"{GAINS} Also `feedforward_gain` and `angle_wraparound`.",
    )


class PidController(Controller):
    """Commands joints by a PID on the error of their references, with feedforward.

    The references come from another controller that uses ``<controller>/<joint>`` as its joint, or
    else from ``reference`` (MultiDOFCommand). The measured values are those of the joint, or with
    ``use_external_measured_states`` those on ``measured_state``. ``feedforward_gain`` times the
    reference is added to the output. Source: pid_controller.
    """

    types: ClassVar[tuple[str, ...]] = ("pid_controller/PidController",)

    parameters = PidControllerParameters

    def configure(self, given: PidControllerParameters) -> None:
        settings, names = self.settings, given.joints
        self._names = list(given.states or names)
        if not names or len(self._names) != len(names):
            wanted = f"a list of {len(names)} names, as many as in dof_names"
            raise settings.invalid("reference_and_state_dof_names", self._names, wanted)
        kinds = list(given.kinds)
        if not (len(kinds) == 1 and kinds[0] in COMMANDS) and kinds != ["position", "velocity"]:
            wanted = f"one of {', '.join(COMMANDS)}, or position and velocity"
            raise settings.invalid("reference_and_state_interfaces", kinds, wanted)
        interface = given.interface
        self._external, self._feedforward = given.external, given.feedforward
        self._starts_at_state = given.starts_at_state
        self._loops = []
        for name, state_name in zip(names, self._names, strict=True):
            joint = self.claim(name, interface)
            # Only the state of a joint with a different name is used.
            state = joint if name == state_name else self.robot.hardware.joint(state_name)
            section = settings.section(f"gains/{name}")
            config = PidLoopConfig(
                gains=read_ros2_gains(section),
                quantity=kinds[0],  # type: ignore[arg-type]
                damped=interface == "effort" and state is joint and not self._external,
                feedforward_gain=section.number("feedforward_gain", 0.0),
                wraparound=section.boolean("angle_wraparound", False),
            )
            references = tuple(self.export(state, kind) for kind in kinds)
            self._loops.append(PidLoop(joint, state, references, config))
        self.subscribe("reference", _COMMAND, self._on_reference)
        if self._external:
            self.subscribe("measured_state", _COMMAND, self._on_measured)
        self.serve("set_feedforward_control", "std_srvs/srv/SetBool", self._on_feedforward)
        self._state_publisher = self.advertise("controller_state", _STATE)

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        for loop in self._loops:
            loop.start()
            if not self.chained:
                here = self._starts_at_state and not self._external
                loop.reference = loop.measure() if here else UNKNOWN

    def update(self, time_ns: int, seconds: float) -> None:
        for loop in self._loops:
            if not self._external:
                loop.measured = loop.measure()
            loop.update(seconds, feedforward=self._feedforward)
        if self._state_publisher.wanted:
            message = zero(_STATE)
            message.header = header(time_ns, "")
            message.dof_states = [
                _state_message(name, loop, seconds)
                for name, loop in zip(self._names, self._loops, strict=True)
            ]
            self._state_publisher.publish(message)

    # -- subscriptions and services

    def _on_reference(self, message: Any) -> None:
        if self.chained:
            return
        for loop, values in zip(self._loops, self._ordered(message, "reference"), strict=False):
            if math.isfinite(values[0]):
                loop.reference = values

    def _on_measured(self, message: Any) -> None:
        for loop, state in zip(self._loops, self._ordered(message, "measured state"), strict=False):
            loop.measured = state

    def _on_feedforward(self, request: Any) -> Any:
        self._feedforward = bool(request.data)
        return message_class("std_srvs/srv/SetBool_Response")(success=True, message="")

    def _ordered(self, message: Any, what: str) -> list[tuple[float, float]]:
        """Returns values and their rates of change in the order of the joints; empty if invalid."""
        names = list(message.dof_names) or self._names
        values = [float(each) for each in message.values]
        rates = [float(each) for each in message.values_dot] or [math.nan] * len(names)
        fits = len(values) == len(rates) == len(names)
        if not fits or sorted(names) != sorted(self._names):
            self.warn(
                running.COMMAND_IGNORED,
                f"a {what} is ignored because it does not contain one value for each joint",
                hint=f"Joints of the controller: {', '.join(self._names)}.",
            )
            return []
        by_name = dict(zip(names, zip(values, rates, strict=True), strict=True))
        return [by_name[name] for name in self._names]


def _state_message(name: str, loop: PidLoop, seconds: float) -> Any:
    (reference, rate), (measured, speed) = loop.reference, loop.measured
    return message_class(_ONE_STATE)(
        name=name,
        reference=reference,
        feedback=measured,
        feedback_dot=speed,
        error=loop.error,
        error_dot=rate - speed,
        time_step=seconds,
        output=loop.output,
    )
