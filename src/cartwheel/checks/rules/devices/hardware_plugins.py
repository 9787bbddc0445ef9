"""Whether a plugin runs the hardware of ``<ros2_control>`` that is made for Gazebo."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros_control.interfaces import MANAGERS, hardware_of
from cartwheel.errors import Diagnostic


@rule(devices_codes.HARDWARE_WITHOUT_PLUGIN)
def hardware_without_plugin(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        description = robot.description
        if any("control" in short_name(tag.filename) for tag in description.plugins):
            continue  # perhaps a controller manager under another name
        for system in description.ros2_control:
            hardware = hardware_of(system)
            if hardware not in MANAGERS:
                continue
            name, file = system.attribute("name") or "", MANAGERS[hardware]
            yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
                f'<ros2_control name="{name}"> has the hardware "{hardware}", but the description '
                f'does not contain the plugin "{file}", which runs it, so no controller starts',
                origin=system.origin,
                values={"hardware": hardware, "plugin": file, "name": name},
                hint=f'Add <gazebo><plugin filename="{file}" name="…"/></gazebo>.',
            )
