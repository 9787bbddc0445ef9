"""Gripper action controllers: a joint that moves until it reaches its goal or stalls."""

from __future__ import annotations

from typing import ClassVar, Literal

from cartwheel.devices.joints.gripper import Gripper, GripperConfig
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.gains import read_gains
from cartwheel.dialects.ros_control.settings import Settings


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

    def configure(self, settings: Settings) -> None:
        interface = "effort" if self.type.startswith("effort_") else "position"
        joint = self.claim(settings.text("joint"), interface)
        tolerance = settings.number("goal_tolerance", 0.01)
        max_effort = self.read_max_effort(settings)
        stall_velocity = settings.number("stall_velocity_threshold", 0.001)
        stall_timeout = settings.number("stall_timeout", 1.0)
        allow_stalling = settings.boolean("allow_stalling", False)
        gains: PidGains | None = None
        if interface == "effort":
            gains = read_gains(settings.section(f"gains/{joint.name}"))
            settings.ignore("gains")
        self._gripper = self.add(
            Gripper(
                self.scope,
                GripperConfig(
                    action=self.action,
                    tolerance=tolerance,
                    max_effort=max_effort,
                    stall_velocity=stall_velocity,
                    stall_timeout=stall_timeout,
                    allow_stalling=allow_stalling,
                    monitor_rate=settings.number("action_monitor_rate", 20.0),
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

    def read_max_effort(self, settings: Settings) -> float:
        """Returns the maximum effort of goals without an effort, N m or N."""
        return settings.number("max_effort", 0.0)

    def start(self, time_ns: int) -> None:
        self._gripper.start(time_ns)

    def update(self, time_ns: int, seconds: float) -> None:
        self._gripper.update(time_ns, seconds)

    def idle(self, time_ns: int) -> None:
        self._gripper.tick(time_ns)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._gripper.stop()


class ParallelGripperActionController(GripperActionController):
    """Like `GripperActionController`, with the action ``ParallelGripperCommand``.

    Its goals can limit the velocity as well. Source: parallel_gripper_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "parallel_gripper_action_controller/GripperActionController",
    )
    action = "ParallelGripperCommand"

    def configure(self, settings: Settings) -> None:
        settings.ignore("state_interfaces", "max_velocity", "max_velocity_interface")
        super().configure(settings)

    def read_max_effort(self, settings: Settings) -> float:
        effort = super().read_max_effort(settings)
        # Without this interface, the parameter max_effort has no effect.
        return effort if settings.text("max_effort_interface", "") else 0.0
