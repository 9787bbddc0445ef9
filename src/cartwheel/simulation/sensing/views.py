"""Views of cameras, and what is visible in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.description.model import CameraIntrinsics
from cartwheel.geometry import Pose, cross, matrix_from_quat

_STEEP = 0.9999
"""Vertical part of a unit vector that is taken as vertical."""

Image = np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]
Depth = np.ndarray[tuple[int, int], np.dtype[np.float32]]


@dataclass(frozen=True, slots=True)
class View:
    """The camera of one image."""

    lens: CameraIntrinsics
    position: Any
    """In the world, m, shape (3,)."""
    axes: Any
    """Columns: the image's right, up, and back, shape (3, 3)."""
    fixed: int
    """ID of the camera in the model; -1 for a camera that is not in the model."""


@dataclass(frozen=True, slots=True)
class Labelled:
    """An image and what is visible at each pixel."""

    pixels: Image
    """Shape (height, width, 3), RGB."""
    depths: Depth
    """Along the camera's axis, m; inf where nothing opaque is visible."""
    bodies: Any
    """Index in `names` of the body at each pixel, also of a transparent one; -1 for the background;
    shape (height, width)."""
    names: tuple[str, ...]
    """Scoped names of all bodies."""


def axes_of(pose: Pose) -> Any:
    """The axes of a camera that looks along its x axis; see `View.axes`."""
    forward, left, up = matrix_from_quat(pose.orientation).T
    return np.column_stack([-left, up, -forward])


def metres(buffer: Depth, lens: CameraIntrinsics) -> Depth:
    """Depths along the camera's axis, m; inf where nothing is visible.

    The buffer contains near (far - z) / (z (far - near)): 1 at the near plane, 0 at the far plane.
    Its lowest row is the first.
    """
    with np.errstate(divide="ignore"):
        depths: Depth = np.float32(lens.near * lens.far) / (
            np.float32(lens.near) + buffer[::-1] * np.float32(lens.far - lens.near)
        )
    depths[buffer[::-1] == 0] = np.inf
    return depths


def axes_towards(direction: Any) -> Any:
    """The axes of a camera that looks in a direction; see `View.axes`."""
    back = -direction / np.linalg.norm(direction)
    upright = np.array([0.0, 1.0, 0.0] if abs(back[2]) > _STEEP else [0.0, 0.0, 1.0])
    right = cross(upright, back)
    right /= np.linalg.norm(right)
    return np.column_stack([right, cross(back, right), back])


def out_of_view(model: Any, data: Any, view: View) -> Any:
    """Mask of geoms whose bounding spheres are completely out of view, shape (ngeom,)."""
    lens = view.lens
    radius = model.geom_rbound
    right, up, back = ((data.geom_xpos - view.position) @ view.axes).T
    wide = math.tan(lens.horizontal_fov / 2)
    high = wide * lens.height / lens.width
    out = (-back + radius < lens.near) | (-back - radius > lens.far)
    out |= np.abs(right) + wide * back > radius * math.hypot(1.0, wide)
    out |= np.abs(up) + high * back > radius * math.hypot(1.0, high)
    # An infinite plane has no bounding sphere.
    return out & (radius > 0)
