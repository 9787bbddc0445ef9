"""gz-sim's controllers for single joints: position, velocity or force."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from cartwheel.codes import devices
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import missing, tag
from cartwheel.errors import PluginError
from cartwheel.messages import message_class
from cartwheel.simulation.limits import FARTHEST

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True, slots=True)
class _Gains:
    p: float = tag("p_gain", default=1.0, doc="Proportional gain.")
    i: float = tag("i_gain", default=0.0, doc="Integral gain.")
    d: float = tag("d_gain", default=0.0, doc="Derivative gain, which damps the joint.")
    i_max: float = tag("i_max", default=1.0, unit="N m or N", doc="Maximum of the integral term.")
    i_min: float = tag("i_min", default=-1.0, unit="N m or N", doc="Minimum of the integral term.")
    cmd_max: float = tag("cmd_max", default=1000.0, unit="N m or N", doc="Maximum output.")
    cmd_min: float = tag("cmd_min", default=-1000.0, unit="N m or N", doc="Minimum output.")
    cmd_offset: float = tag(
        "cmd_offset", default=0.0, unit="N m or N", doc="Constant added to the output."
    )
    actuators: bool = tag(
        "use_actuator_msg", default=False, doc="No effect: the joint is driven by Float64 messages."
    )
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the target (Float64). Default: `/model/<model>/joint/<joint>/cmd_pos`.",
    )
    sub_topic: str = tag(
        "sub_topic",
        default="",
        doc="Topic relative to `/model/<model>`. Used if `<topic>` is not set.",
    )
    joints: tuple[str, ...] = tag(
        "joint_name",
        doc="Joint to control. Repeat the tag to move several joints to the same target.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointPositionParameters(_Gains):
    i: float = tag("i_gain", default=0.1, doc="Integral gain.")
    d: float = tag("d_gain", default=0.01, doc="Derivative gain, which damps the joint.")
    index: float = tag(
        "joint_index", default=0.0, doc="Axis of the joint. Only 0, the first axis, is supported."
    )
    velocity: bool = tag(
        "use_velocity_commands",
        default=False,
        doc="Move to the target with a velocity of at most `<cmd_max>`, regardless of the "
        "load. The PID gains then have no effect.",
    )
    initial: float = tag(
        "initial_position", default=0.0, unit="rad or m", most=FARTHEST, doc="Initial target."
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointVelocityParameters(_Gains):
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the target (Float64). Default: `/model/<model>/joint/<joint>/cmd_vel`.",
    )
    force: bool = tag(
        "use_force_commands",
        default=False,
        doc="Control the velocity with the PID controller instead of a velocity servo.",
    )
    initial: float = tag(
        "initial_velocity", default=0.0, unit="rad/s or m/s", most=FARTHEST, doc="Initial target."
    )


class PidGains(Protocol):
    """Parameters of a `GzPid`. Limits can be infinite."""

    @property
    def p(self) -> float: ...
    @property
    def i(self) -> float: ...
    @property
    def i_max(self) -> float: ...
    @property
    def i_min(self) -> float: ...
    @property
    def cmd_max(self) -> float: ...
    @property
    def cmd_min(self) -> float: ...
    @property
    def cmd_offset(self) -> float: ...


class GzPid:
    """A PI controller with a limited integral, whose output is a force."""

    def __init__(self, gains: PidGains) -> None:
        self._gains = gains
        self._integral = 0.0

    def force(self, error: float, seconds: float) -> float:
        """Returns the force in N m or N. The derivative gain acts as the servo's damping."""
        gains = self._gains
        if gains.i:
            self._integral += gains.i * error * seconds
            self._integral = min(max(self._integral, gains.i_min), gains.i_max)
        force = gains.p * error + self._integral + gains.cmd_offset
        return min(max(force, gains.cmd_min), gains.cmd_max)


class _JointController(Plugin[Any]):
    """Base class of controllers with a target from a topic, which they follow at each step."""

    def configure(self) -> None:
        config: _Gains = self.config
        part, origin = self.part, self.tag.origin
        if not config.joints:
            raise missing("plugin", "joint_name", origin)
        for what, low, high in (
            ("cmd", config.cmd_min, config.cmd_max),
            ("i", config.i_min, config.i_max),
        ):
            if low > high:
                raise PluginError(
                    f"<{what}_min> must not exceed <{what}_max> (got {low:g} and {high:g})",
                    code=devices.PLUGIN_RANGE_REVERSED,
                    origin=self.place_of(f"{what}_min"),
                    values={"parameter": f"{what}_min", "value": low, "most": high},
                )
        if config.actuators:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<use_actuator_msg> has no effect: the joint is driven by Float64 messages",
                values={"parameter": "use_actuator_msg"},
            )
        names = [name.strip() for name in config.joints]
        self._joints = [
            (part.joint(name, origin=origin), part.servo(name, max_effort=None, origin=origin))
            for name in names
        ]
        topic = config.topic
        if not topic and config.sub_topic:
            topic = f"/model/{part.name}/{config.sub_topic.strip().lstrip('/')}"
        topic = topic or f"/model/{part.name}/joint/{names[0]}/{self._default_topic()}"
        # Gazebo's topic contains the axis, as in /0/cmd_pos, which is not a valid name in ROS.
        topic = re.sub(r"/\d+(?=/)", "", topic)
        self._topic = gz_name(self, topic, "")
        self.subscribe(self._topic, _FLOAT, self._on_command)
        self.reset()
        part.schedule(0, before=self._follow)

    def reset(self) -> None:
        self._target = float(self.config.initial)
        self._pids = [GzPid(self.config) for _ in self._joints]
        self._before_ns: int | None = None

    def _default_topic(self) -> str:
        raise NotImplementedError

    def _on_command(self, message: Any) -> None:
        self._target = float(message.data)

    def _seconds(self) -> float:
        """Returns the time since the previous step, s."""
        now = self.part.time_ns
        seconds = 0.0 if self._before_ns is None else (now - self._before_ns) * 1e-9
        self._before_ns = now
        return seconds

    def _follow(self) -> None:
        raise NotImplementedError


class JointPositionController(_JointController):
    """Moves a joint to the last commanded position and holds it there.

    Until the first command, the target is ``<initial_position>``. Original plugin:
    ``JointPositionController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-position-controller-system",)
    parameters: ClassVar[type] = JointPositionParameters

    def configure(self) -> None:
        super().configure()
        # Joints with the same target share one input.
        self.take_positions([self._joints[0][0].name], self._put)

    def _put(self, wanted: Mapping[str, float], seconds: float) -> None:  # noqa: ARG002
        (value,) = wanted.values()
        message = message_class(_FLOAT)(data=float(value))
        self.graph.publish(self.resolve(self._topic), _FLOAT, message)

    def _default_topic(self) -> str:
        if self.config.index:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<joint_index> has no effect: only the first axis of a joint is moved",
                values={"parameter": "joint_index"},
            )
        return "cmd_pos"

    def _follow(self) -> None:
        config: JointPositionParameters = self.config
        seconds = self._seconds()
        for (joint, servo), pid in zip(self._joints, self._pids, strict=True):
            if config.velocity:
                servo.command_position(self._target, max_velocity=abs(config.cmd_max))
            else:
                force = pid.force(self._target - joint.position, seconds)
                servo.command_effort(force, damping=config.d)


class JointController(_JointController):
    """Holds a joint at the last commanded velocity.

    Until the first command, the target is ``<initial_velocity>``. Original plugin:
    ``JointController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-controller-system",)
    parameters: ClassVar[type] = JointVelocityParameters

    def _default_topic(self) -> str:
        return "cmd_vel"

    def _follow(self) -> None:
        config: JointVelocityParameters = self.config
        seconds = self._seconds()
        for (joint, servo), pid in zip(self._joints, self._pids, strict=True):
            if config.force:
                servo.command_effort(pid.force(self._target - joint.velocity, seconds))
            else:
                servo.command_velocity(self._target)


@dataclass(frozen=True, kw_only=True, slots=True)
class ApplyJointForceParameters:
    joint: str = tag("joint_name", doc="Joint on which the force acts.")


class ApplyJointForce(Plugin[ApplyJointForceParameters]):
    """Applies the last commanded force or torque to a joint.

    The command is a torque in N m for a revolute joint, and a force in N for a prismatic joint. The
    topic (Float64) is ``/model/<model>/joint/<joint>/cmd_force``. Original plugin:
    ``ApplyJointForce`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-apply-joint-force-system",)
    parameters: ClassVar[type] = ApplyJointForceParameters

    def configure(self) -> None:
        name = self.config.joint.strip()
        self._servo = self.part.servo(name, max_effort=None, origin=self.tag.origin)
        topic = f"/model/{self.part.name}/joint/{name}/cmd_force"
        self.subscribe(topic, "std_msgs/msg/Float64", self._on_command)

    def reset(self) -> None:
        self._servo.release()

    def _on_command(self, message: Any) -> None:
        self._servo.command_effort(float(message.data))
