"""Moves a whole model at the velocity of Twist commands, without wheels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.timeouts import CommandTimeouts
from cartwheel.geometry import Vec3

_AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyVelocityConfig:
    topic: str
    """Topic of the Twist commands."""
    motion: Literal["planar", "spatial"] = "planar"
    """``planar``: ``linear.x``, ``linear.y`` and ``angular.z`` are followed, in axes that follow
    only the model's heading. ``spatial``: all six components are followed, in the model's axes."""
    initial: tuple[Vec3, Vec3] | None = _AT_REST
    """Linear and angular velocity before the first command, m/s and rad/s. None: the model moves
    freely."""
    timeout: float | None = None
    """Time after which the model stops without a command, s. None: never."""
    sideways: bool = True
    """Whether ``linear.y`` is followed; otherwise, it is 0."""
    pushed: tuple[str, ...] = ()
    """Links that are fixed to the root link, at whose centre of mass the force acts. Empty: at that
    of the model."""
    gains: tuple[float, float] | None = None
    """Force per velocity error, N s/m, and torque per angular velocity error, N m s/rad. None: as
    stiff as possible, with a force of at most five times the model's weight."""


class BodyVelocity(Component):
    """Holds a model at the velocity of the last Twist command.

    Raises:
        PluginError: The model cannot move, or has no mass.
    """

    def __init__(self, scope: Scope, config: BodyVelocityConfig) -> None:
        super().__init__(scope)
        self._config = config
        # Forces with gains tilt a model; a velocity that is set does not.
        upright = config.motion == "planar" and config.gains is None
        self._servo = self.part.body_drive(
            gains=config.gains, upright=upright, at=config.pushed, origin=self.origin
        )
        self.subscribe(config.topic, "geometry_msgs/msg/Twist", self._on_command)
        if config.timeout is not None:
            self.shared.get(CommandTimeouts).set(self.node, config.timeout)
            self.part.schedule(0, before=self._stop_after_timeout)
        self.reset()

    def reset(self) -> None:
        self._received_ns: int | None = None
        if self._config.initial is None:
            self._servo.release()
        else:
            self._hold(*self._config.initial)

    def _on_command(self, message: Any) -> None:
        self._received_ns = self.part.time_ns
        linear, angular = message.linear, message.angular
        self._hold(
            (float(linear.x), float(linear.y) * self._config.sideways, float(linear.z)),
            (float(angular.x), float(angular.y), float(angular.z)),
        )

    def _hold(self, linear: Vec3, angular: Vec3) -> None:
        if self._config.motion == "planar":
            self._servo.command((linear[0], linear[1], None), (None, None, angular[2]))
        else:
            self._servo.command(linear, angular, level=False)

    def _stop_after_timeout(self) -> None:
        received_ns, timeout = self._received_ns, self._config.timeout
        if received_ns is None or timeout is None:
            return
        if (self.part.time_ns - received_ns) * 1e-9 > timeout:
            self._received_ns = None
            self._hold(*_AT_REST)
