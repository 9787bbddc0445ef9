"""Points in space and their pixels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.arrays.data import Array, invalid
from cartwheel.arrays.images import camera_matrix


def project(info: Any, points: ArrayLike) -> Array:
    """The pixels at which a camera sees points.

    Pixels are counted as in the array that `image` returns: (0, 0) is the centre of the first one.
    The camera matrices of Gazebo Classic's cameras count from 1, and those of gz-sim's cameras from
    0.5. The lens is one without distortion.

    Args:
        info: ``sensor_msgs/CameraInfo``.
        points: Shape (..., 3), m, in a frame with z forward, x to the right and y down.

    Returns:
        Columns and rows, shape (..., 2). NaN for points that are not in front of the camera; pixels
        beyond the image for points that it does not see.

    Raises:
        GraphError: The shape is different, or `info` is no such message.
    """
    given = np.asarray(points, dtype=float)
    if given.shape[-1:] != (3,):
        raise invalid(f"the points have the shape {given.shape} instead of (..., 3)")
    matrix = _counted_from_0(info)
    depth = given[..., 2:]
    with np.errstate(divide="ignore", invalid="ignore"):
        pixels: Array = (given @ matrix.T)[..., :2] / depth
    return np.where(depth > 0, pixels, np.nan)


def unproject(info: Any, pixels: ArrayLike, depth: ArrayLike) -> Array:
    """The points that a camera sees at pixels; the inverse of `project`.

    Args:
        info: ``sensor_msgs/CameraInfo``.
        pixels: Columns and rows, shape (..., 2).
        depth: Distance along the axis of the camera, m, of a shape that fits (...,), as in the
            image of a depth camera.

    Returns:
        Shape (..., 3), m, in a frame with z forward, x to the right and y down.

    Raises:
        GraphError: The shape is different, or `info` is no such message.
    """
    given = np.asarray(pixels, dtype=float)
    if given.shape[-1:] != (2,):
        raise invalid(f"the pixels have the shape {given.shape} instead of (..., 2)")
    inverse = np.linalg.inv(_counted_from_0(info))
    ones = np.ones((*given.shape[:-1], 1))
    rays = np.concatenate([given, ones], axis=-1) @ inverse.T
    points: Array = rays * np.asarray(depth, dtype=float)[..., None]
    return points


def _counted_from_0(info: Any) -> Array:
    """The camera matrix for pixels that are counted from 0."""
    matrix = camera_matrix(info).copy()
    centre = (np.array([info.width, info.height]) - 1) / 2
    first = matrix[:2, 2] - centre
    # Gazebo Classic's principal points are in the middle of the image, and count from 1.
    matrix[:2, 2] -= 1.0 if np.allclose(first, 1.0, atol=1e-3) else 0.5
    return matrix
