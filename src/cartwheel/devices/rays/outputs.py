"""The messages that a lidar can publish."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from cartwheel.devices.point_clouds import point_cloud, point_cloud2
from cartwheel.devices.rays.messages import laser_scan, range_message
from cartwheel.devices.rays.scan import Scan, Scanner
from cartwheel.geometry import Array

Cloud = np.ndarray[Any, np.dtype[np.void]]
"""Points as a structured array."""

XYZI = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4")])
"""Point layout of 16 bytes: position and intensity."""


class Output(Protocol):
    """A topic of a lidar, and the conversion of a scan to its messages."""

    type_name: ClassVar[str]
    """Message type, ``pkg/msg/Name``."""

    @property
    def topic(self) -> str:
        """Topic of the messages."""

    def message(self, moment: Any, scanner: Scanner, scan: Scan) -> Any:
        """Returns the message of a scan with this header."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LaserScanOutput:
    """Publishes the middle row as a LaserScan."""

    type_name: ClassVar[str] = "sensor_msgs/msg/LaserScan"

    topic: str
    intensity_floor: float = 0.0
    """Intensities below this value are raised to it."""

    def message(self, moment: Any, scanner: Scanner, scan: Scan) -> Any:
        """Returns a LaserScan."""
        return laser_scan(moment, scanner.pattern, scan, floor=self.intensity_floor)


@dataclass(frozen=True, kw_only=True, slots=True)
class RangeOutput:
    """Publishes the smallest range of all rays, inf if nothing is hit (REP 117)."""

    type_name: ClassVar[str] = "sensor_msgs/msg/Range"

    topic: str
    infrared: bool
    """Set the radiation type to infrared instead of ultrasound."""

    def message(self, moment: Any, scanner: Scanner, scan: Scan) -> Any:
        """Returns a Range, whose field of view is the larger one of the scan."""
        pattern = scanner.pattern
        return range_message(
            moment,
            pattern,
            float(scan.ranges.min()),
            fov=max(pattern.field_of_view),
            infrared=self.infrared,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class PointCloudOutput:
    """Publishes the points that were hit as a PointCloud."""

    type_name: ClassVar[str] = "sensor_msgs/msg/PointCloud"

    topic: str
    noise: float = 0.0
    """Standard deviation of the noise on each coordinate, m."""
    intensity_floor: float = -math.inf
    """Intensities below this value are raised to it."""

    def message(self, moment: Any, scanner: Scanner, scan: Scan) -> Any:
        """Returns a PointCloud."""
        hit = np.isfinite(scan.ranges)
        points = scan.points(scanner.directions)
        if self.noise > 0:
            random = scanner.random("points")
            points = points + random.normal(0.0, self.noise, points.shape)
        intensities = np.maximum(scan.intensities[hit], self.intensity_floor)
        return point_cloud(moment, points[hit], intensities)


@dataclass(frozen=True, kw_only=True, slots=True)
class PointCloud2Output:
    """Publishes the points as a PointCloud2."""

    type_name: ClassVar[str] = "sensor_msgs/msg/PointCloud2"

    topic: str
    layout: np.dtype[np.void] = XYZI
    """Fields of a point: x, y, z and intensity, and optionally ring and time. Ring 0 is the lowest
    row. All points are measured at the same time, so their time is 0."""
    missing: Literal["omit", "nan", "inf"] = "omit"
    """Points that were not hit: omit them, or publish an organised cloud in which their coordinates
    are NaN or inf. With NaN, their intensity is NaN too."""
    by_column: bool = False
    """Order the points by columns of the scan instead of rows."""
    nearest: float = -math.inf
    """Points at or below this range count as not hit, m."""
    furthest: float = math.inf
    """Points at or above this range count as not hit, m."""
    least_intensity: float | None = None
    """Points with a lower intensity count as not hit."""
    intensity_floor: float = -math.inf
    """Intensities below this value are raised to it."""
    noise: float = 0.0
    """Standard deviation of additional noise on the ranges, m."""

    def message(self, moment: Any, scanner: Scanner, scan: Scan) -> Any:
        """Returns a PointCloud2."""
        ranges = scan.ranges
        hit = self.hits(ranges)
        if self.least_intensity is not None:
            hit &= scan.intensities >= self.least_intensity
        if self.noise > 0:
            ranges = ranges + scanner.random("points").normal(0.0, self.noise, ranges.shape)
            hit &= self.hits(ranges)
        cloud = self.cloud(scanner.directions, ranges, scan.intensities, hit)
        # A cloud in which NaN marks missing points is never declared dense.
        dense = self.missing == "omit" or (self.missing == "inf" and bool(hit.all()))
        return point_cloud2(moment, cloud, dense=dense)

    def hits(self, ranges: Array) -> Any:
        """Whether each range is within the limits."""
        return (ranges > self.nearest) & (ranges < self.furthest)

    def cloud(self, directions: Array, ranges: Array, intensities: Array, hit: Any) -> Cloud:
        """Returns the points in the layout.

        Args:
            directions: Unit vectors, shape (rows, columns, 3).
            ranges: m, shape (rows, columns).
            intensities: Shape (rows, columns).
            hit: Whether each ray hit something, shape (rows, columns).

        Returns:
            Shape (n,) if missing points are omitted; otherwise (rows, columns), or (columns, rows)
            if ordered by columns.
        """
        if self.intensity_floor > -math.inf:
            intensities = np.maximum(intensities, self.intensity_floor)
        rings = np.broadcast_to(np.arange(len(ranges))[:, None], ranges.shape)
        if self.by_column:
            directions = directions.swapaxes(0, 1)
            ranges, intensities, rings, hit = ranges.T, intensities.T, rings.T, hit.T
        if self.missing == "omit":
            which = np.flatnonzero(hit)
            directions = directions.reshape(-1, 3).take(which, axis=0)
            ranges, intensities = ranges.take(which), intensities.take(which)
        else:
            ranges = np.where(hit, ranges, 1.0)
        cloud = np.zeros(ranges.shape, dtype=self.layout)
        for index, name in enumerate("xyz"):
            np.multiply(directions[..., index], ranges, out=cloud[name], casting="same_kind")
        cloud["intensity"] = intensities
        if "ring" in (self.layout.names or ()):
            cloud["ring"] = rings.take(which) if self.missing == "omit" else rings
        if self.missing != "omit":
            for name in "xyz":
                cloud[name][~hit] = float(self.missing)
            if self.missing == "nan":
                cloud["intensity"][~hit] = np.nan
        return cloud
