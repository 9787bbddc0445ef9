"""A gripper: a joint that moves until it reaches its goal or stalls."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.action_server import ActionServer
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.devices.periodic import Periodic
from cartwheel.devices.ramp import ramp
from cartwheel.graph import Goal
from cartwheel.messages import header, message_class

Ending = Literal["succeed", "cancel", "abort"]


@dataclass(frozen=True, kw_only=True, slots=True)
class GripperConfig:
    action: Literal["GripperCommand", "ParallelGripperCommand"]
    """Type of the action. Goals of a ParallelGripperCommand can limit the velocity."""
    action_name: str = "gripper_cmd"
    """Name of the action."""
    tolerance: float
    """Largest distance in rad or m at which a goal is reached."""
    max_effort: float
    """Maximum effort of goals without an effort, N m or N; 0: not limited."""
    stall_velocity: float
    """Speed in rad/s or m/s below which the joint has stalled, after `stall_timeout`."""
    stall_timeout: float
    """s"""
    allow_stalling: bool
    """Whether goals of a stalled joint succeed instead of being aborted."""
    monitor_rate: float
    """Rate of the feedback, Hz."""
    preempted: Literal["cancel", "abort"]
    """How goals end that are replaced, or whose controller stops."""
    gains: PidGains | None = None
    """Gains of a PID controller that computes efforts. None: positions are commanded."""


class GripperJoint(Protocol):
    """What a `Gripper` moves: a `JointActuator`, or several of them."""

    command: float
    """Commanded position, rad or m."""
    strength: float
    """Maximum effort, N m or N."""

    @property
    def joint(self) -> str:
        """Name of the joint."""

    @property
    def position(self) -> float:
        """Position, rad or m."""

    @property
    def velocity(self) -> float:
        """Velocity, rad/s or m/s."""

    @property
    def effort(self) -> float:
        """Effort, N m or N."""

    @property
    def lightness(self) -> float:
        """Acceleration per effort, 1/(kg m²) or 1/kg."""

    def set_effort(self, effort: DampedEffort) -> None:
        """Commands an effort."""


class Gripper(Component):
    """Moves one joint by an action, with at most the goal's effort.

    Args:
        scope: Names of the action.
        config: Tolerances and limits.
        joint: The joint.
        name: Name of the joint in messages.
        running: Whether goals are accepted.
    """

    def __init__(
        self,
        scope: Scope,
        config: GripperConfig,
        *,
        joint: GripperJoint,
        name: str,
        running: Callable[[], bool],
    ) -> None:
        super().__init__(scope)
        self._config = config
        self._joint, self._name = joint, name
        self._running = running
        self._pid = Pid(config.gains) if config.gains is not None else None
        if self._pid is not None:
            self.part.tune(joint.joint, self._pid)
        self._stall_ns = round(config.stall_timeout * 1e9)
        self._monitor = Periodic(config.monitor_rate)
        self._target = self._position = 0.0
        """Goal, and the commanded position, which moves to it."""
        self._speed = math.inf
        """Speed of the commanded position, rad/s or m/s."""
        self._max_effort = config.max_effort
        self._active: Goal | None = None
        self._moved_ns = 0
        self._action = ActionServer(
            self,
            config.action_name,
            config.action,
            on_goal=self._on_goal,
            on_cancel=self._on_cancel,
        )

    def start(self, time_ns: int) -> None:
        """Holds the current position and aborts a goal of the time before."""
        self._finish("abort")
        self._target = self._position = self._joint.position
        self._max_effort = self._config.max_effort
        self._monitor.start(time_ns)
        self._action.start(time_ns)
        if self._pid is not None:
            self._pid.reset()

    def stop(self) -> None:
        """Ends the goal because the controller stops."""
        self._joint.strength = math.inf
        self._finish(self._config.preempted)

    def interrupt(self) -> None:
        """Ends the goal because the simulation was reset."""
        self._finish("abort", text="the world was reset")

    def tick(self, time_ns: int) -> None:
        """Publishes the status when due."""
        self._action.tick(time_ns)

    def move(self, wanted: Mapping[str, float]) -> None:
        """Moves to a manual position in rad or m, given by the joint's name."""
        self._finish(self._config.preempted)
        self._target, self._position = wanted[self._joint.joint], self._joint.position
        self._speed, self._max_effort = math.inf, self._config.max_effort

    def update(self, time_ns: int, seconds: float) -> None:
        """Commands the joint; `seconds` is the time since the last call."""
        joint, most = self._joint, self._max_effort
        error = self._target - joint.position
        self._position = ramp(self._position, self._target, self._speed * seconds)
        if self._pid is None:
            joint.command = self._position
            joint.strength = most if most > 0 else math.inf
        else:
            command = self._pid.position(
                error, seconds, target=self._target, lightness=joint.lightness
            )
            effort = command.at(joint.velocity)
            if 0 < most < abs(effort):
                command = DampedEffort(math.copysign(most, effort))
            joint.set_effort(command)
        self._action.tick(time_ns)
        if self._active is not None:
            self._watch(self._active, time_ns, error)

    def _watch(self, goal: Goal, time_ns: int, error: float) -> None:
        """Ends the goal when the joint reaches it or stalls, and publishes feedback."""
        config = self._config
        if abs(error) < config.tolerance:
            self._finish("succeed", reached=True)
            return
        if abs(self._joint.velocity) > config.stall_velocity:
            self._moved_ns = time_ns
        elif time_ns - self._moved_ns > self._stall_ns:
            self._finish("succeed" if config.allow_stalling else "abort", stalled=True)
            return
        if self._monitor.due(time_ns) and self._action.wants_feedback:
            goal.feedback(self._message("Feedback"))

    def _on_goal(self, goal: Goal) -> None:
        position, effort, speed = self._read(goal.goal.command)
        if not self._running() or not math.isfinite(position):
            text = "the controller is not running"
            if self._running():
                text = "the position is not a finite number"
            goal.reject(self._message("Result"), text)
            return
        self._finish(self._config.preempted)
        self._active = goal
        self._target, self._position = position, self._joint.position
        self._speed = speed
        self._max_effort = effort if effort > 0 else self._config.max_effort
        self._moved_ns = self.part.time_ns
        goal.accept()

    def _on_cancel(self, goal: Goal) -> None:
        if goal is self._active:
            self._target = self._position = self._joint.position
            self._finish("cancel")
        else:
            goal.cancel(self._message("Result"))

    def _read(self, command: Any) -> tuple[float, float, float]:
        """Returns position, maximum effort (0: the default) and maximum velocity of a goal."""
        if self._config.action == "GripperCommand":
            return float(command.position), float(command.max_effort), math.inf
        if len(command.position) != 1:
            return math.nan, 0.0, math.inf
        speed = float(command.velocity[0]) if len(command.velocity) else 0.0
        effort = float(command.effort[0]) if len(command.effort) else 0.0
        return float(command.position[0]), effort, speed if speed > 0 else math.inf

    def _finish(
        self, ending: Ending, *, reached: bool = False, stalled: bool = False, text: str = ""
    ) -> None:
        goal, self._active = self._active, None
        if goal is not None:
            getattr(goal, ending)(self._message("Result", reached=reached, stalled=stalled), text)

    def _message(self, part: str, *, reached: bool = False, stalled: bool = False) -> Any:
        """Returns a ``Result`` or ``Feedback`` message."""
        joint = self._joint
        if self._config.action == "GripperCommand":
            return self._action.message(
                part,
                position=joint.position,
                effort=joint.effort,
                stalled=stalled,
                reached_goal=reached,
            )
        state = message_class("sensor_msgs/msg/JointState")(
            header=header(self.part.time_ns, ""),
            name=[self._name],
            position=np.array([joint.position]),
            velocity=np.array([joint.velocity]),
            effort=np.array([joint.effort]),
        )
        if part == "Feedback":
            return self._action.message(part, state=state)
        return self._action.message(part, state=state, stalled=stalled, reached_goal=reached)
