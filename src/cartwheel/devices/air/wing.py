"""Forces and moments of a wing or an aeroplane by its stability derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.geometry import Array, Vec3, cross, matrix_from_quat

_SLOWEST = 1e-9
"""Airspeed below which there is no force, m/s."""
_SHARPNESS = 15.0
"""Sharpness of the transition to the stall, 1/rad."""
_STEEPEST = 300.0
"""Largest exponent."""
_PLATE = (-0.224, -0.115)
"""Coefficients of the drag of a flat plate, by its aspect ratio."""
LIFT, DRAG, SIDE, ROLL, PITCH, YAW = range(6)
"""Order of the coefficients: three forces and three moments."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ControlSurfaceConfig:
    """A control surface of a `Wing`."""

    joint: str
    effects: Array
    """Change of each coefficient per degree of the joint, shape (6,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WingConfig:
    """Configuration of a `Wing`. The order of the six coefficients is lift, drag and side force,
    and roll, pitch and yaw moment.
    """

    link: str
    area: float
    """m²."""
    aspect_ratio: float
    """Span divided by the mean chord."""
    chord: float
    """Mean aerodynamic chord, m."""
    efficiency: float
    """Oswald's efficiency factor."""
    air_density: float
    """kg/m³."""
    centre: Vec3
    """Centre of pressure in the link, m."""
    forward: Vec3
    """Direction of flight without angle of attack, in the link; normalized."""
    upward: Vec3
    """Direction of positive lift, in the link; normalized."""
    stall_angle: float
    """Angle of attack at which the flow separates, rad."""
    lift: float
    """Coefficient of lift without angle of attack."""
    drag: float
    """Coefficient of drag without lift."""
    by_attack: Array
    """Change of each coefficient per angle of attack, shape (6,), 1/rad. That of the drag has no
    effect, because the drag follows from the lift."""
    by_sideslip: Array
    """The same per angle of sideslip, 1/rad."""
    by_rates: Array
    """The same per roll, pitch and yaw rate, shape (6, 3). The rates are multiplied by half the
    span or chord and divided by the airspeed."""
    surfaces: tuple[ControlSurfaceConfig, ...] = field(default=())

    @property
    def span(self) -> float:
        """m."""
        return math.sqrt(self.area * self.aspect_ratio)


class Wing(Component):
    """Applies the forces and the moments of still air to a link, at every step.

    Source: AdvancedLiftDrag of gz-sim.

    Raises:
        UnknownNameError: The link or a joint does not exist.
    """

    def __init__(self, scope: Scope, config: WingConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        self._joints = [part.joint(each.joint, origin=origin) for each in config.surfaces]
        description = part.description.link(config.link)
        assert description is not None
        self._arm = np.array(config.centre) - np.array(description.mass_centre)
        part.schedule(0, before=self._apply)

    def _apply(self) -> None:
        config, link = self._config, self._link
        self.part.locate()
        _, orientation = link.place()
        linear, angular = link.motion(local=True)
        effects = np.zeros(6)
        for joint, surface in zip(self._joints, config.surfaces, strict=True):
            effects += math.degrees(joint.position) * surface.effects
        velocity = np.array(linear) + cross(angular, config.centre)
        force, moment = air_loads(config, velocity, np.array(angular), effects)
        torque = moment + cross(self._arm, force)
        axes = matrix_from_quat(orientation)
        self._wrench.apply((axes @ force).tolist(), (axes @ torque).tolist())


def air_loads(
    config: WingConfig, velocity: Array, rates: Array, controls: Array
) -> tuple[Array, Array]:
    """Returns the force at the centre of pressure in N and the moment in N m, in the link's axes.

    Args:
        config: The coefficients.
        velocity: Velocity of the centre of pressure relative to the air, m/s, shape (3,).
        rates: Angular velocity, rad/s, shape (3,).
        controls: What the control surfaces add to each coefficient, shape (6,).
    """
    ahead, down = np.array(config.forward), -np.array(config.upward)
    right = cross(down, ahead)
    flow = velocity - (velocity @ right) * right
    speed = float(np.linalg.norm(flow))
    if speed <= _SLOWEST:
        return np.zeros(3), np.zeros(3)
    along = flow / speed
    attack = math.atan2(float(along @ down), float(along @ ahead))
    sideslip = math.atan2(float(velocity @ right), float(velocity @ ahead))
    span, chord = config.span, config.chord
    # The link's y and z axes point to the left and up, unlike those of aviation.
    half = np.array([rates[0] * span, -rates[1] * chord, -rates[2] * span]) / 2
    loads = coefficients(config, attack, sideslip, controls) + config.by_rates @ half / speed
    loads = loads * 0.5 * config.air_density * speed * speed * config.area
    force: Array = -loads[LIFT] * cross(along, right) - loads[DRAG] * along + loads[SIDE] * right
    moment: Array = (
        loads[ROLL] * span * ahead + loads[PITCH] * chord * right + loads[YAW] * span * down
    )
    return force, moment


def coefficients(config: WingConfig, attack: float, sideslip: float, controls: Array) -> Array:
    """Returns the coefficients without the effect of rates, shape (6,).

    Beyond the stall angle, the lift is that of a flat plate, and so is the drag.

    Args:
        config: The coefficients.
        attack: Angle of attack, rad.
        sideslip: Angle of sideslip, rad.
        controls: As for `air_loads`.
    """
    found: Array = config.by_attack * attack + config.by_sideslip * sideslip + controls
    stalled = stalled_share(attack, config.stall_angle)
    sine, cosine = math.sin(attack), math.cos(attack)
    plate = math.copysign(2 * sine * sine * cosine, attack * cosine)
    attached = config.lift + config.by_attack[LIFT] * attack
    found[LIFT] += (1 - stalled) * attached + stalled * plate - config.by_attack[LIFT] * attack
    k1, k2 = _PLATE
    ratio = config.aspect_ratio
    flat = 2 / (1 + math.exp(k1 + k2 * max(ratio, 1 / ratio)))
    induced = found[LIFT] ** 2 / (math.pi * ratio * config.efficiency)
    found[DRAG] = (
        (1 - stalled) * (config.drag + induced)
        + stalled * abs(flat * (1 - math.cos(2 * attack)) / 2)
        + controls[DRAG]
    )
    return found


def stalled_share(attack: float, stall: float) -> float:
    """How far the flow has separated: 0 below the stall angle in rad, 1 above it."""
    low, high = (
        math.exp(min(max(_SHARPNESS * each, -_STEEPEST), _STEEPEST))
        for each in (stall - attack, stall + attack)
    )
    return (1 + low + high) / ((1 + low) * (1 + high))
