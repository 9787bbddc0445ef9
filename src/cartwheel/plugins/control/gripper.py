"""``gripper_action_controller``: a finger that closes on what is there."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from cartwheel.graph import Goal
from cartwheel.plugins.control.action import ActionServer
from cartwheel.plugins.control.controller import Controller, Rhythm
from cartwheel.plugins.control.pid import Gains, Pid
from cartwheel.plugins.control.settings import Settings


class GripperActionController(Controller):
    """Moves one joint by the action ``gripper_cmd``, with at most the goal's effort.

    A goal ends where the joint is within ``goal_tolerance``, or stalled: slower than
    ``stall_velocity_threshold`` for ``stall_timeout``. ROS 2's ``allow_stalling`` makes that a
    success. Source: gripper_action_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "position_controllers/GripperActionController",
        "effort_controllers/GripperActionController",
    )

    def configure(self, settings: Settings) -> None:
        interface = self.type.partition("_")[0]
        self._joint = self.claim(settings.text("joint"), interface)
        self._tolerance = settings.number("goal_tolerance", 0.01)
        self._effort = settings.number("max_effort", 0.0)
        self._slow = settings.number("stall_velocity_threshold", 0.001)
        self._patience_ns = round(settings.number("stall_timeout", 1.0) * 1e9)
        self._stalls_well = settings.boolean("allow_stalling", False)
        self._pid: Pid | None = None
        if interface == "effort":
            section = settings.section(f"gains/{self._joint.name}")
            self._pid = Pid(Gains.read(section))
            settings.ignore("gains")
        self._monitor = Rhythm(settings.number("action_monitor_rate", 20.0))
        self._target = 0.0
        self._limit = self._effort
        self._active: Goal | None = None
        self._moved_ns = 0
        self._action = ActionServer(
            self,
            "gripper_cmd",
            "GripperCommand",
            on_goal=self._on_goal,
            on_cancel=self._on_cancel,
        )

    def start(self, time_ns: int) -> None:
        self._finish("abort")
        self._target = self._joint.position
        self._limit = self._effort
        self._monitor.start(time_ns)
        self._action.start(time_ns)
        if self._pid is not None:
            self._pid.reset()

    def update(self, time_ns: int, seconds: float) -> None:
        joint = self._joint
        error = self._target - joint.position
        if self._pid is None:
            joint.command = self._target
            joint.strength = self._limit if self._limit > 0 else math.inf
        else:
            law = self._pid.position(error, seconds, target=self._target)
            effort = law.effort - law.damping * joint.velocity
            if 0 < self._limit < abs(effort):
                joint.set_effort(math.copysign(self._limit, effort))
            else:
                joint.set_effort(law.effort, damping=law.damping)
        self._action.tick(time_ns)
        if self._active is not None:
            self._watch(time_ns, error)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._joint.strength = math.inf
        self._finish("abort" if self.rig.ros2 else "cancel")

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
            goal.feedback(self._told("Feedback"))

    def _on_goal(self, goal: Goal) -> None:
        position = float(goal.goal.command.position)
        if not self.running or not math.isfinite(position):
            text = "the position is no number" if self.running else "the controller does not run"
            goal.reject(self._told("Result"), text)
            return
        self._finish("abort" if self.rig.ros2 else "cancel")
        self._active = goal
        self._target = position
        effort = float(goal.goal.command.max_effort)
        self._limit = effort if effort > 0 else self._effort
        self._moved_ns = self.part.time_ns
        goal.accept()

    def _on_cancel(self, goal: Goal) -> None:
        if goal is self._active:
            self._target = self._joint.position
            self._finish("cancel")
        else:
            goal.cancel(self._told("Result"))

    def _finish(self, how: str, *, reached: bool = False, stalled: bool = False) -> None:
        goal, self._active = self._active, None
        if goal is not None:
            getattr(goal, how)(self._told("Result", reached=reached, stalled=stalled))

    def _told(self, part: str, *, reached: bool = False, stalled: bool = False) -> Any:
        return self._action.message(
            part,
            position=self._joint.position,
            effort=self._joint.effort,
            stalled=stalled,
            reached_goal=reached,
        )
