"""Lift and drag of a wing, a rotor blade or a control surface."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.geometry import Vec3, cross_product, rotate

_STILL = 0.01
"""Airspeed below which there is no lift and no drag, m/s, as in gz-sim."""
_ZERO: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class AirfoilConfig:
    """Coefficients of an airfoil."""

    area: float
    """Area of the surface, m²."""
    air_density: float
    """kg/m³."""
    zero_angle: float
    """Angle of attack while the airfoil moves along its forward direction, rad."""
    lift_slope: float
    """Change of the lift coefficient per angle of attack, 1/rad."""
    drag_slope: float
    """Change of the drag coefficient per angle of attack, 1/rad."""
    stall_angle: float
    """Angle of attack at which the flow separates, rad."""
    stalled_lift_slope: float
    """Change of the lift coefficient beyond the stall angle, 1/rad."""
    stalled_drag_slope: float
    """Change of the drag coefficient beyond the stall angle, 1/rad."""
    radial: bool = False
    """Whether the airfoil is symmetric about its forward axis, such as a fuselage."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LiftDragConfig:
    link: str
    """Link of the airfoil."""
    airfoil: AirfoilConfig
    centre: Vec3
    """Centre of pressure in the link, m."""
    forward: Vec3
    """Direction of motion without angle of attack, in the link; normalized."""
    upward: Vec3
    """Direction of positive lift, in the link; normalized."""
    control_joint: str = ""
    """Joint of a control surface; empty: none."""
    control_slope: float = 0.0
    """Change of the lift coefficient per angle of the control joint, 1/rad."""


class LiftDrag(Component):
    """Applies lift and drag to a link at its centre of pressure, at every step.

    Raises:
        UnknownNameError: The link or the joint does not exist.
    """

    def __init__(self, scope: Scope, config: LiftDragConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        self._joint = (
            part.joint(config.control_joint, origin=origin) if config.control_joint else None
        )
        description = part.description.link(config.link)
        assert description is not None
        cx, cy, cz = config.centre
        mx, my, mz = description.mass_centre
        self._arm = (cx - mx, cy - my, cz - mz)
        part.schedule(0, before=self._apply)

    def _apply(self) -> None:
        config, link = self._config, self._link
        self.part.locate()
        (x, y, z), orientation = link.place()
        cx, cy, cz = rotate(orientation, config.centre)
        velocity, _ = link.motion_at((x + cx, y + cy, z + cz))
        deflection = self._joint.position if self._joint is not None else 0.0
        force = aerodynamic_force(
            config.airfoil,
            velocity=velocity,
            forward=rotate(orientation, config.forward),
            upward=rotate(orientation, config.upward),
            more_lift=config.control_slope * deflection,
        )
        self._wrench.apply(force, cross_product(rotate(orientation, self._arm), force))


def aerodynamic_force(
    airfoil: AirfoilConfig,
    *,
    velocity: Vec3,
    forward: Vec3,
    upward: Vec3,
    more_lift: float = 0.0,
) -> Vec3:
    """Returns lift and drag in still air, N, in the axes of the arguments.

    Source: the system ``LiftDrag`` of gz-sim.

    Args:
        airfoil: The coefficients.
        velocity: Velocity of the centre of pressure, m/s.
        forward: Direction of motion without angle of attack; normalized.
        upward: Direction of positive lift; normalized.
        more_lift: Is added to the lift coefficient.
    """
    speed = math.hypot(*velocity)
    if speed <= _STILL:
        return _ZERO
    if airfoil.radial:
        # The component of the airflow across the axis selects the upward direction.
        upward = _unit(cross_product(forward, cross_product(forward, velocity)))
    span = _unit(cross_product(forward, upward))
    along_span = _dot(velocity, span)
    vx, vy, vz = velocity
    sx, sy, sz = span
    flow = (vx - along_span * sx, vy - along_span * sy, vz - along_span * sz)
    flow_speed = math.hypot(*flow)
    if span == _ZERO or flow_speed <= 0.0:
        return _ZERO
    # gz-sim uses the square of the cosine of the sweep.
    sweep = 1.0 - min(1.0, (along_span / speed) ** 2)
    lift_axis = _unit(cross_product(span, flow))
    alpha = math.acos(min(1.0, max(-1.0, _dot(lift_axis, upward))))
    if _dot(lift_axis, forward) < 0.0:
        alpha = -alpha
    # Between -pi/2 and pi/2.
    alpha = math.remainder(airfoil.zero_angle + alpha, math.pi)
    lift, drag = coefficients(airfoil, alpha)
    pressure = 0.5 * airfoil.air_density * airfoil.area
    up = pressure * flow_speed * flow_speed * (lift * sweep + more_lift)
    back = pressure * flow_speed * drag * sweep
    (lx, ly, lz), (fx, fy, fz) = lift_axis, flow
    return (up * lx - back * fx, up * ly - back * fy, up * lz - back * fz)


def coefficients(airfoil: AirfoilConfig, alpha: float) -> tuple[float, float]:
    """Returns the coefficients of lift and drag at an angle of attack between -pi/2 and pi/2."""
    stall = airfoil.stall_angle
    beyond = max(abs(alpha) - stall, 0.0)
    within = min(abs(alpha), stall)
    lift = airfoil.lift_slope * within + airfoil.stalled_lift_slope * beyond
    if beyond > 0.0:
        lift = max(0.0, lift)
    drag = airfoil.drag_slope * within + airfoil.stalled_drag_slope * beyond
    return (lift if alpha >= 0 else -lift), abs(drag)


# Plain tuples: for three numbers, numpy takes ten times as long.


def _dot(a: Vec3, b: Vec3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _unit(vector: Vec3) -> Vec3:
    """Returns the normalized vector, or zeros for a vector of length 0."""
    length = math.hypot(*vector)
    if length == 0.0:
        return _ZERO
    x, y, z = vector
    return (x / length, y / length, z / length)
