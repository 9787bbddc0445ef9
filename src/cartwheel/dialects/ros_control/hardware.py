"""The joints of a robot for controllers: states, commands, limits and PIDs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, partial

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.description.model import Axis, Mimic, SoftLimits
from cartwheel.devices.joints.pid import Pid, PidGains
from cartwheel.dialects.ros_control.burden import burdens
from cartwheel.dialects.ros_control.interfaces import JointInterfaces
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.simulation.handles import JointHandle, MotorHandle
from cartwheel.simulation.servo import ServoHandle

_STRONGEST = 1e5
"""Effort in N m or N of a joint without an effort limit."""


class JointHardware:
    """A joint. Commands are limited as in joint_limits_interface.

    Args:
        owner: Plugin of the controller manager.
        interfaces: Interfaces of the joint.
        gains: An interface whose commands a PID converts to efforts, with the gains.
        limits: Parameters that override the limits in the description. If given, even empty, the
            soft limits in the description apply.
        needs: Returns the largest effort that gravity demands of each joint, N m or N.

    Raises:
        PluginError: A limit is not a number.
    """

    def __init__(
        self,
        owner: Component,
        interfaces: JointInterfaces,
        needs: Callable[[], Mapping[str, float]],
        gains: tuple[str, PidGains] | None = None,
        limits: Settings | None = None,
    ) -> None:
        part, name, origin = owner.part, interfaces.name, interfaces.origin
        joint = part.description.joint(name)
        assert joint is not None
        self.name = name
        self.joint = name
        """Name in the description. `name` differs from it for a controller's reference."""
        self.interfaces = interfaces
        self.type = joint.type
        self.axis: Axis = joint.axis
        self.effort_limit = joint.axis.effort if joint.axis.effort else math.inf
        self.velocity_limit = joint.axis.velocity if joint.axis.velocity else math.inf
        self.lower, self.upper = -math.inf, math.inf
        if joint.type != "continuous":
            self.lower = -math.inf if joint.axis.lower is None else joint.axis.lower
            self.upper = math.inf if joint.axis.upper is None else joint.axis.upper
        self._soft: SoftLimits | None = None
        if limits is not None:
            self._soft = joint.soft
            self._take_limits(limits)
        self.state: JointHandle = part.joint(name, origin=origin)
        self.motor: MotorHandle | None = None
        self.servo: ServoHandle | None = None
        self.pids = {gains[0]: Pid(gains[1])} if gains is not None else {}
        strength = self._strength(owner, needs)
        if interfaces.commands == ("velocity",) and not self.pids:
            self.motor = part.velocity_motor(name, max_effort=strength, origin=origin)
        elif interfaces.commands:
            self.servo = part.servo(
                name, max_effort=strength, beyond=strength > self.effort_limit, origin=origin
            )
        self.active: str = ""
        """The commanded interface."""
        self.command = 0.0
        self.rate = 0.0
        """Rate of change of a commanded position, rad/s or m/s; 0 if unknown."""
        self.strength = math.inf
        """Maximum effort of a position command, N m or N. A gripper controller can lower it."""
        self._damping = 0.0
        self._led = joint.mimic is not None or interfaces.mimic is not None
        """Whether the joint follows another joint. It is then not held while it has no command."""
        if interfaces.mimic is not None and joint.mimic is None:
            leader, multiplier = interfaces.mimic
            part.mimic(name, Mimic(joint=leader, multiplier=multiplier), origin=origin)

    def _strength(self, owner: Component, needs: Callable[[], Mapping[str, float]]) -> float:
        """Returns the maximum effort of position and velocity commands, N m or N."""
        limit, commands = self.effort_limit, self.interfaces.commands
        if "position" in commands and "position" not in self.pids and limit < math.inf:
            need = needs().get(self.name, 0.0)
            if limit < need:
                held, unit = 2 * need, "N" if self.type == "prismatic" else "N m"
                owner.warn(
                    devices.EFFORT_LIMIT_TOO_LOW,
                    f'the effort limit of joint "{self.name}", {limit:g} {unit}, is below the '
                    f"{need:.3g} {unit} that gravity requires; as in Gazebo, position commands are "
                    f"still followed, with up to {held:.3g} {unit}",
                    at=self.interfaces.origin,
                    values={"joint": self.name, "stated": limit, "needed": need, "used": held},
                )
                limit = held
        return min(limit, _STRONGEST)

    def _take_limits(self, limits: Settings) -> None:
        """Reads the limits. Source: joint_limits_interface, joint_limits_rosparam."""
        if limits.boolean("has_position_limits", False):
            self.lower, self.upper = limits.number("min_position"), limits.number("max_position")
        if limits.boolean("has_velocity_limits", False):
            self.velocity_limit = limits.number("max_velocity")
        if limits.boolean("has_effort_limits", False):
            self.effort_limit = limits.number("max_effort")

    def _velocity_bounds(self) -> tuple[float, float]:
        """Returns the lowest and highest velocity, reduced near a soft limit. Source: PR2."""
        most, soft = self.velocity_limit, self._soft
        if soft is None or math.inf in (-self.lower, self.upper):
            return -most, most
        low, high = (
            min(max(-soft.k_position * (self.position - limit), -most), most)
            for limit in (soft.lower, soft.upper)
        )
        return low, high

    @property
    def position(self) -> float:
        """rad or m."""
        return self.state.position

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return self.state.velocity

    @property
    def lightness(self) -> float:
        """Acceleration per effort: rad/s² for 1 N m, or m/s² for 1 N."""
        return self.state.lightness

    @property
    def effort(self) -> float:
        """Effort of the last step, N m or N."""
        return self.state.effort

    def activate(self, interface: str) -> None:
        """Selects the commanded interface. The joint stays at its position."""
        self.active = interface
        self._damping = 0.0
        self.strength = math.inf
        self.command = self.position if interface == "position" else 0.0
        self.rate = 0.0
        for pid in self.pids.values():
            pid.reset()

    def release(self) -> None:
        """Called when no controller commands the joint any more.

        A position command is kept; velocity and effort commands become 0.
        """
        self.rate = self._damping = 0.0
        if self.active in ("velocity", "effort"):
            self.command = 0.0

    def rest(self, *, holds: bool) -> None:
        """Called before any controller commands the joint.

        Args:
            holds: Hold joints with an effort interface as well, as ros2_control's simulations do.
        """
        commands = self.interfaces.commands
        if not commands:
            return
        if self._led and self.servo is not None:
            self.active = ""
            self.servo.release()
            return
        self.activate(commands[0])
        if holds and self.servo is not None:
            self.active = "held"
            self.command = self.position

    def set_effort(self, effort: float, *, damping: float = 0.0) -> None:
        """Commands an effort that decreases with velocity, for controllers with their own PID."""
        self.command = effort
        self._damping = damping

    def write(self, seconds: float, *, lead: float = 0.0) -> None:
        """Applies the command to the joint.

        Args:
            seconds: Time since the last call, s.
            lead: Time since the command was set, s. A position command is extrapolated by it.
        """
        match self.active:
            case "position":
                self._write_position(seconds, lead)
            case "velocity":
                self._write_velocity(seconds)
            case "effort":
                self._write_effort()
            case "held":
                assert self.servo is not None
                self.servo.command_position(self.command)

    def halt(self) -> None:
        """Sets efforts to 0, and brakes joints with velocity or position commands."""
        if self.motor is not None:
            self.motor.command(0.0)
        elif self.servo is not None and self.active == "effort":
            self.servo.release()
        elif self.servo is not None:
            self.servo.command_velocity(0.0)

    def _write_position(self, seconds: float, lead: float) -> None:
        lower, upper, fastest = self.lower, self.upper, self.velocity_limit
        target = self.command + lead * self.rate
        soft = self._soft
        if soft is not None and math.inf not in (-lower, upper):
            lower, upper = max(lower, soft.lower), min(upper, soft.upper)
            low, high = self._velocity_bounds()
            fastest = max(high if target > self.position else -low, 0.0)
        target = min(max(target, lower), upper)
        assert self.servo is not None
        pid = self.pids.get("position")
        if pid is None:
            self.servo.command_position(
                target,
                velocity=self.rate,
                max_velocity=fastest,
                max_effort=self.strength,
            )
            return
        error = target - self.position
        if self.type == "continuous":
            error = math.remainder(error, 2 * math.pi)
        law = pid.position(
            error, seconds, target=target, rate=self.rate or None, lightness=self.lightness
        )
        self.servo.command_effort(law.effort, damping=law.damping)

    def _write_velocity(self, seconds: float) -> None:
        low, high = self._velocity_bounds()
        target = min(max(self.command, low), high)
        if self.motor is not None:
            self.motor.command(target)
            return
        assert self.servo is not None
        pid = self.pids.get("velocity")
        if pid is None:
            self.servo.command_velocity(target)
        else:
            law = pid.velocity(target, self.velocity, seconds)
            self.servo.command_effort(law.effort, damping=law.damping)

    def _write_effort(self) -> None:
        damping = self._damping
        effort = min(max(self.command, -self.effort_limit), self.effort_limit)
        if self._soft is not None:
            # As a damper toward the bound, which the physics integrates implicitly.
            gain, output = self._soft.k_velocity, effort - damping * self.velocity
            slowest, fastest = self._velocity_bounds()
            if output < gain * (slowest - self.velocity):
                effort, damping = gain * slowest, gain
            elif output > gain * (fastest - self.velocity):
                effort, damping = gain * fastest, gain
        # Beyond a limit, only efforts that move the joint back are applied.
        if self.position < self.lower or self.velocity < -self.velocity_limit:
            effort = max(effort, 0.0)
        elif self.position > self.upper or self.velocity > self.velocity_limit:
            effort = min(effort, 0.0)
        assert self.servo is not None
        self.servo.command_effort(effort, damping=damping)


class Hardware:
    """All joints of a robot that controllers can use.

    Args:
        owner: Plugin of the controller manager.
        joints: Interfaces of the joints.
        gains: Interface and gains of each joint whose commands a PID converts to efforts.
        limits: ROS 1's parameters ``joint_limits``; None in ROS 2, which has no soft limits.
    """

    def __init__(
        self,
        owner: Component,
        joints: list[JointInterfaces],
        gains: Mapping[str, tuple[str, PidGains]],
        limits: Settings | None = None,
    ) -> None:
        self._description = owner.part.description
        self._tags = "no <ros2_control>" if limits is None else "no <transmission>"
        needs = cache(partial(burdens, self._description))
        self._joints = {
            each.name: JointHardware(
                owner,
                each,
                needs,
                gains.get(each.name),
                limits.section(each.name) if limits is not None else None,
            )
            for each in joints
        }
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
        if interface is not None and interface not in joint.interfaces.commands:
            offered = ", ".join(joint.interfaces.commands)
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
        for joint in self._joints.values():
            if self.halted:
                joint.halt()
            else:
                joint.write(seconds, lead=lead)
