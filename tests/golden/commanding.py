"""The commands that each robot gets, the same in each run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .adapter import (
    CartwheelError,
    World,
    command_joints,
    joint_inputs,
    message_class,
    now_ns,
    zero,
)
from .plain import error

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
PERIOD = 0.05
"""Interval of velocity commands, s."""
_OURS = "golden"


class Commands:
    """Commands a world by simulation time. Refused commands are recorded."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._done: set[str] = set()
        self.refused: list[dict[str, Any]] = []
        self.given: list[str] = []

    def give(self, time: float) -> None:
        """Gives the commands that are due, at every `PERIOD`."""
        if time >= 0.5:
            self._drive(velocity(time))
        for name, due, act in (
            ("joints", 0.5, lambda: self._joints(0.1)),
            ("topics", 1.5, lambda: self._topics(0.1)),
            ("actions", 2.5, self._actions),
            ("joints back", 3.5, lambda: self._joints(-0.05)),
            ("topics back", 4.0, lambda: self._topics(-0.05)),
        ):
            if time >= due and name not in self._done:
                self._done.add(name)
                act()

    def _try(self, what: str, act: Callable[[], Any]) -> None:
        if what not in self.given:
            self.given.append(what)
        try:
            act()
        except CartwheelError as refused:
            self.refused.append({"command": what, **error(refused)})

    def _drive(self, speeds: tuple[float, float, float]) -> None:
        x, y, yaw = speeds
        twist = {"linear": {"x": x, "y": y}, "angular": {"z": yaw}}
        for topic in self._world.graph.topics():
            if topic.type not in (TWIST, STAMPED) or not _others(topic.subscribers):
                continue
            said: dict[str, Any] = twist
            if topic.type == STAMPED:
                seconds, rest = divmod(now_ns(self._world), 1_000_000_000)
                said = {"header": {"stamp": {"sec": seconds, "nanosec": rest}}, "twist": twist}
            self._try(f"drive {topic.name}", lambda t=topic.name, s=said: self._publish(t, s))

    def _publish(self, topic: str, message: Any) -> None:
        self._world.publish(topic, message)

    def _joints(self, step: float) -> None:
        for owner, joints, handle in joint_inputs(self._world):
            targets = {joint: self._position(joint) + step for joint in joints}
            self._try(f"joints of {owner}", lambda h=handle, t=targets: command_joints(h, t, 1.0))

    def _topics(self, value: float) -> None:
        """Publishes on each topic that only the robot reads."""
        for topic in self._world.graph.topics():
            leave = topic.type in (TWIST, STAMPED) or "/action" in topic.type
            leave = leave or topic.type.startswith("actionlib_msgs/") or "Action" in topic.type
            if leave or topic.publishers or not _others(topic.subscribers):
                continue
            message = self._filled(topic.name, topic.type, value)
            self._try(f"publish {topic.name}", lambda t=topic.name, m=message: self._publish(t, m))

    def _actions(self) -> None:
        for action in self._world.graph.actions():
            goal = zero(f"{action.type}_Goal")
            joints = self._joints_of(action.name)
            if hasattr(goal, "trajectory"):
                goal.trajectory = self._trajectory(type(goal.trajectory), joints, 0.15)
            elif hasattr(goal, "command"):
                fill(goal.command, 0.03)
                if hasattr(goal.command, "name"):
                    goal.command.name = list(joints)
                    goal.command.position = np.full(len(joints), 0.03)
                    goal.command.effort = np.full(len(joints), 5.0)
                    goal.command.velocity = np.zeros(0)
                if hasattr(goal.command, "max_effort"):
                    goal.command.max_effort = 5.0
            self._try(f"action {action.name}", lambda a=action, g=goal: a.submit(g))

    def _filled(self, topic: str, kind: str, value: float) -> Any:
        joints = self._joints_of(topic)
        if kind == TRAJECTORY:
            return self._trajectory(message_class(kind), joints, value)
        message = zero(kind)
        fill(message, value)
        if kind == "std_msgs/msg/Float64MultiArray":
            inputs = [each for owner, each, _ in joint_inputs(self._world) if owner in topic]
            message.data = np.full(len(inputs[0]) if inputs else 1, value)
        return message

    def _trajectory(self, kind: Any, joints: tuple[str, ...], step: float) -> Any:
        trajectory = zero(kind.__msgtype__)
        trajectory.joint_names = list(joints)
        points = []
        for seconds, part in ((0, 0.5), (1, 1.0)):
            point = zero("trajectory_msgs/msg/JointTrajectoryPoint")
            point.positions = np.array([self._position(each) + part * step for each in joints])
            point.time_from_start.sec = seconds
            point.time_from_start.nanosec = 500_000_000
            points.append(point)
        trajectory.points = points
        return trajectory

    def _joints_of(self, name: str) -> tuple[str, ...]:
        """The joints of the input whose owner is in a topic's name; of all if there is none."""
        inputs = joint_inputs(self._world)
        for owner, joints, _ in inputs:
            if owner in name.split("/"):
                return joints
        return tuple(dict.fromkeys(joint for _, joints, _ in inputs for joint in joints))

    def _position(self, joint: str) -> float:
        for model in self._world.models:
            try:
                return self._world.model(model).joint(joint)
            except CartwheelError:
                continue
        return 0.0


def velocity(time: float) -> tuple[float, float, float]:
    """Forward and sideways speed in m/s and turn rate in rad/s that is commanded at a time."""
    for end, speeds in (
        (1.75, (0.2, 0.0, 0.0)),
        (2.75, (0.15, 0.0, 0.4)),
        (3.75, (-0.1, 0.05, -0.3)),
        (4.25, (0.0, 0.0, 0.5)),
    ):
        if time < end:
            return speeds
    return (0.0, 0.0, 0.0)


def fill(message: Any, value: float) -> None:
    """Sets the numbers of a message, except for its header."""
    for name in message.__annotations__:
        given = getattr(message, name)
        if name in ("__msgtype__", "header", "layout"):
            continue
        if isinstance(given, bool):
            setattr(message, name, value > 0)
        elif isinstance(given, float):
            setattr(message, name, value)
        elif isinstance(given, int):
            setattr(message, name, 1 if value > 0 else 0)
        elif isinstance(given, str):
            setattr(message, name, "1" if value > 0 else "0")
        elif isinstance(given, np.ndarray) and not given.size and given.dtype.kind == "f":
            setattr(message, name, np.full(1, value, dtype=given.dtype))
        elif hasattr(given, "__msgtype__"):
            fill(given, value)


def _others(subscribers: tuple[str, ...]) -> bool:
    return any(each != _OURS for each in subscribers)
