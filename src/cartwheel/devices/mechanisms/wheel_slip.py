"""Wheels that slip in proportion to the friction force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, atan2, where
from cartwheel.errors import Origin
from cartwheel.graph import ReconfigureParameter
from cartwheel.messages import message_class
from cartwheel.simulation.dynamics.wheel_slip import SlipHandle
from cartwheel.simulation.handles import JointHandle

_MESSAGE = "gazebo_msgs/msg/WheelSlip"
_DIRECTIONS = ("lateral", "longitudinal")
_PARAMETERS = tuple(
    ReconfigureParameter(
        name=f"slip_compliance_unitless_{direction}",
        type="double",
        default=-1.0,
        minimum=-1.0,
        maximum=20.0,
        level=0,
        description=f"Slip ratio at a friction force equal to the normal force, {direction}",
    )
    for direction in _DIRECTIONS
)


@dataclass(frozen=True, kw_only=True, slots=True)
class SlippingWheelConfig:
    """Configuration of a wheel."""

    link: str
    radius: float
    """m."""
    normal_force: float
    """N."""
    lateral: float
    """Lateral slip ratio at a friction force equal to the normal force."""
    longitudinal: float
    """Longitudinal slip ratio at a friction force equal to the normal force."""
    origin: Origin | None = None
    """File and line of the wheel."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelSlipConfig:
    wheels: tuple[SlippingWheelConfig, ...]
    topic: str | None = None
    """Topic of the slip of each wheel. None: not published."""
    rate: float = 0.0
    """Publish rate, Hz; 0: every step."""
    tolerance: float
    """Below this rim speed in m/s, the published slip is 0."""
    reconfigured_as: str | None = None
    """Name under which the compliances of all wheels can be changed. None: they are constant."""


@dataclass(kw_only=True, slots=True)
class _Wheel:
    link: str
    joint: JointHandle
    slip: SlipHandle
    normal_force: float
    compliance: dict[str, float]
    """Lateral and longitudinal slip ratio at a friction force equal to the normal force."""


class WheelSlip(Component):
    """Makes wheels slip in proportion to the friction force, and publishes their slip.

    Args:
        scope: The model and names.
        config: Wheels and topic.

    Raises:
        UnknownNameError: A wheel does not exist.
    """

    def __init__(self, scope: Scope, config: WheelSlipConfig) -> None:
        super().__init__(scope)
        self._tolerance = config.tolerance
        self._wheels = [self._wheel(wheel) for wheel in config.wheels]
        self.part.schedule(0, before=self._apply)
        if config.topic is not None:
            self._WheelSlip = message_class(_MESSAGE)
            self._publisher = self.advertise(config.topic, _MESSAGE, rate=config.rate or None)
            self.part.schedule(config.rate, after=self._publish, topics=self.publishers)
        if config.reconfigured_as is not None:
            self.reconfigure(config.reconfigured_as, _PARAMETERS, self._on_change)

    def _wheel(self, config: SlippingWheelConfig) -> _Wheel:
        part = self.part
        slip = part.slip(config.link, radius=config.radius, origin=config.origin)
        joint = next(each for each in part.description.joints if each.child == config.link)
        return _Wheel(
            link=config.link,
            joint=part.joint(joint.name, origin=config.origin),
            slip=slip,
            normal_force=config.normal_force,
            compliance={"lateral": config.lateral, "longitudinal": config.longitudinal},
        )

    def _on_change(self, values: Mapping[str, Any]) -> None:
        for direction in _DIRECTIONS:
            value = float(values[f"slip_compliance_unitless_{direction}"])
            if value >= 0:
                for wheel in self._wheels:
                    wheel.compliance[direction] = value

    def _apply(self) -> None:
        for wheel in self._wheels:
            factor = compliance_factor(wheel.joint.velocity, wheel.slip.radius, wheel.normal_force)
            wheel.slip.give(*(factor * wheel.compliance[direction] for direction in _DIRECTIONS))

    def _publish(self) -> None:
        names, lateral, longitudinal = [], [], []
        for wheel in self._wheels:
            rim_speed = wheel.joint.velocity * wheel.slip.radius
            angle, fraction = slip_of(rim_speed, *wheel.slip.speeds, self._tolerance)
            names.append(wheel.link)
            lateral.append(angle)
            longitudinal.append(fraction)
        self._publisher.publish(self._WheelSlip(names, np.array(lateral), np.array(longitudinal)))


def compliance_factor(velocity: Number, radius: float, normal_force: float) -> Number:
    """Returns the slip compliance for a slip ratio of 1, m/s/N.

    Args:
        velocity: Velocity of the wheel's joint, rad/s.
        radius: Radius of the wheel, m.
        normal_force: Force at which this ratio applies, N.
    """
    return abs(velocity) * radius / normal_force


def slip_of(
    rim_speed: Number, lateral: Number, longitudinal: Number, tolerance: float
) -> tuple[Number, Number]:
    """Returns the lateral slip as an angle in rad, and the longitudinal slip as a fraction.

    Args:
        rim_speed: Speed of the rim relative to the axle, m/s.
        lateral: Slip velocity of the rim along the axle, m/s.
        longitudinal: Slip velocity of the rim forward, m/s.
        tolerance: Rim speed below which the slip is 0, m/s.
    """
    still = abs(rim_speed) < tolerance
    divisor = where(rim_speed == 0, 1.0, rim_speed)
    return (
        where(still, 0.0, atan2(lateral, rim_speed - longitudinal)),
        where(still, 0.0, longitudinal / divisor),
    )
