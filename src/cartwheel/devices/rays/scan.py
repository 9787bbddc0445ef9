"""Scans: their directions, their measurement and their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cartwheel.devices.noise import Noise, VectorNoise, VectorNoiseConfig, quantize
from cartwheel.geometry import Array, Pose
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Sweep:
    """Evenly spaced angles from first to last. If last is smaller than first, they decrease."""

    count: int
    first: float
    """rad."""
    last: float
    """rad."""

    @property
    def step(self) -> float:
        """Angle between neighbours, rad; 0 for a single angle."""
        return (self.last - self.first) / (self.count - 1) if self.count > 1 else 0.0

    def angles(self) -> Array:
        """All angles, rad, shape (count,)."""
        return np.linspace(self.first, self.last, self.count)


LEVEL = Sweep(count=1, first=0.0, last=0.0)
"""The only row of a planar scan."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ScanPattern:
    """Directions, limits and noise of a scan."""

    horizontal: Sweep
    vertical: Sweep = LEVEL
    minimum: float
    """Minimum range, m."""
    maximum: float
    """Maximum range, m; may be inf."""
    noise: Noise
    """Noise on each range, m. All rays share its mean and bias."""

    @property
    def field_of_view(self) -> tuple[float, float]:
        """Horizontal and vertical, rad."""
        return (
            abs(self.horizontal.last - self.horizontal.first),
            abs(self.vertical.last - self.vertical.first),
        )

    def directions(self) -> Array:
        """Unit vectors, x forward, z up, shape (rows, columns, 3), starting with the lowest row."""
        azimuth, elevation = np.meshgrid(self.horizontal.angles(), self.vertical.angles())
        level = np.cos(elevation)
        return np.stack(
            [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Scan:
    """One measurement, row by row, starting with the lowest row."""

    ranges: Array
    """Ranges in m, shape (rows, columns): -inf below the minimum range, inf if nothing is within
    the maximum range (REP 117)."""
    intensities: Array
    """Reflectivities of the objects hit, shape (rows, columns)."""

    def points(self, directions: Array) -> Array:
        """Points hit in the sensor frame, m, shape (rows, columns, 3).

        Points without a finite range are infinite.
        """
        # An infinite range times a direction of 0 would be NaN.
        missing = ~np.isfinite(self.ranges)
        points: Array = directions * np.where(missing, 1.0, self.ranges)[..., None]
        points[missing] = np.inf
        return points


@dataclass(frozen=True, kw_only=True, slots=True)
class ScannerConfig:
    """Where a scanner is mounted, and what it measures."""

    name: str
    """Name of the scanner's random numbers, unique in the model."""
    link: str
    pose: Pose
    """Pose in the link."""
    pattern: ScanPattern
    visuals: bool = False
    """Whether rays hit the visual geometry instead of the collision geometry."""
    rate: float = 0.0
    """Measurement rate, Hz; 0: every step."""


class Scanner:
    """Measures scans.

    Args:
        part: The model's part of the simulation.
        config: Mounting and pattern.
    """

    def __init__(self, part: Part, config: ScannerConfig) -> None:
        pattern = config.pattern
        self.pattern = pattern
        self._part = part
        self._name = f"scan {config.name}"
        self._noisy = pattern.noise != Noise()
        self.directions = pattern.directions()
        """Unit vectors, shape (rows, columns, 3)."""
        self._rays = part.rays(
            config.link,
            config.pose,
            self.directions.reshape(-1, 3),
            minimum=pattern.minimum,
            maximum=pattern.maximum,
            visuals=config.visuals,
        )
        self.error = VectorNoise(
            part,
            VectorNoiseConfig(name=self._name, noises=(pattern.noise,), rate=config.rate),
        )
        """Error of a single range. All rays share its mean and bias."""

    def measure(self, *, noisy: bool = True) -> Scan:
        """Measures a scan, with the pattern's noise if `noisy`."""
        ranges, intensities = self._rays.cast()
        if noisy:
            self._add_noise(ranges)
        shape = self.directions.shape[:2]
        return Scan(ranges=ranges.reshape(shape), intensities=intensities.reshape(shape))

    def random(self, purpose: str) -> np.random.Generator:
        """Returns a random generator for the current time and a purpose."""
        return self._part.random(f"{self._name} {purpose}")

    def _add_noise(self, ranges: Array) -> None:
        if not self._noisy:
            return
        noise = self.pattern.noise
        measured = np.isfinite(ranges)
        noisy = ranges + self.error.offset
        if noise.stddev > 0:
            # One number per ray, so that a hit does not change the noise on other rays.
            noisy += self.random("noise").normal(0.0, noise.stddev, ranges.shape)
        if noise.precision > 0:
            noisy = quantize(noisy, noise.precision)
        # Both functions together are faster than `clip`.
        np.maximum(noisy, self.pattern.minimum, out=noisy)
        np.minimum(noisy, self.pattern.maximum, out=noisy)
        np.copyto(ranges, noisy, where=measured)
