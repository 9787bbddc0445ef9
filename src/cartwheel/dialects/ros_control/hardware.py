"""The joints that a robot offers to controllers, with their interfaces and limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.description.model import Joint, Mimic, RobotDescription
from cartwheel.devices.joints.actuator import JointActuator, JointActuatorConfig
from cartwheel.devices.joints.gravity import gravity_efforts
from cartwheel.devices.joints.inertia import inertial_efforts
from cartwheel.devices.joints.limits import JointLimits, position_range, velocity_limit
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.ros_control.interfaces import JointInterfaces
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError, UnknownNameError

STRONGEST = 1e5
"""Effort in N m or N of a joint without an effort limit."""
_TURNING, _SLIDING = 0.5, 0.05
"""Speed at which a joint overcomes its damping at least, rad/s and m/s."""


class Needs:
    """The efforts that the joints of a robot need, which are computed when they are needed.

    Args:
        description: The robot.
        accelerates: Whether joints with commands accelerate what they move regardless of limits.
    """

    def __init__(self, description: RobotDescription, *, accelerates: bool) -> None:
        self._description = description
        self._accelerates = accelerates

    @cached_property
    def holding(self) -> Mapping[str, float]:
        """The largest effort that gravity demands of each joint, N m or N."""
        return gravity_efforts(self._description)

    @cached_property
    def accelerating(self) -> Mapping[str, float]:
        """The effort with which each joint accelerates, N m or N; see `inertial_efforts`."""
        return inertial_efforts(self._description) if self._accelerates else {}


class JointHardware(JointActuator):
    """A joint that controllers can command.

    Args:
        owner: Plugin of the controller manager.
        interfaces: Interfaces of the joint.
        needs: The efforts that the joints need.
        gains: An interface whose commands a PID converts to efforts, with the gains.
        limits: Parameters that override the limits in the description. If given, even empty, the
            soft limits in the description apply.
        forced: Whether a joint follows velocity commands regardless of its stated limits.

    Raises:
        PluginError: A limit is not a number.
    """

    def __init__(
        self,
        owner: Component,
        interfaces: JointInterfaces,
        needs: Needs,
        gains: tuple[str, PidGains] | None = None,
        limits: Settings | None = None,
        *,
        forced: bool = False,
    ) -> None:
        joint = owner.part.description.joint(interfaces.name)
        assert joint is not None
        self.name = interfaces.name
        """Name for controllers. In a reference, it differs from the name in the description."""
        self.interfaces = interfaces
        joint_limits = _limits(joint, limits, forced=forced)
        free = [each for each in interfaces.commands if gains is None or gains[0] != each]
        command = "position" if "position" in free else "velocity"
        strength = joint_limits.effort
        if command in free and (forced or command == "position"):
            strength = _strength(owner, interfaces, joint, strength, needs, command=command)
        super().__init__(
            owner.part,
            JointActuatorConfig(
                joint=interfaces.name,
                commands=interfaces.commands,
                limits=joint_limits,
                strength=min(strength, STRONGEST),
                exceeds_limit=min(strength, STRONGEST) > joint_limits.effort,
                pid=gains,
                overruns=forced,
                # gz-sim cannot brake a wheel with an effort of 0.
                idles=limits is None and not forced and joint.turns and joint.axis.effort == 0,
                led=joint.mimic is not None or interfaces.mimic is not None,
                # gz_ros2_control and gazebo_ros2_control stop such joints once in each control
                # period, after which the motor of the drive plugin turns them on in the same step.
                # gazebo_ros_control adds an effort of 0 without a controller.
                yields=limits is None or set(interfaces.commands) == {"effort"},
                origin=interfaces.origin,
            ),
        )
        if interfaces.mimic is not None and joint.mimic is None:
            leader, multiplier = interfaces.mimic
            mimic = Mimic(joint=leader, multiplier=multiplier)
            owner.part.mimic(interfaces.name, mimic, origin=interfaces.origin)


def _limits(joint: Joint, settings: Settings | None, *, forced: bool) -> JointLimits:
    """Returns a joint's limits from its description and the parameters.

    gazebo_ros2_control (`forced`) has no velocity limits, so a limit of 0 does not hold its joints.
    Source: joint_limits_interface, joint_limits_rosparam.
    """
    axis = joint.axis
    effort = axis.effort if axis.effort else math.inf
    velocity = math.inf if forced and axis.velocity == 0 else velocity_limit(joint)
    lower, upper = position_range(joint)
    if settings is not None:
        if settings.boolean("has_position_limits", False):
            lower, upper = settings.number("min_position"), settings.number("max_position")
        if settings.boolean("has_velocity_limits", False):
            velocity = settings.number("max_velocity")
        if settings.boolean("has_effort_limits", False):
            effort = settings.number("max_effort")
    return JointLimits(
        lower=lower,
        upper=upper,
        velocity=velocity,
        effort=effort,
        soft=joint.soft if settings is not None else None,
    )


def _strength(
    owner: Component,
    interfaces: JointInterfaces,
    joint: Joint,
    limit: float,
    needs: Needs,
    *,
    command: str,
) -> float:
    """Returns the maximum effort of a command, N m or N, which holds the joint.

    `command` is "position" or "velocity".
    """
    if limit == math.inf:
        return limit
    resistance = _friction(owner.part.description, joint) + _drag(joint)
    holding = needs.holding.get(joint.name, 0.0) + resistance
    need = max(holding, needs.accelerating.get(joint.name, 0.0))
    if limit >= need:
        return limit
    purpose = "hold the joint against gravity and to overcome its friction and damping"
    if need > holding:
        purpose = "accelerate what the joint moves"
    raises = owner.part.adds("raised-efforts")
    held, unit = 2 * need if raises else limit, "N" if joint.type == "prismatic" else "N m"
    result = (
        f"as in Gazebo, the joint still follows {command} commands, with up to "
        if raises
        else f"the joint follows {command} commands with no more than "
    )
    owner.warn(
        devices.EFFORT_LIMIT_TOO_LOW,
        f'the effort limit of joint "{joint.name}", {limit:g} {unit}, is below the '
        f"{need:.3g} {unit} required to {purpose}; {result}{held:.3g} {unit}",
        at=interfaces.origin,
        values={"joint": joint.name, "stated": limit, "needed": need, "used": held},
    )
    return held


def _friction(description: RobotDescription, joint: Joint) -> float:
    """Friction of a joint and of the joints that mimic it, N m or N."""
    led = [
        each.axis.friction * abs(each.mimic.multiplier)
        for each in description.joints
        if each.mimic is not None and each.mimic.joint == joint.name
    ]
    return joint.axis.friction + sum(led)


def _drag(joint: Joint) -> float:
    """Effort against a joint's damping at a low speed, N m or N."""
    speed = _SLIDING if joint.type == "prismatic" else _TURNING
    return joint.axis.damping * min(speed, joint.axis.velocity or speed)


class Hardware:
    """All joints of a robot that controllers can use.

    Args:
        owner: Plugin of the controller manager.
        joints: Interfaces of the joints.
        gains: Interface and gains of each joint whose commands a PID converts to efforts.
        limits: ROS 1's parameters ``joint_limits``; None in ROS 2, which has no soft limits.
        forced: Whether joints follow velocity commands regardless of their stated limits.
    """

    def __init__(
        self,
        owner: Component,
        joints: list[JointInterfaces],
        gains: Mapping[str, tuple[str, PidGains]],
        limits: Settings | None = None,
        *,
        forced: bool = False,
    ) -> None:
        self._description = owner.part.description
        self._tags = "no <ros2_control>" if limits is None else "no <transmission>"
        # Gazebo Classic sets the positions of joints. gz-sim has motors with the effort limit.
        needs = Needs(self._description, accelerates=forced or limits is not None)
        self._joints = {
            each.name: JointHardware(
                owner,
                each,
                needs,
                gains.get(each.name),
                limits.section(each.name) if limits is not None else None,
                forced=forced,
            )
            for each in joints
        }
        self._written = tuple(self._joints.values())
        self.references: dict[str, JointHardware] = {}
        """Reference interfaces by full name, such as ``controller/joint/velocity``."""
        self.holds = False
        """Whether joints with an effort interface are held before a controller commands them."""
        self.halted = False
        """Whether all joints are stopped, regardless of commands."""

    @property
    def names(self) -> list[str]:
        """All joints, in the order of the description's tags."""
        return list(self._joints)

    def joint(self, name: str, interface: str | None = None) -> JointHardware:
        """Returns a joint, or a reference to one if `interface` is given.

        Raises:
            UnknownNameError: The joint does not exist.
            PluginError: The joint does not have this command interface, or no interface at all.
        """
        if interface is not None and f"{name}/{interface}" in self.references:
            return self.references[f"{name}/{interface}"]
        stated = self._description.joint(name)
        if name not in self._joints and stated is not None and not stated.drivable:
            raise PluginError(
                f'joint "{name}" is not available to controllers because it is {stated.type}',
                code=devices.CONTROLLER_INTERFACE_MISMATCH,
                origin=stated.origin,
                hint="Only revolute, continuous and prismatic joints have interfaces.",
                values={"joint": name},
            )
        if name not in self._joints and stated is not None:
            raise PluginError(
                f'joint "{name}" is not available to controllers because {self._tags} lists it',
                code=devices.CONTROLLER_INTERFACE_MISMATCH,
                origin=stated.origin,
                values={"joint": name},
            )
        if name not in self._joints:
            raise UnknownNameError(
                "joint",
                name,
                [*self._joints, *(each.name for each in self.references.values())],
                code=devices.CONTROLLER_JOINT_UNKNOWN,
            )
        joint = self._joints[name]
        held = joint.interfaces
        if interface is not None and interface not in (*held.commands, *held.passive):
            offered = ", ".join(held.commands)
            raise PluginError(
                f'joint "{name}" has no {interface} interface',
                code=devices.CONTROLLER_INTERFACE_MISMATCH,
                origin=joint.interfaces.origin,
                hint=f"Available interfaces: {offered}."
                if offered
                else "Add a command interface to the joint in the robot description.",
                values={"joint": name, "interface": interface, "offered": offered},
            )
        return joint

    def start(self) -> None:
        """Holds the joints before any controller runs, except effort joints in ROS 1."""
        for joint in self._joints.values():
            initial = joint.interfaces.initial_position
            if initial is not None:
                joint.state.position = initial
            joint.rest(holds=self.holds)

    @property
    def follows(self) -> bool:
        """Whether commands must be written at every step because a joint has a PID."""
        return any(joint.pids for joint in self._joints.values())

    def write(self, seconds: float, *, lead: float = 0.0) -> None:
        """Applies all commands to the joints; see `JointHardware.write`."""
        if self.halted:
            for joint in self._written:
                joint.halt()
            return
        for joint in self._written:
            joint.write(seconds, lead)

    def expect_commands(self, period: float) -> None:
        """States the time between two calls of `write`, s."""
        for joint in self._written:
            joint.expect_commands(period)
