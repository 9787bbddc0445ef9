"""Drives whose wheels stand in pairs, left and right, and turn by their difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cartwheel.codes import devices, robot
from cartwheel.description.kinematics import link_poses
from cartwheel.errors import PluginError
from cartwheel.geometry import Quat, Vec3
from cartwheel.plugins.drive import Drive
from cartwheel.plugins.odometry import AxleReckoning
from cartwheel.plugins.parameters import SMALLEST
from cartwheel.simulation.limits import FARTHEST


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


class WheelDrive(Drive):
    """Drives pairs of wheels by Twist, and tells where that took the robot.

    A subclass's `configure` calls `_take_wheels`, makes what tells, and calls `_run_wheels`.
    """

    def _take_wheels(self, pairs: Sequence[WheelPair], *, torque: float | None) -> None:
        """Takes joints and motors; `joints` is left, right, pair by pair."""
        origin = self.tag.origin
        for pair in pairs:
            for value, what in (
                (pair.separation, "separation"),
                (pair.diameter, "diameter or radius"),
            ):
                if not SMALLEST <= value <= FARTHEST:
                    raise PluginError(
                        f"the {what} of the wheels must be from {SMALLEST:g} to {FARTHEST:g} m "
                        f"(got {value:g} m)",
                        code=devices.PLUGIN_PARAMETER_INVALID,
                        origin=origin,
                        values={"parameter": what, "value": value},
                    )
        names = [name for pair in pairs for name in (pair.left, pair.right)]
        self._pairs = list(pairs)
        self._radii = [pair.diameter / 2 for pair in pairs for _ in "lr"]
        self.joints = [self.part.joint(name, origin=origin) for name in names]
        self._motors = [
            self.part.velocity_motor(name, max_effort=torque, origin=origin) for name in names
        ]
        self._reckoning = AxleReckoning(
            self.joints[0],
            self.joints[1],
            radius=self._radii[0],
            separation=pairs[0].separation,
        )
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
                self.warn(
                    robot.WHEELS_SWAPPED,
                    f'the left wheel of joint "{pair.left}" is to the right of that of '
                    f'"{pair.right}", so the robot turns against its commands, as in Gazebo',
                    severity="info",
                    values={"left": pair.left, "right": pair.right},
                )
                return

    def _run_wheels(
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
        """Subscribes and schedules; see `Drive`.

        Args:
            command_topic: Twist.
            base: Link whose true pose is told where the odometry is not `encoded`.
            encoded: The odometry is what the first pair's turning gives.
            control_rate: Hz.
            rate: Hz, of what is told.
            acceleration: m/s², of the wheels' rims; 0 is at once.
            reverse: Turn the other way.
        """
        self.check_not_negative("update_rate", "rate", "wheel_acceleration", "acceleration")
        self._encoded = encoded
        self._acceleration = acceleration
        self._reverse = reverse
        self._run(command_topic=command_topic, base=base, control_rate=control_rate, rate=rate)

    def reset(self) -> None:
        super().reset()
        self._target = [0.0] * len(self._motors)
        self._ramped = [0.0] * len(self._motors)
        self._reckoning.begin()
        for motor in self._motors:
            motor.target = 0.0

    def _aim(self, forward: float, turn: float) -> None:
        """Sets the rims' speeds: those of a body that goes at m/s and turns at rad/s."""
        turn = -turn if self._reverse else turn
        self._target = [
            forward + sign * turn * pair.separation / 2 for pair in self._pairs for sign in (-1, 1)
        ]

    def _turn_wheels(self, seconds: float) -> None:
        """Ramps the rim speeds towards the command; integrates the encoders."""
        ramp = self._acceleration
        limit = ramp * seconds
        for index, motor in enumerate(self._motors):
            target, ramped = self._target[index], self._ramped[index]
            if target != ramped:
                ramped = ramped + min(max(target - ramped, -limit), limit) if ramp > 0 else target
                self._ramped[index] = ramped
            motor.command(ramped / self._radii[index])
        if self._encoded:
            self._reckon(seconds)

    def _reckon(self, seconds: float) -> None:
        self._reckoning.read(seconds)

    def _motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        return self._reckoning.motion() if self._encoded else super()._motion()
