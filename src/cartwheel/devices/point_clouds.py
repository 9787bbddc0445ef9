"""ROS messages of point clouds."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from cartwheel.geometry import Array
from cartwheel.messages import message_class

_DATATYPES = {np.dtype(np.float32): "FLOAT32", np.dtype(np.uint16): "UINT16"}


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
