"""Sensor tags: types that SDF defines, and ranges that contain something to measure."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Robot, Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, Sensor
from cartwheel.errors import Diagnostic

TYPES = (
    "air_pressure", "air_speed", "altimeter", "boundingbox", "boundingbox_camera", "camera",
    "contact", "custom", "depth", "depth_camera", "dvl", "force_torque", "gps", "gpu_lidar",
    "gpu_ray", "imu", "lidar", "logical_camera", "magnetometer", "multicamera", "navsat", "ray",
    "rfid", "rfidtag", "rgbd", "rgbd_camera", "segmentation", "segmentation_camera", "sonar",
    "thermal", "thermal_camera", "triggered_camera", "wide_angle_camera", "wideanglecamera",
    "wireless_receiver", "wireless_transmitter",
)  # fmt: skip
"""Sensor types up to SDF 1.11."""
FORMATS = (
    "R8G8B8", "B8G8R8", "L8", "L16", "R16G16B16", "BAYER_RGGB8", "BAYER_BGGR8", "BAYER_GBRG8",
    "BAYER_GRBG8", "R_FLOAT16", "R_FLOAT32", "RGB_FLOAT16", "RGB_FLOAT32", "RGB_INT8", "RGB_INT16",
    "RGB_INT32", "BGR_INT8", "BGR_INT16", "BGR_INT32", "L_INT8", "L_INT16", "RGB8", "BGR8", "MONO8",
    "MONO16", "RGB16", "UNKNOWN_PIXEL_FORMAT", "RGBA_INT8", "BGRA_INT8", "FLOAT32", "32FC1",
)  # fmt: skip
"""Image formats in SDF and in Gazebo's SDF reader."""
_LISTED = 9
_TURN = 2 * math.pi + 0.01


@rule(devices_codes.SENSOR_TYPE_UNKNOWN)
def sensor_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in _sensors(subject):
        if sensor.type in TYPES:
            continue
        yield spelling.misspelt(
            devices_codes.SENSOR_TYPE_UNKNOWN,
            sensor.type,
            TYPES,
            attribute="type",
            message=f'sensor "{sensor.name}" has the type "{sensor.type}", which Gazebo does '
            "not support",
            values={"sensor": sensor.name, "type": sensor.type},
            origin=sensor.origin,
            mark="type",
        )


@rule(devices_codes.SENSOR_RANGE_INVALID)
def sensor_range(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in _sensors(subject):
        for element in _below(sensor.element):
            if element.tag in ("horizontal", "vertical"):
                yield from _arc(element)
            elif element.tag in ("range", "clip"):
                yield from _span(element)
            elif element.tag == "image":
                yield from _counts(element, ("width", "height"))


@rule(devices_codes.IMAGE_FORMAT_UNKNOWN)
def image_format(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in _sensors(subject):
        for element in _below(sensor.element):
            image = element.find("format") if element.tag == "image" else None
            name = image.text.strip() if image is not None else ""
            if image is None or not name or name.upper() in FORMATS:
                continue
            near = spelling.meant(name, FORMATS, parts=False) or "R8G8B8"
            yield devices_codes.IMAGE_FORMAT_UNKNOWN.diagnostic(
                message=f'the image format "{name}" does not exist, so R8G8B8 is used',
                values={"format": name},
                origin=image.origin,
                instead=nodes.written("format", {}, near),
                place="element",
                mark=name,
                hint=f"Supported formats: {', '.join(FORMATS[:_LISTED])}, ….",
            )


def _arc(element: Element) -> Iterator[Diagnostic]:
    yield from _counts(element, ("samples",))
    low, high = _value(element, "min_angle"), _value(element, "max_angle")
    first = element.find("min_angle")
    for tag, angle in (("min_angle", low), ("max_angle", high)):
        found = element.find(tag)
        if found is not None and angle is not None and abs(angle) > _TURN:
            yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
                severity="warning",
                message=f"<{tag}> is {angle:g} rad, more than a full turn",
                values={"tag": tag, "angle": angle},
                hint="Is the angle in degrees?",
                origin=found.origin,
                instead=nodes.written(tag, {}, nodes.short(math.radians(angle))),
                place="element",
                mark=found.text.strip(),
            )
            return
    if first is not None and low is not None and high is not None and low > high:
        yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
            severity="info",
            message=f"<min_angle> ({low:g} rad) is above <max_angle> ({high:g} rad), so the scan "
            "runs clockwise",
            values={"tag": "min_angle", "lower": low, "upper": high},
            origin=first.origin,
            instead=nodes.written("min_angle", {}, nodes.short(high)),
            place="element",
            mark=first.text.strip(),
            hint="Most programs expect counterclockwise scans. Also set <max_angle> to "
            f"{nodes.short(low)}.",
        )


def _span(element: Element) -> Iterator[Diagnostic]:
    near, far = ("min", "max") if element.tag == "range" else ("near", "far")
    low, high = _value(element, near), _value(element, far)
    first = element.find(near)
    if first is None or low is None or high is None or low < high:
        return
    yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
        message=f"<{near}> ({low:g} m) is not below <{far}> ({high:g} m)",
        values={"tag": near, "lower": low, "upper": high},
        origin=first.origin,
        instead=nodes.written(near, {}, nodes.short(high if 0 <= high < low else 0.1)),
        place="element",
        mark=first.text.strip(),
        hint=f"Also set <{far}> to {nodes.short(low)}." if 0 <= high < low else "",
    )


def _counts(element: Element, tags: tuple[str, ...]) -> Iterator[Diagnostic]:
    for tag in tags:
        value, found = _value(element, tag), element.find(tag)
        if found is not None and value is not None and value < 1:
            yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
                message=f"<{tag}> is {value:g}, but must be at least 1",
                values={"tag": tag, "value": value},
                origin=found.origin,
                instead=nodes.written(tag, {}, "640" if tag != "height" else "480"),
                place="element",
                mark=found.text.strip(),
            )


def _below(element: Element) -> Iterator[Element]:
    for child in element.children:
        if child.tag != "plugin":
            yield child
            yield from _below(child)


def _value(element: Element, tag: str) -> float | None:
    found = element.find(tag)
    return nodes.number(found.text) if found is not None else None


def _sensors(subject: Subject) -> Iterator[tuple[Robot, Sensor]]:
    for robot in subject.robots:
        for _, sensor in robot.sensors():
            yield robot, sensor


RULES = (sensor_type_unknown, sensor_range, image_format)
