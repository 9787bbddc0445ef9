"""Laser scans and point clouds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.lib.stride_tricks import as_strided

from cartwheel.arrays.data import Array, bytes_of, invalid, kind_of, locked, require, vector

_FIELDS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""``sensor_msgs/PointField`` datatypes."""


@dataclass(frozen=True, slots=True)
class Scan:
    """A laser scan.

    Attributes:
        ranges: Distances in m, shape (N,). ``inf`` means no return, ``-inf`` too close.
        angles: Angle of each ray in rad, about the z axis of the scan's frame, shape (N,).
        intensities: Shape (N,), or (0,) if the sensor measures none.
        range_min: Minimum range, m.
        range_max: Maximum range, m.
    """

    ranges: Array
    angles: Array
    intensities: Array
    range_min: float
    range_max: float

    @property
    def valid(self) -> Array:
        """Whether each ray measured a distance within the range of the sensor, shape (N,)."""
        ranges = self.ranges
        return np.isfinite(ranges) & (ranges >= self.range_min) & (ranges <= self.range_max)

    @property
    def points(self) -> Array:
        """The x and y of all valid rays in the scan's frame, m, shape (M, 2)."""
        valid = self.valid
        ranges, angles = self.ranges[valid], self.angles[valid]
        return np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], axis=1)


def scan(message: Any) -> Scan:
    """A laser scan with the angle of each ray.

    Args:
        message: ``sensor_msgs/LaserScan``.

    Raises:
        GraphError: The angles are not finite, or the numbers of ranges and intensities differ.
    """
    require(message, "sensor_msgs/LaserScan", "ranges", "intensities", "angle_min")
    ranges, intensities = vector(message, "ranges"), vector(message, "intensities")
    if intensities.size not in (0, ranges.size):
        raise invalid(
            f"the scan has {ranges.size} ranges but {intensities.size} intensities",
            ranges=ranges.size,
            intensities=intensities.size,
        )
    start, increment = float(message.angle_min), float(message.angle_increment)
    if not np.isfinite(start) or not np.isfinite(increment):
        raise invalid("the angles of the scan are not finite")
    return Scan(
        ranges=ranges,
        angles=locked(start + increment * np.arange(ranges.size)),
        intensities=intensities,
        range_min=float(message.range_min),
        range_max=float(message.range_max),
    )


def cloud(message: Any, *, structured: bool = False) -> Array:
    """A point cloud as an array.

    Args:
        message: ``sensor_msgs/PointCloud2`` or ``sensor_msgs/PointCloud``.
        structured: Return all fields of a PointCloud2, such as ``intensity``.

    Returns:
        The fields x, y and z in m, shape (N, 3). With `structured`, an array with one named field
        for each field of the message, shape (N,). For an organised cloud, with a height above 1,
        the first dimension is replaced by (height, width).

    Raises:
        GraphError: A field is invalid or missing, or the data do not fit the size of the cloud.
    """
    if message is not None and kind_of(message) == "PointCloud":
        places = [(point.x, point.y, point.z) for point in message.points]
        return locked(np.array(places, dtype=np.float32).reshape(-1, 3))
    require(message, "sensor_msgs/PointCloud2", "fields", "point_step", "row_step")
    points = _points(message)
    if structured:
        return points
    fields: Mapping[str, Any] = points.dtype.fields or {}
    missing = [name for name in "xyz" if name not in fields]
    if missing:
        raise invalid(f"the point cloud has no field {missing[0]}", field=missing[0])
    types = {fields[name][0] for name in "xyz"}
    x, y, z = (fields[name][1] for name in "xyz")
    kind = next(iter(types))
    size = kind.itemsize
    if len(types) == 1 and kind.shape == () and (y - x, z - y) == (size, size):
        shape, strides = (*points.shape, 3), (*points.strides, size)
        return locked(as_strided(points["x"], shape, strides))
    return locked(np.stack([points[name] for name in "xyz"], axis=-1))


def _points(message: Any) -> Array:
    """All fields of a PointCloud2."""
    height, width = int(message.height), int(message.width)
    point, row = int(message.point_step), int(message.row_step)
    order: Literal[">", "<"] = ">" if message.is_bigendian else "<"
    names, formats, offsets = [], [], []
    for field in message.fields:
        name, count, offset = str(field.name), int(field.count), int(field.offset)
        kind = _FIELDS.get(int(field.datatype))
        if kind is None or not name or name in names or offset < 0 or not 0 <= count <= point:
            raise invalid(f'the field "{name[:60]}" of the point cloud is invalid', field=name[:60])
        number = np.dtype(kind).newbyteorder(order)
        # Some drivers write a count of 0 for a single number.
        made = number if count <= 1 else np.dtype((number, (count,)))
        if offset + made.itemsize > point:
            raise invalid(
                f'the field "{name[:60]}" ends at byte {offset + made.itemsize} of a point of '
                f"{point} bytes",
                field=name[:60],
                point_step=point,
            )
        names.append(name)
        formats.append(made)
        offsets.append(offset)
    data = bytes_of(message)
    if (
        min(height, width) < 0
        or point < 1
        or row < width * point
        or data.size != height * row
        or not names
    ):
        raise invalid(
            f"a point cloud of {width} x {height} points of {point} bytes with a row step of {row} "
            f"bytes does not have {data.size} bytes",
            width=width,
            height=height,
            point_step=point,
            row_step=row,
            size=data.size,
        )
    kind_of_point = np.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": point}
    )
    shape: tuple[int, ...] = (height, width) if height > 1 else (height * width,)
    if not height * width:
        return locked(np.zeros(shape, kind_of_point))
    strides = (row, point) if height > 1 else (point,)
    return locked(np.ndarray(shape, kind_of_point, data, strides=strides))
