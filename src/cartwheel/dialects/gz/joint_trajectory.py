"""``gz-sim-joint-trajectory-controller-system``: joints that follow a trajectory's points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.gz.joint_controller import GzPid
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.messages import header, message_class, zero
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import FARTHEST

_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
_KINDS = ("position", "velocity")


def _gains(kind: str, name: str, doc: str) -> Any:
    limit = name.endswith(("_min", "_max"))
    return tag(
        f"{kind}_{name}",
        default=(),
        unit="N m or N" if limit or name == "cmd_offset" else "",
        doc=f"{doc} {kind} controller, for each joint. Default: {'no limit' if limit else '`0`'}.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointTrajectoryParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the JointTrajectory messages. Default: `/model/<model>/joint_trajectory`.",
    )
    header_start: bool = tag(
        "use_header_start_time",
        default=False,
        doc="Start trajectories at their header stamp instead of on arrival.",
    )
    joints: tuple[str, ...] = tag(
        "joint_name",
        default=(),
        doc="Joint to control. Repeat the tag for each joint. Default: all single-axis joints.",
    )
    initial: tuple[float, ...] = tag(
        "initial_position",
        default=(),
        unit="rad or m",
        most=FARTHEST,
        doc="Initial target of each joint. Default: `0`.",
    )
    position_p_gain: tuple[float, ...] = _gains("position", "p_gain", "Proportional gain of the")
    position_i_gain: tuple[float, ...] = _gains("position", "i_gain", "Integral gain of the")
    position_d_gain: tuple[float, ...] = _gains("position", "d_gain", "Derivative gain of the")
    position_i_min: tuple[float, ...] = _gains(
        "position", "i_min", "Lower limit of the integral term of the"
    )
    position_i_max: tuple[float, ...] = _gains(
        "position", "i_max", "Upper limit of the integral term of the"
    )
    position_cmd_min: tuple[float, ...] = _gains("position", "cmd_min", "Lower force limit of the")
    position_cmd_max: tuple[float, ...] = _gains("position", "cmd_max", "Upper force limit of the")
    position_cmd_offset: tuple[float, ...] = _gains(
        "position", "cmd_offset", "Constant force added by the"
    )
    velocity_p_gain: tuple[float, ...] = _gains("velocity", "p_gain", "Proportional gain of the")
    velocity_i_gain: tuple[float, ...] = _gains("velocity", "i_gain", "Integral gain of the")
    velocity_d_gain: tuple[float, ...] = _gains(
        "velocity", "d_gain", "No effect: derivative gain of the"
    )
    velocity_i_min: tuple[float, ...] = _gains(
        "velocity", "i_min", "Lower limit of the integral term of the"
    )
    velocity_i_max: tuple[float, ...] = _gains(
        "velocity", "i_max", "Upper limit of the integral term of the"
    )
    velocity_cmd_min: tuple[float, ...] = _gains("velocity", "cmd_min", "Lower force limit of the")
    velocity_cmd_max: tuple[float, ...] = _gains("velocity", "cmd_max", "Upper force limit of the")
    velocity_cmd_offset: tuple[float, ...] = _gains(
        "velocity", "cmd_offset", "Constant force added by the"
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Gains:
    """Gains of one PID controller. Limits whose minimum exceeds the maximum are not applied."""

    p: float
    i: float
    d: float
    i_min: float
    i_max: float
    cmd_min: float
    cmd_max: float
    cmd_offset: float


@dataclass(kw_only=True, slots=True)
class _Target:
    position: float
    velocity: float = 0.0
    effort: float = 0.0


class GzJointTrajectory(Plugin[JointTrajectoryParameters]):
    """Drives joints to the points of a trajectory, one after the other.

    Each point is the target until its ``time_from_start`` has passed. Points are not interpolated,
    so smooth motion needs closely spaced points. The force on a joint is the sum of the position
    controller's output, the velocity controller's output and the point's effort. The progress,
    published on ``<topic>_progress`` (Float32), is the number of the current point divided by the
    total number of points. Original plugin: ``JointTrajectoryController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-trajectory-controller-system",)
    parameters: ClassVar[type] = JointTrajectoryParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        names = [name.strip() for name in config.joints] or [
            joint.name
            for joint in part.description.joints
            if joint.type in ("revolute", "continuous", "prismatic")
        ]
        if not names:
            raise PluginError(
                "the model has no single-axis joint, so it cannot follow a trajectory",
                code=devices.PLUGIN_IDLE,
                origin=origin,
            )
        self._joints = {name: part.joint(name, origin=origin) for name in names}
        self._servos = {name: part.servo(name, max_effort=None, origin=origin) for name in names}
        self._gains = {
            name: [self._read(kind, index) for kind in _KINDS] for index, name in enumerate(names)
        }
        if not any(gains.p or gains.i for both in self._gains.values() for gains in both):
            self.warn(
                devices.PLUGIN_IDLE,
                "all gains are 0, so only the efforts in a trajectory have an effect",
            )
        self._initial = {
            name: config.initial[index] if index < len(config.initial) else 0.0
            for index, name in enumerate(names)
        }
        topic = gz_name(self, config.topic, "joint_trajectory")
        self.subscribe(topic, _TRAJECTORY, self._on_trajectory)
        self.take_positions(names, lambda wanted, _: self._put(topic, wanted))
        self._Float = message_class("std_msgs/msg/Float32")
        self._progress = self.advertise(f"{topic}_progress", "std_msgs/msg/Float32")
        self.reset()
        part.schedule(0, before=self._follow)

    def reset(self) -> None:
        self._targets = {name: _Target(position=at) for name, at in self._initial.items()}
        self._pids = {name: [GzPid(each) for each in both] for name, both in self._gains.items()}
        self._names: list[str] = []
        self._points: list[Any] = []
        self._index = 0
        self._start_ns = 0
        self._before_ns: int | None = None

    def _read(self, kind: str, index: int) -> _Gains:
        """Returns the gains for a joint by its index; missing values are 0."""

        def number(name: str, default: float = 0.0) -> float:
            numbers: tuple[float, ...] = getattr(self.config, f"{kind}_{name}")
            return numbers[index] if index < len(numbers) else default

        bounds = {}
        for name in ("i", "cmd"):
            low, high = number(f"{name}_min"), number(f"{name}_max", -1.0)
            bounds[name] = (low, high) if low <= high else (-math.inf, math.inf)
        return _Gains(
            p=number("p_gain"),
            i=number("i_gain"),
            d=number("d_gain"),
            i_min=bounds["i"][0],
            i_max=bounds["i"][1],
            cmd_min=bounds["cmd"][0],
            cmd_max=bounds["cmd"][1],
            cmd_offset=number("cmd_offset"),
        )

    def _on_trajectory(self, message: Any) -> None:
        names = list(message.joint_names)
        known = [name for name in names if name in self._joints]
        if not known:
            self.warn(
                running.TRAJECTORY_INVALID,
                "a trajectory is ignored: it contains no joint of the model",
                hint=f"Valid names: {', '.join(self._joints)}.",
                values={"fault": "joints"},
            )
            return
        for point in message.points:
            for what in ("positions", "velocities", "effort"):
                values = getattr(point, what)
                if len(values) not in (0, len(names)):
                    self.warn(
                        running.TRAJECTORY_INVALID,
                        f"a trajectory is ignored because a point has {len(values)} {what} for "
                        f"{len(names)} joints",
                        values={"fault": what},
                    )
                    return
        self._names, self._points, self._index = names, list(message.points), 0
        self._start_ns = self.part.time_ns
        if self.config.header_start:
            stamp = message.header.stamp
            self._start_ns = stamp.sec * NANOSECONDS + stamp.nanosec
        if self._points:
            self._aim()

    def _put(self, topic: str, wanted: Mapping[str, float]) -> None:
        point = zero("trajectory_msgs/msg/JointTrajectoryPoint")
        point.positions = np.array(list(wanted.values()))
        message = message_class(_TRAJECTORY)(
            header=header(0, ""), joint_names=list(wanted), points=[point]
        )
        self.graph.publish(self.resolve(topic), _TRAJECTORY, message)

    def _aim(self) -> None:
        """Sets the targets from the current point."""
        point = self._points[self._index]
        for number, name in enumerate(self._names):
            target = self._targets.get(name)
            if target is None:
                continue
            if len(point.positions):
                target.position = float(point.positions[number])
            if len(point.velocities):
                target.velocity = float(point.velocities[number])
            if len(point.effort):
                target.effort = float(point.effort[number])
        if self._progress.wanted:
            self._progress.publish(self._Float((self._index + 1) / len(self._points)))

    def _follow(self) -> None:
        now = self.part.time_ns
        before = self._index
        while self._index + 1 < len(self._points):
            due = self._points[self._index].time_from_start
            if due.sec * NANOSECONDS + due.nanosec >= now - self._start_ns:
                break
            self._index += 1
        if self._index != before:
            self._aim()
        seconds = 0.0 if self._before_ns is None else (now - self._before_ns) * 1e-9
        self._before_ns = now
        for name, target in self._targets.items():
            self._drive(name, target, seconds)

    def _drive(self, name: str, target: _Target, seconds: float) -> None:
        joint, (position, velocity) = self._joints[name], self._pids[name]
        gains = self._gains[name]
        effort = target.effort + position.force(target.position - joint.position, seconds)
        damping = gains[0].d
        if math.isinf(gains[1].cmd_max):
            # A velocity gain acts as damping, which the servo applies without delay.
            damping += gains[1].p
            slowed = gains[1].p * joint.velocity
            effort += velocity.force(target.velocity - joint.velocity, seconds) + slowed
        else:
            effort += velocity.force(target.velocity - joint.velocity, seconds)
        self._servos[name].command_effort(effort, damping=damping)
