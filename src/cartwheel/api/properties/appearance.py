"""Colours and textures of links."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cartwheel.api.values import array, invalid
from cartwheel.codes.files import FILE_MISSING
from cartwheel.description.model import Link, Material, Rgba
from cartwheel.errors import CartwheelError

Colour = Sequence[float] | NDArray[np.float64]
"""Red, green and blue, with or without alpha, each 0 to 1."""
Texture = str | Path | NDArray[np.uint8]
"""An image file, or an image of shape (height, width, 3), uint8."""


def rgba(colour: Colour, name: str) -> Rgba:
    """A colour with an alpha of 1 if it has none.

    Raises:
        CartwheelError: There are not three or four numbers from 0 to 1.
    """
    given = list(np.ravel(np.asarray(colour, dtype=object)))
    try:
        made = array(given if len(given) == 4 else [*given, 1.0], (4,), name)
    except CartwheelError:
        made = np.full(4, np.nan)
    if not (made.min() >= 0 and made.max() <= 1):
        wanted = "must be red, green and blue, and alpha if it is not 1, from 0 to 1"
        raise invalid(name, wanted, colour)
    r, g, b, a = made.tolist()
    return r, g, b, a


def coloured(link: Link, colour: Rgba) -> Link:
    """The link with one colour on all its visuals."""
    return _with_material(link, Material(diffuse=colour))


def textured(link: Link, image: Path | bytes) -> Link:
    """The link with one image on all its visuals."""
    return _with_material(link, Material(diffuse=(1.0, 1.0, 1.0, 1.0), texture=image))


def colour_of(link: Link) -> Rgba | None:
    """The colour of the first visual; None if there is none or it has the colours of a mesh."""
    return link.visuals[0].material.diffuse if link.visuals else None


def texture_of(link: Link) -> Path | bytes | None:
    """The image of the first visual; None without one."""
    return link.visuals[0].material.texture if link.visuals else None


def image_of(texture: Texture) -> Path | bytes:
    """An image file, or the contents of one.

    Raises:
        CartwheelError: The file does not exist, or the array is not an image.
    """
    if isinstance(texture, str | Path):
        file = Path(texture)
        if not file.is_file():
            raise CartwheelError(
                f'file "{file}" does not exist', code=FILE_MISSING, values={"name": str(file)}
            )
        return file.resolve()
    pixels = np.asarray(texture)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8 or not pixels.size:
        raise invalid("texture", "must be a uint8 array of shape (height, width, 3)", pixels.shape)
    from PIL import Image

    contents = io.BytesIO()
    Image.fromarray(pixels).save(contents, format="PNG", compress_level=0)
    return contents.getvalue()


def _with_material(link: Link, material: Material) -> Link:
    visuals = tuple(replace(each, material=material) for each in link.visuals)
    return replace(link, visuals=visuals)
