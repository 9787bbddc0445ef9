"""A quadrotor that follows velocities, without propellers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.air.velocity_control import Motion, VelocityControl, VelocityControlConfig
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Vec3
from cartwheel.messages import message_class

_TWIST = "geometry_msgs/msg/Twist"
_EMPTY = "std_srvs/srv/Empty"
_WRENCH = "geometry_msgs/msg/Wrench"
_CLIMBS = 0.1
"""Vertical velocity above which the motors are switched on, and within which it stands, m/s."""
_ON_GROUND = -1.0
"""Integral of the vertical velocity's error below which it stands on the ground, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SimpleQuadrotorConfig:
    control: VelocityControlConfig
    topic: str
    """Topic of the commands (Twist)."""
    wrench_topic: str
    """Topic of the force and the torque (Wrench); empty: not published."""
    rate: float
    """Rate of the controllers, Hz; 0: every step."""
    switches_itself: bool
    """Whether commands to climb and to descend switch the motors on and off."""


class SimpleQuadrotor(Component):
    """Follows the velocities of commands in level axes while its motors are on.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: SimpleQuadrotorConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._flight = VelocityControl(scope, config.control)
        self._Wrench = message_class(_WRENCH)
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._wrenches = (
            self.advertise(config.wrench_topic, _WRENCH) if config.wrench_topic else None
        )
        self.subscribe(config.topic, _TWIST, self._on_command)
        for name, on in (("engage", True), ("shutdown", False)):
            self.serve(name, _EMPTY, self._switch(on))
        self._clear()
        self.part.schedule(config.rate, before=self._control)
        if config.rate > 0:
            self.part.schedule(0, before=self._hold)

    def reset(self) -> None:
        super().reset()
        self._flight.reset()
        self._clear()

    def _clear(self) -> None:
        self._command = message_class(_TWIST)(*(self._Vector3(0.0, 0.0, 0.0) for _ in range(2)))
        self._on = False
        self._elapsed = Elapsed()
        self._force, self._torque = 0.0, (0.0, 0.0, 0.0)

    def _on_command(self, command: Any) -> None:
        self._command = command

    def _switch(self, on: bool) -> Any:
        def switch(_: Any) -> Any:
            self._on = on
            return message_class(f"{_EMPTY}_Response")()

        return switch

    def _control(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        motion = self._flight.motion(seconds)
        if self._config.switches_itself:
            self._switch_itself(motion)
        self._force, self._torque = 0.0, (0.0, 0.0, 0.0)
        if self._on:
            self._force, self._torque = self._follow(motion, seconds)
        else:
            self._flight.restart()
        self._flight.apply(self._force, self._torque)
        self._publish()

    def _hold(self) -> None:
        """Applies the last force between two updates, in the axes of the link."""
        self.part.locate()
        self._flight.apply(self._force, self._torque)

    def _switch_itself(self, motion: Motion) -> None:
        climb = self._command.linear.z
        if not self._on:
            self._on = climb > _CLIMBS
        elif climb < -_CLIMBS and abs(motion.velocity[2]) < _CLIMBS:
            self._on = self._flight.climb.integral >= _ON_GROUND

    def _follow(self, motion: Motion, seconds: float) -> tuple[float, Vec3]:
        """Returns the force along z and the torque that follow the command."""
        flight, linear = self._flight, self._command.linear
        x, y, _ = flight.tilt_for(motion, linear.x, linear.y, seconds)
        z = flight.turn(motion, self._command.angular.z, seconds)
        return flight.lift(motion, linear.z, seconds), (x, y, z)

    def _publish(self) -> None:
        if self._wrenches is not None and self._wrenches.wanted:
            force = self._Vector3(0.0, 0.0, self._force)
            self._wrenches.publish(self._Wrench(force, self._Vector3(*self._torque)))
