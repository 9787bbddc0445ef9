"""The joints of a robot as controllers see them: state, command, limits, PID."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Any

from cartwheel.codes import devices
from cartwheel.description.model import Axis, Mimic, SoftLimits
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.control.burden import burdens
from cartwheel.plugins.control.interfaces import JointInterfaces
from cartwheel.plugins.control.pid import Gains, Pid
from cartwheel.plugins.control.settings import Settings
from cartwheel.simulation.handles import JointHandle, MotorHandle
from cartwheel.simulation.servo import ServoHandle

_STRONGEST = 1e5
"""N m or N of a joint that states no effort limit."""


class JointHardware:
    """One joint; what is commanded is limited as joint_limits_interface does.

    Args:
        plugin: Whose robot it is.
        interfaces: What it offers.
        gains: An interface whose commands become efforts by a PID.
        limits: Parameters that go before the description's limits; with them, even if there are
            none, its soft limits count.
        needs: What weight asks of the robot's joints at most, N m or N.

    Raises:
        PluginError: A limit is no number.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        interfaces: JointInterfaces,
        needs: Callable[[], Mapping[str, float]],
        gains: tuple[str, Gains] | None = None,
        limits: Settings | None = None,
    ) -> None:
        part, name, origin = plugin.part, interfaces.name, interfaces.origin
        joint = part.description.joint(name)
        assert joint is not None
        self.name = name
        self.joint = name
        """Of the description, where `name` is that of a controller's reference to it."""
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
        strength = self._strength(plugin, needs)
        if interfaces.commands == ("velocity",) and not self.pids:
            self.motor = part.velocity_motor(name, max_effort=strength, origin=origin)
        elif interfaces.commands:
            self.servo = part.servo(
                name, max_effort=strength, beyond=strength > self.effort_limit, origin=origin
            )
        self.active: str = ""
        """The interface that is commanded."""
        self.command = 0.0
        self.rate = 0.0
        """How a commanded position changes, rad/s or m/s, where a controller knows it."""
        self.strength = math.inf
        """N m or N that a held position may take, where a controller grips more gently."""
        self._damping = 0.0
        self._led = joint.mimic is not None or interfaces.mimic is not None
        """Whether it follows another joint, and must not be held while nothing commands it."""
        if interfaces.mimic is not None and joint.mimic is None:
            leader, multiplier = interfaces.mimic
            part.mimic(name, Mimic(joint=leader, multiplier=multiplier), origin=origin)

    def _strength(self, plugin: Plugin[Any], needs: Callable[[], Mapping[str, float]]) -> float:
        """N m or N with which a position or velocity is held, at most."""
        limit, commands = self.effort_limit, self.interfaces.commands
        if "position" in commands and "position" not in self.pids and limit < math.inf:
            need = needs().get(self.name, 0.0)
            if limit < need:
                held, unit = 2 * need, "N" if self.type == "prismatic" else "N m"
                plugin.warn(
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
        """Source: joint_limits_interface, joint_limits_rosparam."""
        if limits.boolean("has_position_limits", False):
            self.lower, self.upper = limits.number("min_position"), limits.number("max_position")
        if limits.boolean("has_velocity_limits", False):
            self.velocity_limit = limits.number("max_velocity")
        if limits.boolean("has_effort_limits", False):
            self.effort_limit = limits.number("max_effort")

    def _velocity_bounds(self) -> tuple[float, float]:
        """The least and the largest velocity: near a soft limit less of it. Source: PR2."""
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
        """rad/s² for 1 N m, or m/s² for 1 N."""
        return self.state.lightness

    @property
    def effort(self) -> float:
        """N m or N that drove it in the last step."""
        return self.state.effort

    def activate(self, interface: str) -> None:
        """Commands are of this interface from now on; the joint stays where it is."""
        self.active = interface
        self._damping = 0.0
        self.strength = math.inf
        self.command = self.position if interface == "position" else 0.0
        self.rate = 0.0
        for pid in self.pids.values():
            pid.reset()

    def release(self) -> None:
        """No controller commands it any more: positions are kept, velocities and efforts are 0."""
        self.rate = self._damping = 0.0
        if self.active in ("velocity", "effort"):
            self.command = 0.0

    def rest(self, *, holds: bool) -> None:
        """Before any controller commands it.

        Args:
            holds: Whether one that takes efforts holds as well, as in ros2_control's simulations.
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
        """An effort that falls with the velocity, for controllers with a PID of their own."""
        self.command = effort
        self._damping = damping

    def write(self, seconds: float, *, lead: float = 0.0) -> None:
        """Brings the command to the joint.

        Args:
            seconds: Since the last time, s.
            lead: Since the command was given, s; what it changes by goes on.
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
        """Stops: efforts are 0, and what holds a velocity or a position stands."""
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
            # As a damper towards the bound, which the physics takes implicitly.
            gain, output = self._soft.k_velocity, effort - damping * self.velocity
            slowest, fastest = self._velocity_bounds()
            if output < gain * (slowest - self.velocity):
                effort, damping = gain * slowest, gain
            elif output > gain * (fastest - self.velocity):
                effort, damping = gain * fastest, gain
        # Beyond a limit it may only come back.
        if self.position < self.lower or self.velocity < -self.velocity_limit:
            effort = max(effort, 0.0)
        elif self.position > self.upper or self.velocity > self.velocity_limit:
            effort = min(effort, 0.0)
        assert self.servo is not None
        self.servo.command_effort(effort, damping=damping)


class Hardware:
    """All joints of a robot that controllers can see.

    Args:
        plugin: Whose robot it is.
        joints: What they offer.
        gains: Of joints whose commands of an interface go through a PID, by joint.
        limits: ROS 1's parameters ``joint_limits``; None in ROS 2, which has no soft limits.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        joints: list[JointInterfaces],
        gains: Mapping[str, tuple[str, Gains]],
        limits: Settings | None = None,
    ) -> None:
        self._description = plugin.part.description
        self._tags = "no <ros2_control>" if limits is None else "no <transmission>"
        needs = cache(partial(burdens, self._description))
        self._joints = {
            each.name: JointHardware(
                plugin,
                each,
                needs,
                gains.get(each.name),
                limits.section(each.name) if limits is not None else None,
            )
            for each in joints
        }
        self.references: dict[str, JointHardware] = {}
        """What controllers take commands for, by its full name: ``controller/joint/velocity``."""
        self.holds = False
        """Whether joints that take efforts hold as well before a controller commands them."""
        self.halted = False
        """Whether all joints stop, whatever they are told."""

    @property
    def names(self) -> list[str]:
        """All joints, in the order of the description's tags."""
        return list(self._joints)

    def joint(self, name: str, interface: str | None = None) -> JointHardware:
        """A joint, which must offer a command interface where one is given; or a reference to one.

        Raises:
            UnknownNameError: There is none of that name.
            PluginError: It has no such interface, or no tag gives it to controllers.
        """
        if interface is not None and f"{name}/{interface}" in self.references:
            return self.references[f"{name}/{interface}"]
        stated = self._description.joint(name)
        if name not in self._joints and stated is not None:
            raise PluginError(
                f'joint "{name}" is not available to controllers because {self._tags} contains it',
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
        found = self._joints[name]
        if interface is not None and interface not in found.interfaces.commands:
            offered = ", ".join(found.interfaces.commands)
            raise PluginError(
                f'joint "{name}" has no {interface} interface',
                code=devices.CONTROLLER_INTERFACE_MISMATCH,
                origin=found.interfaces.origin,
                hint=f"Available interfaces: {offered}."
                if offered
                else "The joint has no command interface.",
                values={"joint": name, "interface": interface, "offered": offered},
            )
        return found

    def start(self) -> None:
        """Before any controller runs: joints hold; those that take efforts are free in ROS 1."""
        for joint in self._joints.values():
            initial = joint.interfaces.initial_position
            if initial is not None:
                joint.state.position = initial
            joint.rest(holds=self.holds)

    @property
    def follows(self) -> bool:
        """Whether joints must be led at every step: those that have a PID."""
        return any(joint.pids for joint in self._joints.values())

    def write(self, seconds: float, *, lead: float = 0.0) -> None:
        """Brings all commands to the joints; see `JointHardware.write`."""
        for joint in self._joints.values():
            if self.halted:
                joint.halt()
            else:
                joint.write(seconds, lead=lead)
