"""The array in a message of any type."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cartwheel.arrays.data import Array, full_kind_of, invalid, kind_of, locked, vector
from cartwheel.arrays.images import camera_matrix, image
from cartwheel.arrays.points import cloud, scan


def array(message: Any) -> Array:
    """The array in a message.

    Images give `image`, laser scans the ranges, point clouds `cloud`, and camera infos
    `camera_matrix`. The types of std_msgs such as ``Float64MultiArray`` give their data, in the
    shape that their layout states. Joint states give the positions.

    Raises:
        GraphError: The type contains no array, or see the functions above.
    """
    convert = _CONVERTERS.get(kind_of(message))
    if convert is not None:
        return convert(message)
    if kind_of(message).endswith("MultiArray"):
        return _multi_array(message)
    raise invalid(f"a message of type {full_kind_of(message)} contains no array")


def _positions(message: Any) -> Array:
    return vector(message, "position")


def _ranges(message: Any) -> Array:
    return scan(message).ranges


_CONVERTERS: Mapping[str, Callable[[Any], Array]] = {
    "Image": image,
    "CompressedImage": image,
    "LaserScan": _ranges,
    "PointCloud": cloud,
    "PointCloud2": cloud,
    "CameraInfo": camera_matrix,
    "JointState": _positions,
}


def _multi_array(message: Any) -> Array:
    data = locked(np.asarray(message.data)[:])
    offset = int(message.layout.data_offset)
    shape = tuple(int(each.size) for each in message.layout.dim)
    if not shape:
        return data
    size = 1
    for each in shape:
        size *= each
    if offset + size > data.size:
        raise invalid(
            f"the layout states {offset + size} numbers, but the data has {data.size}",
            stated=offset + size,
            size=data.size,
        )
    return data[offset : offset + size].reshape(shape)
