"""Images and depths."""

from __future__ import annotations

import io
import struct
from typing import Any

import numpy as np

from cartwheel.arrays.data import Array, bytes_of, invalid, kind_of, locked, require

_MOST_PIXELS = 1 << 28
"""Maximum number of pixels of a compressed image, which is known only after decoding its header."""
_PIXELS: dict[str, tuple[str, int]] = {
    "rgb8": ("u1", 3),
    "bgr8": ("u1", 3),
    "rgba8": ("u1", 4),
    "bgra8": ("u1", 4),
    "rgb16": ("u2", 3),
    "bgr16": ("u2", 3),
    "rgba16": ("u2", 4),
    "bgra16": ("u2", 4),
    "mono8": ("u1", 1),
    "mono16": ("u2", 1),
    **{f"bayer_{pattern}8": ("u1", 1) for pattern in ("rggb", "bggr", "gbrg", "grbg")},
    **{f"bayer_{pattern}16": ("u2", 1) for pattern in ("rggb", "bggr", "gbrg", "grbg")},
}
_DEPTHS = {"8U": "u1", "8S": "i1", "16U": "u2", "16S": "i2", "32S": "i4", "32F": "f4", "64F": "f8"}
_REVERSED = {3: [2, 1, 0], 4: [2, 1, 0, 3]}
_QUANTISED = struct.Struct("<iff")
"""The header of a compressed depth image. Source: compressed_depth_image_transport."""


def image(message: Any) -> Array:
    """An image as an array of pixels.

    Args:
        message: ``sensor_msgs/Image`` or ``sensor_msgs/CompressedImage``.

    Returns:
        Shape (height, width, 3) or, with alpha, (height, width, 4), always in the order red, green,
        blue; shape (height, width) for grey, Bayer and depth images, with their numbers unchanged.

    Raises:
        GraphError: The encoding is unknown, or the data do not fit the size of the image.
    """
    require(message, "sensor_msgs/Image", "data")
    if kind_of(message) == "CompressedImage":
        return _decoded(message)
    require(message, "sensor_msgs/Image", "encoding")
    encoding = str(message.encoding)
    pixels = _pixels(message, encoding)
    if encoding.startswith("bgr"):
        if pixels.shape[2] == 3:
            return pixels[:, :, ::-1]
        return locked(pixels[:, :, _REVERSED[4]])
    return pixels


def depth(message: Any) -> Array:
    """A depth image in m.

    Args:
        message: ``sensor_msgs/Image`` with the encoding 32FC1 (m), or 16UC1 or mono16 (mm, where 0
            means no depth), or the ``sensor_msgs/CompressedImage`` of a depth image.

    Returns:
        Shape (height, width), float32. Pixels without a depth are not finite.

    Raises:
        GraphError: The message is no depth image, or the data do not fit the size of the image.
    """
    require(message, "sensor_msgs/Image", "data")
    if kind_of(message) == "CompressedImage":
        return _decoded_depth(message)
    require(message, "sensor_msgs/Image", "encoding")
    encoding = str(message.encoding)
    if encoding == "32FC1":
        return _pixels(message, encoding)
    if encoding not in ("16UC1", "mono16"):
        raise invalid(f'the encoding "{encoding}" is not that of a depth image', encoding=encoding)
    return _in_metres(_pixels(message, encoding))


def camera_matrix(message: Any) -> Array:
    """The intrinsic matrix of a camera: focal lengths and principal point in pixels.

    Args:
        message: ``sensor_msgs/CameraInfo``.

    Returns:
        Shape (3, 3).

    Raises:
        GraphError: The matrix does not have nine elements.
    """
    if not hasattr(message, "K"):
        require(message, "sensor_msgs/CameraInfo", "k")
    numbers = np.array(message.k if hasattr(message, "k") else message.K, dtype=float)
    if numbers.shape != (9,):
        raise invalid(f"the camera matrix has {numbers.size} elements instead of 9")
    return locked(numbers.reshape(3, 3))


def _pixel(encoding: str) -> tuple[str, int]:
    """The type and number of the values of a pixel."""
    known = _PIXELS.get(encoding)
    if known is not None:
        return known
    kind, mark, channels = encoding.partition("C")
    # OpenCV's names: 32FC1 or, for one channel, 32F.
    if kind in _DEPTHS and (not mark or (channels.isascii() and channels.isdigit())):
        count = int(channels[:4]) if mark else 1
        if 1 <= count <= 512:
            return _DEPTHS[kind], count
    raise invalid(f'the encoding "{encoding[:60]}" is not supported', encoding=encoding[:60])


def _pixels(message: Any, encoding: str) -> Array:
    """The numbers of an image, shape (height, width) or (height, width, channels)."""
    kind, channels = _pixel(encoding)
    number = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    height, width, step = int(message.height), int(message.width), int(message.step)
    size = number.itemsize
    data = bytes_of(message)
    if min(height, width, step) < 0 or step < width * channels * size or data.size != height * step:
        raise invalid(
            f"an image of {width} x {height} pixels with the encoding {encoding} and a step of "
            f"{step} bytes does not have {data.size} bytes",
            width=width,
            height=height,
            step=step,
            size=data.size,
        )
    shape: tuple[int, ...] = (height, width, channels)
    strides: tuple[int, ...] = (step, channels * size, size)
    if channels == 1:
        shape, strides = shape[:2], strides[:2]
    if not data.size or not width:
        return locked(np.zeros(shape, number))
    return locked(np.ndarray(shape, number, data, strides=strides))


def _decoded(message: Any) -> Array:
    """A compressed image."""
    if "compressedDepth" in str(message.format):
        return _decoded_depth(message)
    pixels = _opened(bytes_of(message))
    # The format states how the numbers are stored: JPEG and PNG files of BGR images contain RGB.
    return locked(pixels)


def _decoded_depth(message: Any) -> Array:
    """A compressed depth image, m."""
    data = bytes_of(message)
    text = str(message.format)
    if "compressedDepth" not in text:
        pixels = _opened(data)
        if pixels.ndim != 2 or pixels.dtype != np.uint16:
            raise invalid(f'the format "{text[:60]}" is not that of a depth image')
        return _in_metres(pixels)
    if data.size < _QUANTISED.size:
        raise invalid(f"a compressed depth image does not have {data.size} bytes", size=data.size)
    _, a, b = _QUANTISED.unpack_from(data.tobytes()[: _QUANTISED.size])
    pixels = _opened(data[_QUANTISED.size :])
    if pixels.ndim != 2 or pixels.dtype != np.uint16:
        raise invalid("a compressed depth image contains no 16-bit pixels")
    if text.startswith("16UC1"):
        return _in_metres(pixels)
    with np.errstate(all="ignore"):
        depths = np.float32(a) / (pixels.astype(np.float32) - np.float32(b))
    depths[pixels == 0] = np.nan
    return locked(depths)


def _opened(data: Array) -> Array:
    """The pixels of a PNG or JPEG file."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(data.tobytes()), formats=("PNG", "JPEG")) as opened:
            width, height = opened.size
            if width * height > _MOST_PIXELS:
                raise invalid(f"a compressed image of {width} x {height} pixels is too large")
            opened.load()
            if opened.mode in ("I;16", "I;16B", "I"):
                return np.array(opened).astype(np.uint16)
            mode = opened.mode if opened.mode in ("L", "RGB", "RGBA") else "RGB"
            return np.array(opened if mode == opened.mode else opened.convert(mode))
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError, Image.DecompressionBombError):
        raise invalid("the data of a compressed image cannot be decoded") from None


def _in_metres(millimetres: Array) -> Array:
    metres = millimetres.astype(np.float32) / np.float32(1000)
    metres[millimetres == 0] = np.nan
    return locked(metres)
