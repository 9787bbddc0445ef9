"""SDF's ``<ray>`` and ``<lidar>`` elements: the pattern of a ray sensor."""

from __future__ import annotations

from collections.abc import Callable

from cartwheel.codes import devices
from cartwheel.description.model import Element, Sensor
from cartwheel.devices.rays.scan import LEVEL, ScannerConfig, ScanPattern, Sweep
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import number_at
from cartwheel.errors import Diagnostic, Origin, PluginError

_MOST_RAYS = 1_000_000
"""Maximum number of rays. The densest real sensors have about 300,000; a ray needs 200 bytes."""
_GPU_TYPES = {"gpu_ray", "gpu_lidar"}
"""Types that detect visuals instead of collisions, as in Gazebo."""


def read_scanner(sensor: Sensor, report: Callable[[Diagnostic], None]) -> ScannerConfig:
    """Reads a ray sensor; see `read_pattern`."""
    return ScannerConfig(
        name=f"{sensor.link} {sensor.name}",
        link=sensor.link,
        pose=sensor.pose,
        pattern=read_pattern(sensor, report),
        visuals=sensor.type in _GPU_TYPES,
        rate=sensor.update_rate,
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
    vertical = _sweep(upright, report, samples=1) if upright is not None else LEVEL
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
    minimum = number_at(limits, "min", 0.0)
    maximum = number_at(limits, "max", 0.0, endless=True)
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
    asked = number_at(element, "samples", samples)
    resolution = number_at(element, "resolution", 1.0)
    first, last = number_at(element, "min_angle", 0.0), number_at(element, "max_angle", 0.0)
    if not 1 <= asked <= _MOST_RAYS:
        raise PluginError(
            f"<samples> must be between 1 and {_MOST_RAYS:,} (got {asked:g})",
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
                f"<max_angle> ({last:g} rad) is below <min_angle> ({first:g} rad), so the first "
                "ray is at the larger angle",
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
