"""ROS messages of scans."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from cartwheel.dialects.scan import Scan, ScanPattern
from cartwheel.geometry import Array
from cartwheel.messages import message_class

_DATATYPES = {np.dtype(np.float32): "FLOAT32", np.dtype(np.uint16): "UINT16"}


def laser_scan(moment: Any, pattern: ScanPattern, scan: Scan, *, floor: float = 0.0) -> Any:
    """Returns a LaserScan of the middle row.

    Args:
        moment: The header.
        pattern: Pattern of the scan.
        scan: The measurement.
        floor: Intensities below this value are raised to it.
    """
    sweep = pattern.horizontal
    row = pattern.vertical.count // 2
    return message_class("sensor_msgs/msg/LaserScan")(
        header=moment,
        angle_min=sweep.first,
        angle_max=sweep.last,
        angle_increment=sweep.step,
        time_increment=0.0,
        scan_time=0.0,
        range_min=pattern.minimum,
        range_max=pattern.maximum,
        ranges=scan.ranges[row].astype(np.float32),
        intensities=np.maximum(scan.intensities[row], floor).astype(np.float32),
    )


def range_reading(
    moment: Any, pattern: ScanPattern, value: float, *, fov: float, infrared: bool
) -> Any:
    """Returns a Range message.

    Args:
        moment: The header.
        pattern: Pattern of the scan, which provides the range limits.
        value: Range, m.
        fov: Field of view, rad.
        infrared: Set the radiation type to infrared instead of ultrasound.
    """
    kind = message_class("sensor_msgs/msg/Range")
    return kind(
        header=moment,
        radiation_type=kind.INFRARED if infrared else kind.ULTRASOUND,
        field_of_view=fov,
        min_range=pattern.minimum,
        max_range=pattern.maximum,
        range=value,
        variance=0.0,
    )


def point_cloud(moment: Any, points: Array, intensities: Array) -> Any:
    """Returns a PointCloud with one channel, ``intensity``.

    Args:
        moment: The header.
        points: Points in m, shape (n, 3).
        intensities: Intensities, shape (n,).
    """
    point = message_class("geometry_msgs/msg/Point32")
    return message_class("sensor_msgs/msg/PointCloud")(
        header=moment,
        points=[point(x, y, z) for x, y, z in points.tolist()],
        channels=[
            message_class("sensor_msgs/msg/ChannelFloat32")(
                name="intensity", values=intensities.astype(np.float32)
            )
        ],
    )


def point_cloud2(moment: Any, cloud: Any, *, dense: bool) -> Any:
    """Returns a PointCloud2 with the fields of a structured array.

    Args:
        moment: The header.
        cloud: The points, shape (n,), or (height, width) for an organised cloud.
        dense: Whether all points are valid.
    """
    height, width = cloud.shape if cloud.ndim == 2 else (1, len(cloud))
    step = cloud.dtype.itemsize
    return message_class("sensor_msgs/msg/PointCloud2")(
        header=moment,
        height=height,
        width=width,
        fields=_fields(cloud.dtype),
        is_bigendian=False,
        point_step=step,
        row_step=step * width,
        data=np.ascontiguousarray(cloud).reshape(-1).view(np.uint8),
        is_dense=dense,
    )


@functools.cache
def _fields(layout: np.dtype[np.void]) -> list[Any]:
    kind = message_class("sensor_msgs/msg/PointField")
    assert layout.fields is not None
    return [
        kind(name=name, offset=place[1], datatype=getattr(kind, _DATATYPES[place[0]]), count=1)
        for name, place in layout.fields.items()
    ]
