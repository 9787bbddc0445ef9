"""Gripper action controllers: a joint that moves until it reaches its goal or stalls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from cartwheel.devices.joints.gripper import Gripper, GripperConfig
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.gains import GAINS, read_gains
from cartwheel.dialects.ros_control.parameters import OWN, ignored, parameter


@dataclass(frozen=True, kw_only=True, slots=True)
class GripperParameters:
    joint: str = parameter("joint", role="joint", interface=OWN, doc="Joint of the gripper.")
    tolerance: float = parameter(
        "goal_tolerance", default=0.01, unit="rad or m", doc="Position error of a reached goal."
    )
    max_effort: float = parameter(
        "max_effort",
        default=0.0,
        unit="N m or N",
        doc="Maximum effort of goals without an effort; 0 is the joint's limit.",
    )
    stall_velocity: float = parameter(
        "stall_velocity_threshold",
        default=0.001,
        unit="rad/s or m/s",
        doc="The joint stalls if it is slower.",
    )
    stall_timeout: float = parameter(
        "stall_timeout", default=1.0, unit="s", doc="The goal ends if the joint stalls this long."
    )
    allow_stalling: bool = parameter(
        "allow_stalling", default=False, doc="A goal succeeds when the joint stalls."
    )
    monitor_rate: float = parameter(
        "action_monitor_rate", default=20.0, unit="Hz", doc="Rate of the feedback."
    )
    gains: None = ignored("gains/{joint}", role="gains", doc=GAINS)


class GripperActionController(Controller):
    """Moves one joint by the action ``gripper_cmd``, with at most the goal's effort.

    A goal is reached when the joint is within ``goal_tolerance``. The joint has stalled when it is
    slower than ``stall_velocity_threshold`` for ``stall_timeout``: the goal is then aborted, or
    succeeds with ROS 2's ``allow_stalling``. Source: gripper_action_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "position_controllers/GripperActionController",
        "effort_controllers/GripperActionController",
    )
    action: ClassVar[Literal["GripperCommand", "ParallelGripperCommand"]] = "GripperCommand"

    parameters: ClassVar[type] = GripperParameters

    def configure(self, given: GripperParameters) -> None:
        settings = self.settings
        interface = "effort" if self.type.startswith("effort_") else "position"
        joint = self.claim(given.joint, interface)
        gains: PidGains | None = None
        if interface == "effort":
            gains = read_gains(settings.section(f"gains/{joint.name}"))
            settings.ignore("gains")
        self._gripper = self.add(
            Gripper(
                self.scope,
                GripperConfig(
                    action=self.action,
                    tolerance=given.tolerance,
                    max_effort=self.max_effort(given),
                    stall_velocity=given.stall_velocity,
                    stall_timeout=given.stall_timeout,
                    allow_stalling=given.allow_stalling,
                    monitor_rate=given.monitor_rate,
                    # In ROS 2, only clients cancel goals.
                    preempted="abort" if self.robot.ros2 else "cancel",
                    gains=gains,
                ),
                joint=joint,
                name=joint.name,
                running=lambda: self.running,
            )
        )
        self.accept_positions(lambda wanted, _: self._gripper.move(wanted))

    def max_effort(self, given: Any) -> float:
        """Returns the maximum effort of goals without an effort, N m or N."""
        effort: float = given.max_effort
        return effort

    def start(self, time_ns: int) -> None:
        self._gripper.start(time_ns)

    def interrupt(self) -> None:
        self._gripper.interrupt()

    def update(self, time_ns: int, seconds: float) -> None:
        self._gripper.update(time_ns, seconds)

    def idle(self, time_ns: int) -> None:
        self._gripper.tick(time_ns)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._gripper.stop()


@dataclass(frozen=True, kw_only=True, slots=True)
class ParallelGripperParameters(GripperParameters):
    effort_interface: str = parameter(
        "max_effort_interface",
        default="",
        doc="Without this interface, `max_effort` has no effect.",
    )
    unused: None = ignored("state_interfaces", "max_velocity", "max_velocity_interface")


class ParallelGripperActionController(GripperActionController):
    """Like `GripperActionController`, with the action ``ParallelGripperCommand``.

    Its goals can limit the velocity as well. Source: parallel_gripper_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "parallel_gripper_action_controller/GripperActionController",
    )
    action = "ParallelGripperCommand"

    parameters = ParallelGripperParameters

    def max_effort(self, given: ParallelGripperParameters) -> float:
        return given.max_effort if given.effort_interface else 0.0
