"""Heightmaps: images whose brightness is a height.

Source: Gazebo Classic's ImageHeightmap. The brightest pixel has the height in ``<size>``, and black
is 0. The first row of the image is at +y, its first column at -x.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.files import PICTURE_UNREADABLE
from cartwheel.description.appearance.images import PictureError, open_picture
from cartwheel.description.model import Heightmap
from cartwheel.errors import CartwheelError, Origin

MOST_SAMPLES = 513
"""Maximum in each direction; larger images are downsampled."""
ELEVATION_MODELS = (".dem", ".tif", ".tiff", ".hgt", ".asc", ".nc", ".adf")
"""Geographic data that Gazebo reads with GDAL; only grey images are supported here."""


class TerrainError(CartwheelError):
    """An image that cannot be used as a heightmap."""

    code = PICTURE_UNREADABLE


def heights_of(
    shape: Heightmap, *, most: int = MOST_SAMPLES, origin: Origin | None = None
) -> NDArray[np.float64]:
    """Heights above `shape.position`, m, shape (rows, columns); row 0 is at +y.

    Args:
        shape: The heightmap.
        most: Maximum samples in each direction.
        origin: The element, for the error.

    Raises:
        TerrainError: The file is not a readable image, or is too large.
    """
    try:
        changed = shape.path.stat().st_mtime_ns
        grey = _grey(shape.path, changed, most)
    except (OSError, PictureError) as error:
        reason = error.reason if isinstance(error, PictureError) else error.strerror
        hint = error.hint if isinstance(error, PictureError) else None
        raise TerrainError(
            f'the heightmap "{shape.path.name}" cannot be read: {reason}',
            origin=origin,
            values={"kind": "heightmap", "name": str(shape.path)},
            hint=hint or "Save the heights as a greyscale PNG.",
        ) from None
    return grey * shape.size[2] if shape.size[2] >= 0 else (1.0 - grey) * -shape.size[2]


@lru_cache(maxsize=8)
def _grey(path: Path, _changed: int, most: int) -> NDArray[np.float64]:
    """Brightness, 1 at the brightest pixel, shape (rows, columns)."""
    with open_picture(path) as image:
        # For colours, the red channel is used, as in Gazebo.
        if image.mode == "P":
            channel = image.convert("RGB").getchannel(0)
        else:
            channel = image.getchannel(0) if len(image.getbands()) > 1 else image
        pixels = np.asarray(channel)
    if pixels.dtype.kind == "f" and not np.isfinite(pixels).all():
        raise PictureError(path.name, "a pixel is not a finite number")
    rows = _samples(pixels.shape[0], most)
    columns = _samples(pixels.shape[1], most)
    grey = _interpolated(_interpolated(pixels, rows).T, columns).T
    top = float(grey.max())
    grey = grey / top if top > 0 else grey
    grey.flags.writeable = False
    return grey


def _samples(count: int, most: int) -> NDArray[np.float64]:
    """Sample positions along an axis with `count` pixels, including the first and last pixel."""
    if count < 2:
        return np.zeros(2)
    return np.linspace(0, count - 1, min(count, most))


def _interpolated(grey: NDArray[Any], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rows at `at`; only these are converted to floats, to save memory."""
    low = np.floor(at).astype(int)
    high = np.minimum(low + 1, len(grey) - 1)
    part = (at - low)[:, None]
    return np.asarray(grey[low] * (1 - part) + grey[high] * part)
