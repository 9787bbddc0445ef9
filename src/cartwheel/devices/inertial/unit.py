"""Measurements of an inertial measurement unit on a link, without a topic (REP 145)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cartwheel.devices.noise import VectorNoise, VectorNoiseConfig
from cartwheel.errors import Origin
from cartwheel.geometry import IDENTITY, Pose, Quat, matrix_from_quat, quat_multiply
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class InertialUnitConfig:
    link: str
    """Link that carries the IMU."""
    mount: Pose
    """Pose of the IMU in the link."""
    world: Quat = IDENTITY
    """Orientation of the world in the reference frame of measured orientations."""
    has_orientation: bool = True
    """Whether the orientation is measured."""
    rate_noise: VectorNoiseConfig | None = None
    """Noise on the angular velocity, rad/s."""
    acceleration_noise: VectorNoiseConfig | None = None
    """Noise on the acceleration, m/s²."""


class InertialUnit:
    """Measures angular velocity, proper acceleration and orientation of an IMU on a link.

    Angular velocity and acceleration are in the IMU frame.

    Args:
        part: The model's part of the simulation.
        config: Link, mounting and noise.
        origin: File and line for the error about an unknown link.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(
        self, part: Part, config: InertialUnitConfig, *, origin: Origin | None = None
    ) -> None:
        self._link = part.link(config.link, origin=origin)
        self._mount = config.mount
        self._rotation = matrix_from_quat(config.mount.orientation).T.tolist()
        self._aligned = config.mount.orientation == IDENTITY
        self._world = config.world
        self.has_orientation = config.has_orientation
        """Whether orientation is measured; otherwise `measure` returns the identity."""
        self.rate_noise, self.acceleration_noise = (
            VectorNoise(part, noise) if noise is not None else None
            for noise in (config.rate_noise, config.acceleration_noise)
        )

    def measure(self) -> tuple[Quat, Sequence[float], Sequence[float]]:
        """Returns orientation, angular velocity (rad/s) and proper acceleration (m/s²), with noise.

        The orientation is relative to the reference frame. It has no noise.
        """
        orientation = IDENTITY
        if self.has_orientation:
            orientation = self._link.turn() if self._aligned else self.orientation
            if self._world != IDENTITY:
                orientation = quat_multiply(self._world, orientation)
        # Only the acceleration depends on the position on the link, which is rigid.
        rates = self.rates()
        acceleration = self._rotated(self._link.felt(self._mount.position))
        if self.acceleration_noise is not None:
            acceleration = self.acceleration_noise.add(acceleration)
        return orientation, rates, acceleration

    @property
    def orientation(self) -> Quat:
        """True orientation of the IMU in the world."""
        link = self._link.turn()
        return link if self._aligned else quat_multiply(link, self._mount.orientation)

    @property
    def gravity(self) -> Sequence[float]:
        """Gravity in the world frame, m/s²."""
        return self._link.gravity

    def rates(self) -> Sequence[float]:
        """Angular velocity in the IMU frame with the sensor's noise, rad/s."""
        _, angular = self._link.motion(local=True)
        rates = self._rotated(angular)
        return rates if self.rate_noise is None else self.rate_noise.add(rates)

    def _rotated(self, vector: Sequence[float]) -> Sequence[float]:
        """Transforms a vector from the link frame to the IMU frame."""
        if self._aligned:
            return vector
        x, y, z = vector
        return [a * x + b * y + c * z for a, b, c in self._rotation]
