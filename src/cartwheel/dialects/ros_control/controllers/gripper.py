"""Gripper action controllers: a joint that moves until it reaches its goal or stalls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from cartwheel.devices.action_server import ActionServer
from cartwheel.devices.joints.pid import DampedEffort, Pid
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.gains import read_gains
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.graph import Goal
from cartwheel.messages import header, message_class


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
    action: ClassVar[str] = "GripperCommand"

    def configure(self, settings: Settings) -> None:
        interface = "effort" if self.type.startswith("effort_") else "position"
        self._joint = self.claim(settings.text("joint"), interface)
        self._tolerance = settings.number("goal_tolerance", 0.01)
        self._effort = settings.number("max_effort", 0.0)
        self._slow = settings.number("stall_velocity_threshold", 0.001)
        self._patience_ns = round(settings.number("stall_timeout", 1.0) * 1e9)
        self._stalls_well = settings.boolean("allow_stalling", False)
        self._pid: Pid | None = None
        if interface == "effort":
            section = settings.section(f"gains/{self._joint.name}")
            self._pid = Pid(read_gains(section))
            settings.ignore("gains")
        self._monitor = Periodic(settings.number("action_monitor_rate", 20.0))
        self._target = self._place = 0.0
        self._speed = math.inf
        """Speed in rad/s or m/s at which `_place` moves to `_target`."""
        self._limit = self._effort
        self._active: Goal | None = None
        self._moved_ns = 0
        self._action = ActionServer(
            self,
            "gripper_cmd",
            self.action,
            on_goal=self._on_goal,
            on_cancel=self._on_cancel,
        )
        self.accept_positions(lambda wanted, _: self._put(wanted))

    def start(self, time_ns: int) -> None:
        self._finish("abort")
        self._target = self._place = self._joint.position
        self._limit = self._effort
        self._monitor.start(time_ns)
        self._action.start(time_ns)
        if self._pid is not None:
            self._pid.reset()

    def update(self, time_ns: int, seconds: float) -> None:
        joint = self._joint
        error = self._target - joint.position
        most = self._speed * seconds
        self._place += min(max(self._target - self._place, -most), most)
        if self._pid is None:
            joint.command = self._place
            joint.strength = self._limit if self._limit > 0 else math.inf
        else:
            command = self._pid.position(
                error, seconds, target=self._target, lightness=joint.lightness
            )
            effort = command.at(joint.velocity)
            if 0 < self._limit < abs(effort):
                joint.set_effort(DampedEffort(math.copysign(self._limit, effort)))
            else:
                joint.set_effort(command)
        self._action.tick(time_ns)
        if self._active is not None:
            self._watch(time_ns, error)

    def idle(self, time_ns: int) -> None:
        self._action.tick(time_ns)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._joint.strength = math.inf
        self._finish("abort" if self.robot.ros2 else "cancel")

    def _watch(self, time_ns: int, error: float) -> None:
        goal = self._active
        assert goal is not None
        if abs(error) < self._tolerance:
            self._finish("succeed", reached=True)
            return
        if abs(self._joint.velocity) > self._slow:
            self._moved_ns = time_ns
        elif time_ns - self._moved_ns > self._patience_ns:
            self._finish("succeed" if self._stalls_well else "abort", stalled=True)
            return
        if self._monitor.due(time_ns) and self._action.wants_feedback:
            goal.feedback(self._message("Feedback"))

    def _on_goal(self, goal: Goal) -> None:
        position, effort, speed = self._limits(goal.goal.command)
        if not self.running or not math.isfinite(position):
            text = "the controller is not running"
            if self.running:
                text = "the position is not a finite number"
            goal.reject(self._message("Result"), text)
            return
        self._finish("abort" if self.robot.ros2 else "cancel")
        self._active = goal
        self._target, self._place = position, self._joint.position
        self._speed = speed
        self._limit = effort if effort > 0 else self._effort
        self._moved_ns = self.part.time_ns
        goal.accept()

    def _put(self, wanted: Mapping[str, float]) -> None:
        self._finish("abort" if self.robot.ros2 else "cancel")
        self._target, self._place = wanted[self._joint.joint], self._joint.position
        self._speed, self._limit = math.inf, self._effort

    def _on_cancel(self, goal: Goal) -> None:
        if goal is self._active:
            self._target = self._place = self._joint.position
            self._finish("cancel")
        else:
            goal.cancel(self._message("Result"))

    def _limits(self, command: Any) -> tuple[float, float, float]:
        """Returns position, maximum effort (0: the controller's) and maximum velocity of a goal."""
        return float(command.position), float(command.max_effort), math.inf

    def _finish(self, how: str, *, reached: bool = False, stalled: bool = False) -> None:
        goal, self._active = self._active, None
        if goal is not None:
            getattr(goal, how)(self._message("Result", reached=reached, stalled=stalled))

    def _message(self, part: str, *, reached: bool = False, stalled: bool = False) -> Any:
        return self._action.message(
            part,
            position=self._joint.position,
            effort=self._joint.effort,
            stalled=stalled,
            reached_goal=reached,
        )


class ParallelGripperActionController(GripperActionController):
    """Like `GripperActionController`, with the action ``ParallelGripperCommand``.

    Its goals can limit the velocity as well. Source: parallel_gripper_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "parallel_gripper_action_controller/GripperActionController",
    )
    action: ClassVar[str] = "ParallelGripperCommand"

    def configure(self, settings: Settings) -> None:
        settings.ignore("state_interfaces", "max_velocity", "max_velocity_interface")
        super().configure(settings)
        if not settings.text("max_effort_interface", ""):
            # Without this interface, the parameter max_effort has no effect.
            self._effort = self._limit = 0.0

    def _limits(self, command: Any) -> tuple[float, float, float]:
        if len(command.position) != 1:
            return math.nan, 0.0, math.inf
        speed = float(command.velocity[0]) if len(command.velocity) else 0.0
        effort = float(command.effort[0]) if len(command.effort) else 0.0
        return float(command.position[0]), effort, speed if speed > 0 else math.inf

    def _message(self, part: str, *, reached: bool = False, stalled: bool = False) -> Any:
        joint = self._joint
        state = message_class("sensor_msgs/msg/JointState")(
            header=header(self.part.time_ns, ""),
            name=[joint.name],
            position=np.array([joint.position]),
            velocity=np.array([joint.velocity]),
            effort=np.array([joint.effort]),
        )
        if part == "Feedback":
            return self._action.message(part, state=state)
        return self._action.message(part, state=state, stalled=stalled, reached_goal=reached)
