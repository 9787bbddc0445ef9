"""``gz-sim-mecanum-drive-system``: four mecanum wheels, which also move the robot sideways."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.drives.limiter import Limiter
from cartwheel.devices.drives.odometry import Odometry
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.drives.rollers import has_rollers
from cartwheel.dialects.gz.drive_tags import (
    GzCommonLimits,
    common_limits,
    gz_name,
    gz_odometry,
    report_limits,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag

CONTROL_RATE = 100.0
"""Rate in Hz at which limits are applied and the wheel rotation is integrated."""
_CORNERS = ("front_left", "front_right", "back_left", "back_right")
_SIDEWAYS = (-1.0, 1.0, 1.0, -1.0)
_LEFT_RIGHT = (-1.0, 1.0, -1.0, 1.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class MecanumParameters(GzCommonLimits):
    front_left: tuple[str, ...] = tag(
        "front_left_joint",
        default=("front_left_joint",),
        doc="Joint of the front left wheel. Repeat the tag for additional wheels.",
    )
    front_right: tuple[str, ...] = tag(
        "front_right_joint",
        default=("front_right_joint",),
        doc="Joint of the front right wheel. Repeat the tag for additional wheels.",
    )
    back_left: tuple[str, ...] = tag(
        "back_left_joint",
        default=("back_left_joint",),
        doc="Joint of the back left wheel. Repeat the tag for additional wheels.",
    )
    back_right: tuple[str, ...] = tag(
        "back_right_joint",
        default=("back_right_joint",),
        doc="Joint of the back right wheel. Repeat the tag for additional wheels.",
    )
    wheel_base: float = tag(
        "wheelbase", default=1.0, unit="m", doc="Distance between the front and back axles."
    )
    wheel_separation: float = tag(
        "wheel_separation", default=1.0, unit="m", doc="Distance between the left and right wheels."
    )
    wheel_radius: float = tag("wheel_radius", default=0.2, unit="m", doc="Radius of all wheels.")


class MecanumDrive(Plugin[MecanumParameters]):
    """Drives four mecanum wheels from Twist commands and publishes odometry.

    If the wheel collisions model rollers (``<fdir1 gz:expressed_in="...">`` with different ``<mu>``
    and ``<mu2>``), friction moves the robot. Otherwise, a servo pushes the robot, as with
    ``libgazebo_ros_planar_move.so``, and the wheels turn at the corresponding speeds.

    The odometry is computed from the rotation of the wheels. Original plugin: ``MecanumDrive`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-mecanum-drive-system",)
    parameters: ClassVar[type] = MecanumParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_lengths(
            wheelbase=config.wheel_base,
            wheel_separation=config.wheel_separation,
            wheel_radius=config.wheel_radius,
        )
        report_limits(self, config)
        self._limiters = [Limiter(common_limits(config)) for _ in range(3)]
        self._wheels = [
            [(part.joint(name, origin=origin), part.velocity_motor(name, max_effort=None))
             for name in getattr(config, corner)]
            for corner in _CORNERS
        ]  # fmt: skip
        rolls = has_rollers(part.description)
        self._drive = None if rolls else part.body_drive(origin=origin)
        self._reach = (config.wheel_base + config.wheel_separation) / 2
        self._reckoning = DeadReckoning()
        self._odometry = self.add(Odometry(self.scope, gz_odometry(self, config)))
        self.subscribe(
            gz_name(self, config.topic, "cmd_vel"), "geometry_msgs/msg/Twist", self._on_command
        )
        part.schedule(CONTROL_RATE, before=self._control)
        part.schedule(config.rate, after=self._publish, active=self._odometry.wanted)
        self.reset()

    def reset(self) -> None:
        self._command = (0.0, 0.0, 0.0)
        for limiter in self._limiters:
            limiter.reset()
        self._turned: list[float] | None = None
        self._updated_ns = 0
        self._reckoning.restart()
        self._push(0.0, 0.0, 0.0)

    def _on_command(self, message: Any) -> None:
        forward, sideways = float(message.linear.x), float(message.linear.y)
        turn = float(message.angular.z)
        self._command = (forward, sideways, turn)

    def _push(self, forward: float, sideways: float, turn: float) -> None:
        if self._drive is not None:
            self._drive.command((forward, sideways, None), (None, None, turn))

    def _control(self) -> None:
        forward, sideways, turn = (
            limiter.step(wanted, 1 / CONTROL_RATE)
            for limiter, wanted in zip(self._limiters, self._command, strict=True)
        )
        self._push(forward, sideways, turn)
        radius = self.config.wheel_radius
        for wheels, across, side in zip(self._wheels, _SIDEWAYS, _LEFT_RIGHT, strict=True):
            speed = (forward + across * sideways + side * self._reach * turn) / radius
            for _, motor in wheels:
                motor.command(speed)
        self._integrate(radius)

    def _integrate(self, radius: float) -> None:
        """Updates the odometry from the rotation of the first wheel at each corner."""
        now = self.part.time_ns
        turned = [wheels[0][0].position * radius for wheels in self._wheels]
        if self._turned is not None:
            ways = [new - old for new, old in zip(turned, self._turned, strict=True)]
            across = sum(sign * way for sign, way in zip(_SIDEWAYS, ways, strict=True)) / 4
            around = sum(sign * way for sign, way in zip(_LEFT_RIGHT, ways, strict=True)) / 4
            self._reckoning.go(
                sum(ways) / 4,
                around / self._reach,
                (now - self._updated_ns) * 1e-9,
                sideways=across,
            )
        self._turned, self._updated_ns = turned, now

    def _publish(self) -> None:
        self._odometry.publish(self.part.time_ns, *self._reckoning.motion())
