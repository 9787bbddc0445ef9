"""Where gz-sim's joint controllers move a robot's joints before the first command."""

from __future__ import annotations

from cartwheel.description.model import RobotDescription
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.joint_controller import JointPositionController, JointPositionParameters
from cartwheel.dialects.gz.joint_trajectory import GzJointTrajectory, JointTrajectoryParameters
from cartwheel.dialects.tags import read
from cartwheel.errors import PluginError


def initial_targets(description: RobotDescription) -> dict[str, float]:
    """The targets that plugins state with ``<initial_position>``, rad or m, by joint.

    Those of a JointTrajectoryController without ``<joint_name>`` are left out.
    """
    targets: dict[str, float] = {}
    for tag in description.plugins:
        plugin = plugin_named(tag.filename)
        try:
            if plugin is GzJointTrajectory:
                steps, _ = read(JointTrajectoryParameters, tag.element)
                pairs = zip(steps.joints, steps.initial, strict=False)
            elif plugin is JointPositionController:
                servo, _ = read(JointPositionParameters, tag.element)
                pairs = zip(servo.joints, [servo.initial] * len(servo.joints), strict=True)
            else:
                continue
        except PluginError:
            continue
        targets |= {name.strip(): target for name, target in pairs}
    return targets
