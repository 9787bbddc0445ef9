"""Ranges, angles and sizes of sensors."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, Sensor
from cartwheel.errors import Diagnostic

_TURN = 2 * math.pi + 0.01


@rule(devices_codes.SENSOR_RANGE_INVALID)
def sensor_range(subject: Subject) -> Iterator[Diagnostic]:
    for _, sensor in sensors_of(subject):
        for element in elements_in(sensor.element):
            if element.tag in ("horizontal", "vertical"):
                yield from _arc(element)
            elif element.tag in ("range", "clip"):
                yield from _span(element)
            elif element.tag == "image":
                yield from _counts(element, ("width", "height"))


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
                **edits.text(found, nodes.short(math.radians(angle))),
            )
            return
    if first is not None and low is not None and high is not None and low > high:
        yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
            severity="info",
            message=f"<min_angle> ({low:g} rad) is above <max_angle> ({high:g} rad), so the scan "
            "runs clockwise",
            values={"tag": "min_angle", "lower": low, "upper": high},
            **edits.text(first, nodes.short(high)),
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
        **edits.text(first, nodes.short(high if 0 <= high < low else 0.1)),
        hint=f"Also set <{far}> to {nodes.short(low)}." if 0 <= high < low else "",
    )


def _counts(element: Element, tags: tuple[str, ...]) -> Iterator[Diagnostic]:
    for tag in tags:
        value, found = _value(element, tag), element.find(tag)
        if found is not None and value is not None and value < 1:
            yield devices_codes.SENSOR_RANGE_INVALID.diagnostic(
                message=f"<{tag}> is {value:g}, but must be at least 1",
                values={"tag": tag, "value": value},
                **edits.text(found, "640" if tag != "height" else "480"),
            )


def elements_in(element: Element) -> Iterator[Element]:
    """All elements in a sensor, except those of its plugins."""
    for child in element.children:
        if child.tag != "plugin":
            yield child
            yield from elements_in(child)


def _value(element: Element, tag: str) -> float | None:
    found = element.find(tag)
    return nodes.number(found.text) if found is not None else None


def sensors_of(subject: Subject) -> Iterator[tuple[Robot, Sensor]]:
    """All sensors, each with its robot."""
    for robot in subject.robots:
        for _, sensor in robot.sensors():
            yield robot, sensor
