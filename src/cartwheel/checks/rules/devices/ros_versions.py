"""Plugins of the other version of ROS."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.other_ros import other_ros
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic


@rule(devices_codes.PLUGIN_OF_OTHER_ROS)
def plugin_of_other_ros(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            found = other_ros(robot, tag)
            if found is not None:
                yield found
