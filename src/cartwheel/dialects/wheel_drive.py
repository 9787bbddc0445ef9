"""Drives with pairs of left and right wheels, which turn by their difference in speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cartwheel.codes import devices, robot
from cartwheel.description.kinematics import link_poses
from cartwheel.devices.drives.reckoning import AxleReckoning
from cartwheel.dialects.drive import Drive
from cartwheel.dialects.tags import SMALLEST
from cartwheel.errors import PluginError
from cartwheel.geometry import Quat, Vec3
from cartwheel.simulation.limits import FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelPair:
    """Two wheels on one axle."""

    left: str
    """Joint of the left wheel."""
    right: str
    """Joint of the right wheel."""
    separation: float
    """Distance between the wheels, m."""
    diameter: float
    """Diameter of both wheels, m."""


class WheelDrive(Drive):
    """Base class of plugins that drive pairs of wheels from Twist commands and publish odometry.

    In `configure`, a subclass calls `_take_wheels`, creates its publishers and calls `_run_wheels`.
    """

    def _take_wheels(self, pairs: Sequence[WheelPair], *, torque: float | None) -> None:
        """Obtains joints and motors. `joints` alternates left and right, pair by pair.

        Raises:
            PluginError: A separation or diameter is not allowed.
            UnknownNameError: A joint does not exist.
        """
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
        self.joint_names = tuple(names)
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
        self._check_sides(pairs)

    def _check_sides(self, pairs: Sequence[WheelPair]) -> None:
        """Reports a left wheel on the right side, because the robot then turns the wrong way."""
        description = self.part.description
        poses = link_poses(description, {})
        front = poses[description.canonical_link].inverse()
        for pair in pairs:
            joints = [description.joint(name) for name in (pair.left, pair.right)]
            left, right = ((front @ poses[joint.child]).y for joint in joints if joint is not None)
            if left < right:
                self.warn(
                    robot.WHEELS_SWAPPED,
                    f'the left wheel ("{pair.left}") is to the right of the right wheel '
                    f'("{pair.right}"), so the robot turns the wrong way, as in Gazebo',
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
        """Subscribes to commands and schedules control and publishing; see `Drive`.

        Args:
            command_topic: Topic of the Twist commands.
            base: Link whose ground-truth pose is published if the odometry is not `encoded`.
            encoded: The odometry is dead reckoning from the first pair of wheels.
            control_rate: Rate of the control loop, Hz.
            rate: Publish rate, Hz.
            acceleration: Maximum acceleration of the rims, m/s²; 0: no limit.
            reverse: Invert the turning direction.
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
        """Sets the target rim speeds for a forward velocity in m/s and a yaw rate in rad/s."""
        turn = -turn if self._reverse else turn
        self._target = [
            forward + sign * turn * pair.separation / 2 for pair in self._pairs for sign in (-1, 1)
        ]

    def _turn_wheels(self, seconds: float) -> None:
        """Ramps the rim speeds toward the command and integrates the encoders."""
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
