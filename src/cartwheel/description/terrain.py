"""Heightmaps: images whose brightness is a height.

Source: Gazebo Classic's ImageHeightmap: the brightest pixel is as high as ``<size>`` says, black
is 0; the first row of the image lies at +y, its first column at -x.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.files import PICTURE_UNREADABLE
from cartwheel.description.model import Heightmap
from cartwheel.description.pictures import PictureError, open_picture
from cartwheel.errors import CartwheelError, Origin

MOST_SAMPLES = 513
"""In each direction; finer images are thinned out."""
ELEVATION_MODELS = (".dem", ".tif", ".tiff", ".hgt", ".asc", ".nc", ".adf")
"""Geographic data that GDAL reads for Gazebo; an image in grey is what is read here."""


class TerrainError(CartwheelError):
    """An image that cannot be used as a heightmap."""

    code = PICTURE_UNREADABLE


def heights_of(
    shape: Heightmap, *, most: int = MOST_SAMPLES, origin: Origin | None = None
) -> NDArray[np.float64]:
    """Heights above `shape.position`, m, shape (rows, columns); row 0 lies at +y.

    Args:
        shape: The heightmap.
        most: Samples in each direction.
        origin: The element, for the error.

    Raises:
        TerrainError: The file is no image that can be read, or too large.
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
        # A colour counts by its red, as in Gazebo.
        if image.mode == "P":
            channel = image.convert("RGB").getchannel(0)
        else:
            channel = image.getchannel(0) if len(image.getbands()) > 1 else image
        pixels = np.asarray(channel)
    if pixels.dtype.kind == "f" and not np.isfinite(pixels).all():
        raise PictureError(path.name, "a height is not a finite number")
    rows = _samples(pixels.shape[0], most)
    columns = _samples(pixels.shape[1], most)
    grey = _interpolated(_interpolated(pixels, rows).T, columns).T
    top = float(grey.max())
    grey = grey / top if top > 0 else grey
    grey.flags.writeable = False
    return grey


def _samples(count: int, most: int) -> NDArray[np.float64]:
    """Where along an axis of `count` pixels the samples lie; the first and last are kept."""
    if count < 2:
        return np.zeros(2)
    return np.linspace(0, count - 1, min(count, most))


def _interpolated(grey: NDArray[Any], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rows at `at`; only these become floats, since there may be many others."""
    low = np.floor(at).astype(int)
    high = np.minimum(low + 1, len(grey) - 1)
    part = (at - low)[:, None]
    return np.asarray(grey[low] * (1 - part) + grey[high] * part)
