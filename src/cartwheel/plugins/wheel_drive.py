"""Drives whose wheels stand in pairs, left and right, and turn by their difference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.description.kinematics import link_poses
from cartwheel.errors import Diagnostic, PluginError
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.odometry import DeadReckoning, Odometry, planar_motion
from cartwheel.plugins.wheel_states import JointStates


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelPair:
    """Two wheels of one axle."""

    left: str
    """Joint."""
    right: str
    """Joint."""
    separation: float
    """m, between them."""
    diameter: float
    """m."""


class WheelDrive(Plugin[Any]):
    """Drives pairs of wheels by Twist, and tells where that took the robot.

    A subclass's `configure` calls `_take_wheels`, makes what tells, and calls `_run`.
    """

    odometry: Odometry | None = None
    joint_states: JointStates | None = None

    def _take_wheels(self, pairs: Sequence[WheelPair], *, torque: float | None) -> None:
        """Takes joints and motors; `joints` is left, right, pair by pair."""
        origin = self.tag.origin
        for pair in pairs:
            for value, what in (
                (pair.separation, "separation"),
                (pair.diameter, "diameter or radius"),
            ):
                if value <= 0:
                    raise PluginError(
                        f"the wheels' {what} {value:g} must be above 0", origin=origin
                    )
        names = [name for pair in pairs for name in (pair.left, pair.right)]
        self._pairs = list(pairs)
        self._radii = [pair.diameter / 2 for pair in pairs for _ in "lr"]
        self.joints = [self.part.joint(name, origin=origin) for name in names]
        self._motors = [
            self.part.velocity_motor(name, max_effort=torque, origin=origin) for name in names
        ]
        self._reckoning = DeadReckoning()
        self._tell_sides(pairs)

    def _tell_sides(self, pairs: Sequence[WheelPair]) -> None:
        """Says where a left wheel stands on the right: the robot turns against its commands."""
        description = self.part.description
        poses = link_poses(description, {})
        front = poses[description.canonical_link].inverse()
        for pair in pairs:
            made = [description.joint(name) for name in (pair.left, pair.right)]
            left, right = ((front @ poses[joint.child]).y for joint in made if joint is not None)
            if left < right:
                self.part.report(
                    Diagnostic(
                        severity="info",
                        message=f'the wheel of "{pair.left}" stands to the right of that of '
                        f'"{pair.right}": the robot turns against its commands, as in Gazebo',
                        origin=self.tag.origin,
                    )
                )
                return

    def base_link(self, name: str) -> Any:
        """The link of that name; the root where it is a frame's and no link's."""
        description = self.part.description
        known = description.link(name) is not None
        return self.part.link(name if known else description.canonical_link)

    def _run(
        self,
        *,
        command_topic: str,
        base: str,
        encoded: bool,
        control_rate: float,
        rate: float,
        acceleration: float = 0.0,
        reverse: bool = False,
    ) -> None:
        """Subscribes and schedules.

        Args:
            command_topic: Twist.
            base: Link whose true pose is told where the odometry is not `encoded`.
            encoded: The odometry is what the first pair's turning gives.
            control_rate: Hz.
            rate: Hz, of what is told.
            acceleration: m/s², of the wheels' rims; 0 is at once.
            reverse: Turn the other way.
        """
        if acceleration < 0 or rate < 0 or control_rate < 0:
            if self.odometry is not None:
                self.odometry.close()
            raise PluginError("an acceleration or rate cannot be below 0", origin=self.tag.origin)
        self._base = self.base_link(base)
        self._encoded = encoded
        self._acceleration = acceleration
        self._reverse = reverse
        self.subscribe(command_topic, "geometry_msgs/msg/Twist", self._on_command)
        self.part.schedule(control_rate, before=self._control)
        self.part.schedule(rate, after=self._publish, active=self._wanted)
        self.reset()

    def reset(self) -> None:
        self._target = [0.0] * len(self._motors)
        self._ramped = [0.0] * len(self._motors)
        self._updated_ns: int | None = None
        self._turned: tuple[float, float] | None = None
        self._reckoning.restart()
        for motor in self._motors:
            motor.target = 0.0

    def close(self) -> None:
        if self.odometry is not None:
            self.odometry.close()
        super().close()

    def _on_command(self, message: Any) -> None:
        forward, turn = float(message.linear.x), float(message.angular.z)
        if not (math.isfinite(forward) and math.isfinite(turn)):
            self.warn("a command that is not finite was ignored")
            return
        self._aim(forward, -turn if self._reverse else turn)

    def _aim(self, forward: float, turn: float) -> None:
        """Sets the rims' speeds: those of a body that goes at m/s and turns at rad/s."""
        self._target = [
            forward + sign * turn * pair.separation / 2 for pair in self._pairs for sign in (-1, 1)
        ]

    def _control(self) -> None:
        """Ramps the rim speeds towards the command; integrates the encoders."""
        now = self.part.time_ns
        seconds = 0.0 if self._updated_ns is None else (now - self._updated_ns) * 1e-9
        self._updated_ns = now
        ramp = self._acceleration
        limit = ramp * seconds
        for index, motor in enumerate(self._motors):
            target, ramped = self._target[index], self._ramped[index]
            if target != ramped:
                ramped = ramped + min(max(target - ramped, -limit), limit) if ramp > 0 else target
                self._ramped[index] = ramped
            motor.command(ramped / self._radii[index])
        if self._encoded:
            self._integrate(seconds)

    def _integrate(self, seconds: float) -> None:
        turned = (self.joints[0].position, self.joints[1].position)
        if self._turned is not None:
            radius = self._radii[0]
            left, right = ((turned[i] - self._turned[i]) * radius for i in (0, 1))
            turn = (right - left) / self._pairs[0].separation
            self._reckoning.go((left + right) / 2, turn, seconds)
        self._turned = turned

    def _wanted(self) -> bool:
        if self.odometry is not None and self.odometry.wanted():
            return True
        return self.joint_states is not None and self.joint_states.wanted()

    def _publish(self) -> None:
        now = self.part.time_ns
        if self.joint_states is not None and self.joint_states.wanted():
            self.joint_states.publish(now)
        if self.odometry is not None and self.odometry.wanted():
            told = self._reckoning.motion() if self._encoded else planar_motion(self._base)
            self.odometry.publish(now, *told)
