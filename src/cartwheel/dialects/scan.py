"""Shared parts of ray sensor plugins: pattern, measurement and noise of a scan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Element, Sensor
from cartwheel.devices.noise import Noise, VectorNoise
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import number
from cartwheel.errors import Diagnostic, Origin, PluginError
from cartwheel.geometry import Array
from cartwheel.simulation import Part

_MOST_RAYS = 1_000_000
"""Maximum number of rays. The densest real sensors have about 300,000; a ray needs 200 bytes."""
_GPU_TYPES = {"gpu_ray", "gpu_lidar"}


@dataclass(frozen=True, kw_only=True, slots=True)
class Sweep:
    """Evenly spaced angles from first to last. If last is smaller than first, they decrease."""

    count: int
    first: float
    last: float
    """rad."""

    @property
    def step(self) -> float:
        """Angle between neighbours, rad; 0 for a single angle."""
        return (self.last - self.first) / (self.count - 1) if self.count > 1 else 0.0

    def angles(self) -> Array:
        """All angles, rad, shape (count,)."""
        return np.linspace(self.first, self.last, self.count)


_LEVEL = Sweep(count=1, first=0.0, last=0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class ScanPattern:
    """Directions, limits and noise of a ray sensor. Source: SDF, ``<ray>`` and ``<lidar>``."""

    horizontal: Sweep
    vertical: Sweep
    minimum: float
    maximum: float
    """m."""
    noise: Noise

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


def read_pattern(sensor: Sensor, report: Callable[[Diagnostic], None]) -> ScanPattern:
    """Reads a sensor's ``<ray>`` or ``<lidar>``, with SDF's defaults.

    Args:
        sensor: The sensor.
        report: Receives diagnostics about values that are adjusted.

    Raises:
        PluginError: The element is missing or invalid.
    """
    ray = sensor.element.find("ray") or sensor.element.find("lidar")
    if ray is None:
        raise PluginError(
            f'sensor "{sensor.name}" has neither <ray> nor <lidar>',
            code=devices.SENSOR_INCOMPLETE,
            origin=sensor.origin,
            values={"sensor": sensor.name, "missing": "ray"},
        )
    across = ray.find("scan/horizontal")
    if across is None:
        raise PluginError(
            f'sensor "{sensor.name}" has no <scan> with a <horizontal>',
            code=devices.SENSOR_INCOMPLETE,
            origin=ray.origin,
            values={"sensor": sensor.name, "missing": "horizontal"},
        )
    horizontal = _sweep(across, report, samples=640)
    upright = ray.find("scan/vertical")
    vertical = _sweep(upright, report, samples=1) if upright is not None else _LEVEL
    if horizontal.count * vertical.count > _MOST_RAYS:
        raise PluginError(
            f"a scan must have at most {_MOST_RAYS:,} rays "
            f"(got {horizontal.count} x {vertical.count})",
            code=devices.SCAN_SAMPLES_INVALID,
            origin=_place(across, "samples"),
            values={"sensor": sensor.name, "parameter": "samples"},
            hint="Lower <samples>.",
        )
    limits = ray.find("range")
    minimum = _number(limits, "min", 0.0)
    maximum = _number(limits, "max", 0.0, endless=True)
    if minimum < 0 or maximum <= minimum:
        raise PluginError(
            f'the range of sensor "{sensor.name}" must satisfy 0 <= <min> < <max> '
            f"(got {minimum:g} m and {maximum:g} m)",
            code=devices.SENSOR_RANGE_INVALID,
            values={"sensor": sensor.name, "min": minimum, "max": maximum},
            origin=limits.origin if limits is not None else ray.origin,
        )
    noise = ray.find("noise") or sensor.element.find("noise")
    return ScanPattern(
        horizontal=horizontal,
        vertical=vertical,
        minimum=minimum,
        maximum=maximum,
        noise=read_noise(noise, report),
    )


def _sweep(element: Element, report: Callable[[Diagnostic], None], *, samples: int) -> Sweep:
    asked = _number(element, "samples", samples)
    resolution = _number(element, "resolution", 1.0)
    first, last = _number(element, "min_angle", 0.0), _number(element, "max_angle", 0.0)
    if not 1 <= asked <= _MOST_RAYS:
        raise PluginError(
            f"<samples> must be from 1 to {_MOST_RAYS:,} (got {asked:g})",
            code=devices.SCAN_SAMPLES_INVALID,
            origin=_place(element, "samples"),
            values={"parameter": "samples", "value": asked},
        )
    if asked != int(asked):
        # Usually the result of a division of angles.
        report(
            devices.SCAN_SAMPLES_INVALID.diagnostic(
                f"<samples> must be a whole number (got {asked:g}), so {int(asked)} is used",
                severity="info",
                origin=_place(element, "samples"),
                values={"parameter": "samples", "value": asked},
            )
        )
        asked = float(int(asked))
    if resolution <= 0:
        raise PluginError(
            f"<resolution> must be positive (got {resolution:g})",
            code=devices.SCAN_SAMPLES_INVALID,
            origin=_place(element, "resolution"),
            hint="Set <resolution> to 1 for one range per sample.",
            values={"parameter": "resolution", "value": resolution},
        )
    if asked * resolution > _MOST_RAYS:
        raise PluginError(
            f"<samples> times <resolution> must be at most {_MOST_RAYS:,} "
            f"(got {asked * resolution:g})",
            code=devices.SCAN_SAMPLES_INVALID,
            origin=_place(element, "resolution"),
            values={"parameter": "resolution", "value": resolution},
        )
    if last < first:
        # As in Gazebo.
        report(
            devices.SCAN_REVERSED.diagnostic(
                f"<max_angle> {last:g} is below <min_angle> {first:g}, so the first ray "
                "is at the larger angle",
                origin=_place(element, "max_angle"),
                values={"first": first, "last": last},
            )
        )
    count = max(1, int(asked * resolution))
    if count == 1:
        first = last = (first + last) / 2
    return Sweep(count=count, first=first, last=last)


def _place(element: Element, tag: str) -> Origin:
    child = element.find(tag)
    return child.origin if child is not None else element.origin


def _number(element: Element | None, tag: str, default: float, *, endless: bool = False) -> float:
    child = element.find(tag) if element is not None else None
    return number(child, endless=endless) if child is not None else default


@dataclass(frozen=True, kw_only=True, slots=True)
class Scan:
    """One measurement, row by row, starting with the lowest row."""

    ranges: Array
    """Ranges in m, shape (rows, columns): -inf below the minimum range, inf if nothing is within
    the maximum range (REP 117)."""
    intensities: Array
    """The laser_retro of the objects hit, shape (rows, columns)."""

    def points(self, directions: Array) -> Array:
        """Points hit in the sensor frame, m, shape (rows, columns, 3).

        Points without a finite range are infinite.
        """
        # An infinite range times a direction of 0 would be NaN.
        missing = ~np.isfinite(self.ranges)
        places: Array = directions * np.where(missing, 1.0, self.ranges)[..., None]
        places[missing] = np.inf
        return places


class Scanner:
    """Measures the scans of a ray sensor.

    Args:
        part: The model's part of the simulation.
        sensor: Sensor with a ``<ray>`` or ``<lidar>``. GPU types detect visuals instead of
            collisions, as in Gazebo.

    Raises:
        PluginError: See `read_pattern`.
    """

    def __init__(self, part: Part, sensor: Sensor) -> None:
        self.pattern = read_pattern(sensor, part.report)
        self._part = part
        self._name = f"scan {sensor.link} {sensor.name}"
        self.directions = self.pattern.directions()
        self._rays = part.rays(
            sensor.link,
            sensor.pose,
            self.directions.reshape(-1, 3),
            minimum=self.pattern.minimum,
            maximum=self.pattern.maximum,
            visuals=sensor.type in _GPU_TYPES,
        )
        self.error = VectorNoise(part, self._name, [self.pattern.noise], rate=sensor.update_rate)
        """Error of a single range. All rays share its mean and bias."""

    def measure(self, *, noisy: bool = True) -> Scan:
        """Measures a scan, with the sensor's own noise if `noisy`."""
        ranges, intensities = self._rays.cast()
        if noisy:
            self._blur(ranges)
        shape = self.directions.shape[:2]
        return Scan(ranges=ranges.reshape(shape), intensities=intensities.reshape(shape))

    def random(self, purpose: str) -> np.random.Generator:
        """Random generator for the current time and a purpose."""
        return self._part.random(f"{self._name} {purpose}")

    def _blur(self, ranges: Array) -> None:
        noise, precision = self.pattern.noise, self.pattern.noise.precision
        if noise == Noise():
            return
        measured = np.isfinite(ranges)
        blurred = ranges + self.error.offset
        if noise.stddev > 0:
            # One number per ray, so that a hit does not change the noise on other rays.
            blurred += self.random("noise").normal(0.0, noise.stddev, ranges.shape)
        if precision > 0:
            blurred = np.round(blurred / precision) * precision
        np.clip(blurred, self.pattern.minimum, self.pattern.maximum, out=blurred)
        ranges[measured] = blurred[measured]
