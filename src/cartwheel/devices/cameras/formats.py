"""Layouts of pixels in ``sensor_msgs/Image``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]
"""RGB, shape (height, width, 3)."""

_WEIGHTS = np.array([0.299, 0.587, 0.114], dtype=np.float32)
"""Weights of red, green and blue in the brightness. Source: ITU-R BT.601, as in OpenCV."""
_TO_16_BITS = 257
"""Maps 255 to 65535."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ImageFormat:
    """Layout of pixels in a message."""

    encoding: str
    """Source: sensor_msgs/image_encodings."""
    bytes_per_pixel: int
    encode: Callable[[Pixels], NDArray[Any]]
    """Converts RGB to the layout of the message."""
    colour: bool = True
    """Whether a pixel has all three colours."""


def _same(pixels: Pixels) -> Pixels:
    return pixels


def _swap(pixels: Pixels) -> Pixels:
    return pixels[..., ::-1]


def grey(pixels: Pixels) -> Pixels:
    """Returns the brightness, shape (height, width)."""
    return (pixels @ _WEIGHTS).round().astype(np.uint8)


def _wide(pixels: Pixels) -> NDArray[np.uint16]:
    return pixels.astype("<u2") * np.uint16(_TO_16_BITS)


def _wide_grey(pixels: Pixels) -> NDArray[np.uint16]:
    return _wide(grey(pixels))


def _bayer(pattern: str) -> Callable[[Pixels], Pixels]:
    """Returns an encoder for the mosaic of 2 x 2 filters, which `pattern` names row by row."""
    channels = ["RGB".index(letter) for letter in pattern]

    def encode(pixels: Pixels) -> Pixels:
        mosaic = np.empty(pixels.shape[:2], dtype=np.uint8)
        for index, channel in enumerate(channels):
            row, column = divmod(index, 2)
            mosaic[row::2, column::2] = pixels[row::2, column::2, channel]
        return mosaic

    return encode


RGB8 = ImageFormat(encoding="rgb8", bytes_per_pixel=3, encode=_same)
BGR8 = ImageFormat(encoding="bgr8", bytes_per_pixel=3, encode=_swap)
MONO8 = ImageFormat(encoding="mono8", bytes_per_pixel=1, encode=grey, colour=False)
MONO16 = ImageFormat(encoding="mono16", bytes_per_pixel=2, encode=_wide_grey, colour=False)
RGB16 = ImageFormat(encoding="rgb16", bytes_per_pixel=6, encode=_wide)
BAYER8 = {
    pattern: ImageFormat(
        encoding=f"bayer_{pattern.lower()}8",
        bytes_per_pixel=1,
        encode=_bayer(pattern),
        colour=False,
    )
    for pattern in ("RGGB", "BGGR", "GBRG", "GRBG")
}
"""Formats with one filter per pixel, by the colours of the filters."""
