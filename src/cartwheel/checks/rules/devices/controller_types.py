"""Types of controllers."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import spelling
from cartwheel.checks.controller_claims import (
    severity_in,
    used_controllers,
)
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.files.plugin_xml import exporting_file
from cartwheel.dialects.ros_control.catalogue import controller_types
from cartwheel.dialects.ros_control.fetch import TRANSLATED
from cartwheel.errors import Diagnostic

_OF_OTHER_ROS = {
    True: {
        "joint_state_controller/JointStateController": "joint_state_broadcaster/"
        "JointStateBroadcaster",
        **{
            f"{kind}_controllers/JointTrajectoryController": "joint_trajectory_controller/"
            "JointTrajectoryController"
            for kind in ("position", "velocity", "effort")
        },
    },
    False: {
        "joint_state_broadcaster/JointStateBroadcaster": "joint_state_controller/"
        "JointStateController",
    },
}
"""Controller types of the other ROS version and their equivalents, by whether the file is ROS 2."""


@rule(devices_codes.CONTROLLER_TYPE_UNKNOWN)
def controller_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    known = sorted({*controller_types(), *TRANSLATED})
    for controller in used_controllers(subject):
        kind = controller.kind
        other = _OF_OTHER_ROS[controller.file.is_ros2].get(kind, "")
        near = other or ("" if kind in known else spelling.meant(kind, known, parts=False))
        if kind in known and not other:
            continue
        own = not other and kind not in known and exporting_file(controller.file.path, kind)
        if own:
            near = ""
        if not near and not own and not controller.file.named:
            continue
        message = f'the controller type "{controller.type.text}" does not exist'
        if other and controller.file.is_ros2:
            message = f'ROS 2 has no controller type "{controller.type.text}"'
        elif other:
            message = f'ROS 1 has no controller type "{controller.type.text}"'
        elif not near:
            message = f'Cartwheel does not simulate the controller type "{controller.type.text}"'
        yield devices_codes.CONTROLLER_TYPE_UNKNOWN.diagnostic(
            severity=severity_in(controller.file, "warning" if other else "error")
            if near
            else "info",
            message=message + f', so "{controller.name}" does not start' * bool(near),
            values={"type": controller.type.text, "controller": controller.name, "meant": near},
            origin=controller.type.origin,
            instead=controller.type.replaced(near) if near else "",
            place="line" if near else "",
            mark=controller.type.text,
        )
