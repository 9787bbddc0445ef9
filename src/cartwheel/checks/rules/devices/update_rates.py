"""Rates in tags, compared with the rate of the physics."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes, plugin_tags
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.errors import Diagnostic


@rule(devices_codes.RATE_ABOVE_PHYSICS)
def rate_above_physics(subject: Subject) -> Iterator[Diagnostic]:
    highest = 1.0 / subject.step
    for robot in subject.robots:
        for element in _rates(robot):
            rate = nodes.number(element.text)
            if rate is not None and rate > highest * 1.001:
                yield devices_codes.RATE_ABOVE_PHYSICS.diagnostic(
                    message=f"<{element.tag}> of {rate:g} Hz exceeds the physics rate of "
                    f"{highest:g} steps per second",
                    values={"tag": element.tag, "rate": rate, "highest": highest},
                    **edits.text(element, nodes.short(highest)),
                )


def _rates(robot: Robot) -> Iterator[Element]:
    for tag, _ in robot.plugins():
        rates = plugin_tags.tags_with(tag.filename, "rate")
        yield from (each for each in tag.element.children if each.tag in rates)
    for _, sensor in robot.sensors():
        yield from sensor.element.find_all("update_rate")
