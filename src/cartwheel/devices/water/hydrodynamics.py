"""Damping and added mass of a body in water."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.air.velocity_control import merged_inertia
from cartwheel.devices.periodic import Elapsed
from cartwheel.geometry import Array, Vec3, cross, quat_conjugate, rotate

_LIGHTEST = 1e-6
"""Least mass in kg and moment of inertia in kg m² with which the forces are computed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HydrodynamicsConfig:
    """Configuration of a `Hydrodynamics`. The order of the axes is that of Fossen: forces along x,
    y and z, then torques about them; linear, then angular velocities.
    """

    link: str
    linear: Array
    """Force per velocity, shape (6, 6). Damping is negative."""
    quadratic: Array
    """Force per velocity and absolute velocity, shape (6, 6, 6)."""
    square: Array
    """Force per product of two velocities, shape (6, 6, 6)."""
    added_mass: Array
    """Mass of the water that moves with the body, shape (6, 6); positive."""
    coriolis: bool
    """Whether the added mass also causes Coriolis and centripetal forces."""
    current: Vec3
    """Initial velocity of the water in the world, m/s."""
    current_topic: str
    """Topic of the velocity of the water (Vector3), m/s. Empty: it is constant."""


class Hydrodynamics(Component):
    """Applies the forces of the surrounding water to a link, at every step.

    Damping and added mass are implicit, so that they are stable for every step length: the forces
    are those at the end of the step, when the body accelerates with its own and the added mass. The
    other forces on the body, which are needed for this, are those of the previous step.

    Args:
        scope: The model.
        config: Link and coefficients.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: HydrodynamicsConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._link = part.link(config.link, origin=origin)
        self._wrench = part.wrench(config.link, origin=origin)
        mass, centre, moments = merged_inertia(part.description, config.link)
        self._mass = mass_matrix(mass, centre, moments)
        description = part.description.link(config.link)
        assert description is not None
        x, y, z = description.mass_centre
        self._to_origin = np.array((-x, -y, -z))
        self.reset()
        if config.current_topic:
            self.subscribe(config.current_topic, "geometry_msgs/msg/Vector3", self._on_current)
        part.schedule(0, before=self._apply)

    def reset(self) -> None:
        super().reset()
        self._current = self._config.current
        self._elapsed = Elapsed()
        self._before: Array | None = None
        self._applied = np.zeros(6)

    def _on_current(self, message: Any) -> None:
        self._current = (message.x, message.y, message.z)

    def _apply(self) -> None:
        seconds = self._elapsed.seconds(self.part.time_ns)
        if seconds <= 0:
            return
        self.part.locate()
        config = self._config
        _, orientation = self._link.place()
        linear, angular = self._link.motion(local=True)
        water = rotate(quat_conjugate(orientation), self._current)
        state = np.array([*linear, *angular])
        state[:3] -= water
        other = np.zeros(6)
        if self._before is not None:
            other = self._mass @ (state - self._before) / seconds - self._applied
        self._before = state
        damping = resistance(config, state)
        steady = -(damping @ state)
        if config.coriolis:
            steady -= coriolis(config.added_mass, state)
        self._applied = wrench = implicit_wrench(
            self._mass,
            added=config.added_mass,
            damping=damping,
            steady=steady,
            other=other,
            seconds=seconds,
        )
        torque = wrench[3:] + cross(self._to_origin, wrench[:3])
        self._wrench.apply(
            rotate(orientation, tuple(wrench[:3].tolist())),
            rotate(orientation, tuple(torque.tolist())),
        )


def resistance(config: HydrodynamicsConfig, state: Array) -> Array:
    """Matrix whose negative product with the velocity is the damping, shape (6, 6).

    Source: T. I. Fossen, Guidance and Control of Ocean Vehicles, 1994, and gz-sim.

    Args:
        config: The coefficients.
        state: Velocity relative to the water in the axes of the link, shape (6,), m/s and rad/s.
    """
    matrix: Array = -(config.linear + config.quadratic @ np.abs(state) + config.square @ state)
    return matrix


def coriolis(added_mass: Array, state: Array) -> Array:
    """The Coriolis and centripetal forces that the added mass resists with, shape (6,).

    Source: T. I. Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2011, eq. 6.43.

    Args:
        added_mass: Shape (6, 6).
        state: As for `resistance`.
    """
    momentum = added_mass @ state
    linear, angular = state[:3], state[3:]
    return np.concatenate(
        [
            cross(angular, momentum[:3]),
            cross(linear, momentum[:3]) + cross(angular, momentum[3:]),
        ]
    )


def implicit_wrench(
    mass: Array,
    *,
    added: Array,
    damping: Array,
    steady: Array,
    other: Array,
    seconds: float,
) -> Array:
    """The force of the water during a step, shape (6,).

    Args:
        mass: The body's own mass matrix, shape (6, 6).
        added: The added mass, shape (6, 6).
        damping: Resistance at the beginning of the step, shape (6, 6).
        steady: Force of the water without acceleration, shape (6,).
        other: All other forces on the body, shape (6,).
        seconds: Length of the step.
    """
    acceleration = np.linalg.solve(mass + added + seconds * damping, other + steady)
    force: Array = mass @ acceleration - other
    return force


def mass_matrix(mass: float, centre: Array, moments: Vec3) -> Array:
    """The mass matrix of a body about the origin of its link, shape (6, 6).

    Args:
        mass: kg.
        centre: Centre of mass in the link, shape (3,), m.
        moments: Moments of inertia about it, kg m².
    """
    mass = max(mass, _LIGHTEST)
    x, y, z = centre
    arm = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = mass * np.eye(3)
    matrix[:3, 3:] = -mass * arm
    matrix[3:, :3] = mass * arm
    matrix[3:, 3:] = np.diag(np.maximum(moments, _LIGHTEST)) - mass * arm @ arm
    return matrix
