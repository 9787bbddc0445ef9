"""SDF's ``<camera>`` element: its lenses as they can be rendered."""

from __future__ import annotations

import dataclasses

from cartwheel.codes import devices
from cartwheel.component import Component
from cartwheel.description.model import CameraIntrinsics, Sensor
from cartwheel.devices.cameras.formats import (
    BAYER8,
    BGR8,
    MONO8,
    MONO16,
    RGB8,
    RGB16,
    ImageFormat,
)
from cartwheel.devices.cameras.lens import Distortion

_WIDEST_VIEW = 2.8
"""Largest field of view, rad; a wider image of a pinhole camera is nearly all border."""
_UNSUPPORTED = {
    "lens": "<horizontal_fov> specifies the field of view",
    "save": "images are not saved",
    "visibility_mask": "all visuals are rendered",
}
"""Unsupported elements of SDF cameras, and what applies instead."""
_WIDE = ("wideanglecamera", "wide_angle_camera")
_PINHOLE = ("intrinsics", "projection")
"""Elements of ``<lens>`` that state a pinhole."""
NO_DISTORTION = Distortion()

_FORMATS = {
    "R8G8B8": RGB8,
    "RGB_INT8": RGB8,
    "RGB8": RGB8,
    "B8G8R8": BGR8,
    "BGR_INT8": BGR8,
    "BGR8": BGR8,
    "L8": MONO8,
    "L_INT8": MONO8,
    "MONO8": MONO8,
    "L16": MONO16,
    "L_INT16": MONO16,
    "MONO16": MONO16,
    "R16G16B16": RGB16,
    "RGB_INT16": RGB16,
    "RGB16": RGB16,
} | {f"BAYER_{pattern}8": image_format for pattern, image_format in BAYER8.items()}
"""By upper-case SDF format. Source: SDF, ``<camera><image><format>``; gazebo_ros_camera_utils."""


def read_camera(plugin: Component, sensor: Sensor, *, pinhole: bool = False) -> Sensor:
    """Returns a camera sensor with at least one lens, and reports unsupported elements.

    Args:
        plugin: Reports the diagnostics.
        sensor: The sensor.
        pinhole: Whether the focal lengths in ``<lens>`` are used.
    """
    if not sensor.cameras:
        sensor = dataclasses.replace(sensor, cameras=(CameraIntrinsics(),))
        lens = sensor.cameras[0]
        plugin.warn(
            devices.SENSOR_INCOMPLETE,
            f'sensor "{sensor.name}" has no <camera>, so SDF\'s defaults are used: '
            f"{lens.width} x {lens.height} pixels and a field of view of "
            f"{lens.horizontal_fov:g} rad",
            at=sensor.origin,
            values={"sensor": sensor.name, "missing": "camera"},
        )
    if sensor.type in _WIDE:
        plugin.warn(
            devices.CAMERA_VIEW_NARROWED, "the wide-angle lens is rendered as a pinhole camera"
        )
    for camera in sensor.element.find_all("camera"):
        for child in camera.children:
            if pinhole and child.tag == "lens" and any(map(child.find, _PINHOLE)):
                continue
            if child.tag in _UNSUPPORTED and child.attribute("enabled") not in ("false", "0"):
                plugin.warn(
                    devices.SENSOR_SETTING_IGNORED,
                    f"<{child.tag}> has no effect: {_UNSUPPORTED[child.tag]}",
                    at=child.origin,
                    values={"setting": child.tag},
                )
    return sensor


def read_lens(
    plugin: Component, lens: CameraIntrinsics, distortion: Distortion = NO_DISTORTION
) -> tuple[CameraIntrinsics, Distortion, ImageFormat]:
    """Returns a lens that can be rendered, with the distortion and format of its images.

    Args:
        plugin: Reports values that are adjusted.
        lens: The lens.
        distortion: Distortion that the plugin states. That of the lens takes precedence.
    """
    return (
        _narrowed(plugin, lens),
        _distortion(plugin, lens, distortion),
        _image_format(plugin, lens.format),
    )


def _narrowed(plugin: Component, lens: CameraIntrinsics) -> CameraIntrinsics:
    if lens.horizontal_fov <= _WIDEST_VIEW:
        return lens
    plugin.warn(
        devices.CAMERA_VIEW_NARROWED,
        f"the field of view of {lens.horizontal_fov:g} rad is rendered as {_WIDEST_VIEW:g} "
        "rad, the maximum for a pinhole camera",
        values={"stated": lens.horizontal_fov, "used": _WIDEST_VIEW},
    )
    return dataclasses.replace(lens, horizontal_fov=_WIDEST_VIEW)


def _distortion(plugin: Component, lens: CameraIntrinsics, configured: Distortion) -> Distortion:
    own = Distortion(k1=lens.k1, k2=lens.k2, p1=lens.p1, p2=lens.p2, k3=lens.k3)
    if not any(own.coefficients):
        return configured
    if any(configured.coefficients) and configured != own:
        plugin.warn(
            devices.PLUGIN_PARAMETER_IGNORED,
            "the plugin's distortion has no effect: the sensor's <distortion> is used",
            values={"parameter": "distortion"},
        )
    if lens.distortion_center != (0.5, 0.5):
        plugin.warn(
            devices.SENSOR_SETTING_IGNORED,
            "the <center> of the distortion is rendered, but camera_info has no field for it",
            values={"setting": "center"},
        )
    return own


def _image_format(plugin: Component, name: str) -> ImageFormat:
    """Returns the format with this name; colour, with a warning, if it is not supported."""
    known = _FORMATS.get(name.strip().upper())
    if known is not None:
        return known
    # Float formats belong to depth cameras, whose depths are always floats.
    if "FLOAT" not in name.upper():
        plugin.warn(
            devices.IMAGE_FORMAT_UNKNOWN,
            f'unknown image format "{name}"; R8G8B8 is used',
            hint=f"Supported formats: {', '.join(_FORMATS)}.",
            values={"format": name},
        )
    return RGB8
