"""Image formats of cameras."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.sensor_ranges import elements_in, sensors_of
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic

FORMATS = (
    "R8G8B8", "B8G8R8", "L8", "L16", "R16G16B16", "BAYER_RGGB8", "BAYER_BGGR8", "BAYER_GBRG8",
    "BAYER_GRBG8", "R_FLOAT16", "R_FLOAT32", "RGB_FLOAT16", "RGB_FLOAT32", "RGB_INT8", "RGB_INT16",
    "RGB_INT32", "BGR_INT8", "BGR_INT16", "BGR_INT32", "L_INT8", "L_INT16", "RGB8", "BGR8", "MONO8",
    "MONO16", "RGB16", "UNKNOWN_PIXEL_FORMAT", "RGBA_INT8", "BGRA_INT8", "FLOAT32", "32FC1",
)  # fmt: skip
"""Image formats in SDF and in Gazebo's SDF reader."""
_LISTED = 9


@rule(devices_codes.IMAGE_FORMAT_UNKNOWN)
def image_format(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in sensors_of(subject):
        for element in elements_in(sensor.element):
            image = element.find("format") if element.tag == "image" else None
            name = image.text.strip() if image is not None else ""
            if image is None or not name or name.upper() in FORMATS:
                continue
            near = spelling.meant(name, FORMATS, parts=False) or "R8G8B8"
            yield devices_codes.IMAGE_FORMAT_UNKNOWN.diagnostic(
                message=f'unknown image format "{name}"; R8G8B8 is used',
                values={"format": name},
                **edits.text(image, near),
                hint=f"Supported formats: {', '.join(FORMATS[:_LISTED])}, ….",
            )
