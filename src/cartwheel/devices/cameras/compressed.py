"""Compressed images on subtopics, like the plugins for image_transport."""

from __future__ import annotations

import io
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes import running
from cartwheel.component import Component
from cartwheel.devices.cameras.formats import ImageFormat, Pixels
from cartwheel.errors import GraphError
from cartwheel.graph import ReconfigureParameter, choices
from cartwheel.messages import message_class

COMPRESSED = "sensor_msgs/msg/CompressedImage"
_FORMATS = ("jpeg", "png")
_INVERSE = 1
"""Value of the header of compressed depths that selects inverse quantisation."""


def _switch(name: str, *, default: bool, description: str) -> ReconfigureParameter:
    return ReconfigureParameter(name=name, type="bool", default=default, description=description)


def _number(
    name: str, default: float, minimum: float, maximum: float, description: str
) -> ReconfigureParameter:
    return ReconfigureParameter(
        name=name,
        type="int" if isinstance(default, int) else "double",
        default=default,
        minimum=minimum,
        maximum=maximum,
        description=description,
    )


PARAMETERS = (
    _switch("enable", default=True, description="Publish compressed images"),
    ReconfigureParameter(
        name="format",
        type="str",
        default="jpeg",
        description="Compression format",
        edit_method=choices(*_FORMATS, description="JPEG is lossy, PNG is lossless"),
    ),
    _number("jpeg_quality", 80, 1, 100, "JPEG quality; 100 is the best"),
    _switch("jpeg_progressive", default=False, description="Progressive JPEG"),
    _switch("jpeg_optimize", default=False, description="Smaller but slower JPEG"),
    _number(
        "jpeg_restart_interval",
        0,
        0,
        65535,
        "Blocks between JPEG restart markers; 0 for no markers",
    ),
    _number("png_level", 9, 1, 9, "PNG compression level; 9 gives the smallest images"),
)
"""Names, types, defaults and limits are those of compressed_image_transport."""

DEPTH_PARAMETERS = (
    _switch("enable", default=True, description="Publish compressed depths"),
    ReconfigureParameter(
        name="format",
        type="str",
        default="png",
        description="Compression format of depths",
        edit_method=choices("png", "rvl", description="Both are lossless"),
    ),
    _number("depth_max", 10.0, 1.0, 100.0, "Maximum depth, m"),
    _number("depth_quantization", 100.0, 1.0, 150.0, "Depth at which the quantisation step is 1 m"),
    _number("png_level", 1, 1, 9, "PNG compression level; 9 gives the smallest images"),
)
"""Names, types, defaults and limits are those of compressed_depth_image_transport."""


class CompressedImages:
    """The topic ``<image>/compressed``, with parameters that can be changed at run time.

    Source: compressed_image_transport.

    Args:
        owner: The camera.
        image: Topic of the image.
        image_format: Format of the image.
        rate: Publish rate for listings, Hz.
        adjustable: Whether ``dynamic_reconfigure`` offers the parameters.
    """

    def __init__(
        self,
        owner: Component,
        image: str,
        image_format: ImageFormat,
        *,
        rate: float | None,
        adjustable: bool,
    ) -> None:
        self._format = image_format
        self._publisher = owner.advertise(
            f"{image}/compressed", COMPRESSED, rate=rate, qos="sensor"
        )
        self._message = message_class(COMPRESSED)
        self._values: Mapping[str, Any] = {p.name: p.default for p in PARAMETERS}
        if adjustable:
            server = owner.reconfigure(f"{image}/compressed", PARAMETERS, self._change, preset=True)
            self._values = server.values if server is not None else self._values

    @property
    def wanted(self) -> bool:
        return self._publisher.wanted and bool(self._values["enable"])

    def publish(self, moment: Any, pixels: Pixels) -> None:
        """Compresses and publishes RGB pixels, shape (height, width, 3), in the image's format."""
        source = self._format
        kind = self._values["format"]
        transport = f"{source.encoding}; {kind} compressed {'bgr8' if source.colour else ''}"
        data = _compress(pixels if source.colour else source.encode(pixels), kind, self._values)
        self._publisher.publish(
            self._message(
                header=moment,
                format=transport if kind == "jpeg" else transport.rstrip(),
                data=np.frombuffer(data, dtype=np.uint8),
            )
        )

    def _change(self, values: dict[str, Any]) -> None:
        if values["format"] not in _FORMATS:
            raise GraphError(
                f'images cannot be compressed as "{values["format"]}"',
                code=running.IMAGE_COMPRESSION_UNKNOWN,
                values={"format": str(values["format"])},
                hint=f"Supported formats: {', '.join(_FORMATS)}.",
            )
        self._values = values


class CompressedDepths:
    """The topic ``<image>/compressedDepth`` of a depth image in m, as in ROS 2.

    Depths are quantised inversely, so that near depths have smaller steps; 0 means no depth.
    Source: compressed_depth_image_transport.

    Args:
        owner: The camera.
        image: Topic of the depth image.
        rate: Publish rate for listings, Hz.
    """

    def __init__(self, owner: Component, image: str, *, rate: float | None) -> None:
        self._publisher = owner.advertise(
            f"{image}/compressedDepth", COMPRESSED, rate=rate, qos="sensor"
        )
        self._message = message_class(COMPRESSED)
        values: dict[str, Any] = {p.name: p.default for p in DEPTH_PARAMETERS}
        self._furthest, self._level = values["depth_max"], values["png_level"]
        step = values["depth_quantization"]
        self._factor = step * (step + 1.0)
        self._offset = 1.0 - self._factor / self._furthest

    @property
    def wanted(self) -> bool:
        return self._publisher.wanted

    def publish(self, moment: Any, depths: NDArray[np.float32]) -> None:
        """Compresses and publishes depths in m, shape (height, width).

        Depths that are not finite, not positive or beyond the maximum are encoded as 0, no depth.
        """
        from PIL import Image

        valid = np.isfinite(depths) & (depths > 0) & (depths < self._furthest)
        steps = np.zeros(depths.shape, dtype=np.uint16)
        inverse = self._factor / depths[valid] + self._offset
        steps[valid] = np.minimum(inverse, np.iinfo(np.uint16).max)
        buffer = io.BytesIO()
        buffer.write(struct.pack("<iff", _INVERSE, self._factor, self._offset))
        Image.fromarray(steps).save(buffer, format="PNG", compress_level=self._level)
        self._publisher.publish(
            self._message(
                header=moment,
                format="32FC1; compressedDepth png",
                data=np.frombuffer(buffer.getvalue(), dtype=np.uint8),
            )
        )


def _compress(pixels: NDArray[Any], kind: str, values: Mapping[str, Any]) -> bytes:
    from PIL import Image

    if pixels.dtype != np.uint8:
        # In 16-bit images the lower byte repeats the upper one.
        pixels = (pixels >> 8).astype(np.uint8)
    buffer = io.BytesIO()
    image = Image.fromarray(pixels)
    if kind == "png":
        image.save(buffer, format="PNG", compress_level=values["png_level"])
    else:
        image.save(
            buffer,
            format="JPEG",
            quality=values["jpeg_quality"],
            progressive=values["jpeg_progressive"],
            optimize=values["jpeg_optimize"],
            restart_marker_blocks=values["jpeg_restart_interval"],
        )
    return buffer.getvalue()
