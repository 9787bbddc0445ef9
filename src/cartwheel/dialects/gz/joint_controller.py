"""gz-sim's controllers for single joints: position, velocity or force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from cartwheel.codes import devices
from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.servos import (
    JointForce,
    JointForceConfig,
    JointServos,
    JointServosConfig,
)
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import missing, tag
from cartwheel.errors import PluginError
from cartwheel.simulation.limits import FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class ServoParameters:
    p: float = tag("p_gain", default=1.0, doc="Proportional gain of the PID controller.")
    i: float = tag("i_gain", default=0.0, doc="Integral gain of the PID controller.")
    d: float = tag(
        "d_gain",
        default=0.0,
        doc="Derivative gain of the PID controller. It is applied as damping of the joint.",
    )
    i_max: float = tag(
        "i_max", default=1.0, unit="N m or N", doc="Maximum of the PID controller's integral term."
    )
    i_min: float = tag(
        "i_min", default=-1.0, unit="N m or N", doc="Minimum of the PID controller's integral term."
    )
    cmd_max: float = tag(
        "cmd_max", default=1000.0, unit="N m or N", doc="Maximum output of the PID controller."
    )
    cmd_min: float = tag(
        "cmd_min", default=-1000.0, unit="N m or N", doc="Minimum output of the PID controller."
    )
    cmd_offset: float = tag(
        "cmd_offset",
        default=0.0,
        unit="N m or N",
        doc="Constant that is added to the output of the PID controller.",
    )
    actuators: bool = tag(
        "use_actuator_msg",
        default=False,
        doc="Whether the type of the topic is Actuators instead of Float64. It has no effect "
        "without `<actuator_number>`.",
    )
    actuator: int | None = tag(
        "actuator_number",
        default=None,
        least=0,
        doc="Index of the target in a message of type Actuators.",
    )
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the target positions (Float64). Default: "
        "`/model/<model>/joint/<joint>/cmd_pos`, or `/actuators` for messages of type Actuators.",
    )
    sub_topic: str = tag(
        "sub_topic",
        default="",
        doc="Topic of the targets, relative to `/model/<model>`. Used if `<topic>` is not set.",
    )
    joints: tuple[str, ...] = tag(
        "joint_name",
        role="joint",
        doc="Joint to control. Repeat the tag to move several joints to the same target.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointPositionParameters(ServoParameters):
    i: float = tag("i_gain", default=0.1, doc="Integral gain of the PID controller.")
    d: float = tag(
        "d_gain",
        default=0.01,
        doc="Derivative gain of the PID controller. It is applied as damping of the joint.",
    )
    index: float = tag(
        "joint_index",
        default=0.0,
        doc="Index of the controlled axis of the joint. Only 0, the first axis, is supported.",
    )
    velocity: bool = tag(
        "use_velocity_commands",
        default=False,
        doc="Whether to move to the target at a velocity of at most `<cmd_max>`, regardless of "
        "the load. The PID gains then have no effect.",
    )
    initial: float = tag(
        "initial_position",
        default=0.0,
        unit="rad or m",
        most=FARTHEST,
        doc="Target position until the first message.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointVelocityParameters(ServoParameters):
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the target velocities (Float64). Default: "
        "`/model/<model>/joint/<joint>/cmd_vel`, or `/actuators` for messages of type Actuators.",
    )
    force: bool = tag(
        "use_force_commands",
        default=False,
        doc="Whether the PID controller controls the velocity. If false, a velocity servo does, "
        "and the tags of the PID controller have no effect.",
    )
    initial: float = tag(
        "initial_velocity",
        default=0.0,
        unit="rad/s or m/s",
        most=FARTHEST,
        doc="Target velocity until the first message.",
    )


_DEFAULT_TOPICS = {"position": "cmd_pos", "velocity": "cmd_vel"}


def _add_servos(
    plugin: Plugin[Any],
    quantity: Literal["position", "velocity"],
    *,
    by_pid: bool,
    max_velocity: float = math.inf,
) -> None:
    """Checks the tags, and adds the servos of the joints.

    Args:
        plugin: The plugin.
        quantity: Quantity of the target.
        by_pid: Whether PID controllers move the joints.
        max_velocity: Maximum velocity of joints that move to a position otherwise.

    Raises:
        PluginError: There is no joint, or a minimum exceeds its maximum.
    """
    config = plugin.config
    if not config.joints:
        raise missing("plugin", "joint_name", plugin.tag.origin)
    for what, low, high in (
        ("cmd", config.cmd_min, config.cmd_max),
        ("i", config.i_min, config.i_max),
    ):
        if low > high:
            raise PluginError(
                f"<{what}_min> must not exceed <{what}_max> (got {low:g} and {high:g})",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=plugin.place_of(f"{what}_min"),
                values={"parameter": f"{what}_min", "value": low, "most": high},
            )
    if config.actuators and config.actuator is None:
        plugin.warn_ignored("use_actuator_msg", "there is no <actuator_number>")
    joints = tuple(name.strip() for name in config.joints)
    device = JointServosConfig(
        joints=joints,
        topic=_topic(plugin, joints[0], _DEFAULT_TOPICS[quantity]),
        actuator=actuator_of(config),
        quantity=quantity,
        initial=config.initial,
        gains=_gains(config) if by_pid else None,
        max_velocity=max_velocity,
        limited=True,
    )
    plugin.add(JointServos(plugin.scope, device))


def actuator_of(config: ServoParameters) -> int | None:
    """Returns the index of the target in messages of type Actuators; None for Float64."""
    return config.actuator if config.actuators else None


def _topic(plugin: Plugin[Any], joint: str, default: str) -> str:
    """Returns the topic of the target, whose last part is `default` if no tag states it."""
    config: ServoParameters = plugin.config
    topic = config.topic
    if not topic and config.sub_topic:
        topic = f"/model/{plugin.part.name}/{config.sub_topic.strip().lstrip('/')}"
    if not topic and actuator_of(config) is not None:
        topic = "actuators"
    topic = topic or f"/model/{plugin.part.name}/joint/{joint}/{default}"
    return gz_name(plugin, topic, "")


def _gains(config: ServoParameters) -> PidGains:
    return PidGains(
        p=config.p,
        i=config.i,
        d=config.d,
        i_min=config.i_min,
        i_max=config.i_max,
        stored="limited term",
        offset=config.cmd_offset,
        u_min=config.cmd_min,
        u_max=config.cmd_max,
    )


class JointPositionController(Plugin[JointPositionParameters]):
    """Moves a joint to the last commanded position and holds it there.

    Until the first command, the target position is ``<initial_position>``. By default, a PID
    controller computes the force or torque on the joint. Original plugin:
    ``JointPositionController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-position-controller-system",)

    def configure(self) -> None:
        config = self.config
        _add_servos(self, "position", by_pid=not config.velocity, max_velocity=abs(config.cmd_max))
        if config.index and not (config.topic or config.sub_topic):
            self.warn_ignored("joint_index", "only the first axis of a joint is controlled")


class JointController(Plugin[JointVelocityParameters]):
    """Moves a joint at the last commanded velocity.

    Until the first command, the target velocity is ``<initial_velocity>``. By default, a velocity
    servo controls the velocity, up to the velocity limit of the joint. With
    ``<use_force_commands>``, a PID controller does. Original plugin: ``JointController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-controller-system",)

    def configure(self) -> None:
        _add_servos(self, "velocity", by_pid=self.config.force)


@dataclass(frozen=True, kw_only=True, slots=True)
class ApplyJointForceParameters:
    joint: str = tag(
        "joint_name", role="joint", doc="Joint to which the force or torque is applied."
    )


class ApplyJointForce(Plugin[ApplyJointForceParameters]):
    """Applies the last commanded force or torque to a joint until the next command.

    It is added to the force of a PID controller on the same joint, such as that of an autopilot.
    Commands are received on ``/model/<model>/joint/<joint>/cmd_force`` (Float64). A command is a
    torque in N m for a revolute joint, and a force in N for a prismatic joint. Original plugin:
    ``ApplyJointForce`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-apply-joint-force-system",)

    def configure(self) -> None:
        joint = self.config.joint.strip()
        topic = gz_name(self, f"/model/{self.part.name}/joint/{joint}/cmd_force", "")
        self.add(JointForce(self.scope, JointForceConfig(joint=joint, topic=topic)))
