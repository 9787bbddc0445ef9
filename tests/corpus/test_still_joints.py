"""Joints whose limits let nothing move them."""

import pytest
import yaml
from tests.corpus.carts import written
from tests.dialects.ros_control.arms import (
    beam,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
)

from cartwheel.codes.robot import EFFORT_ZERO
from cartwheel.corpus import try_robot


@pytest.mark.parametrize(("velocity", "good"), [(3, True), (0, False)])
def test_a_velocity_limit_of_0_is_why_a_joint_does_not_follow_its_commands(
    tmp_path, velocity, good
):
    file = tmp_path / "arm.yaml"
    one = {"type": "position_controllers/JointGroupPositionController", "joints": ["beam_joint"]}
    file.write_text(yaml.safe_dump(ros2_parameters(one=one)))
    limit = f'lower="-1" upper="1" effort="100" velocity="{velocity}"'
    arm = '<link name="world"/>' + beam("beam", "world", axis="0 0 1", limit=limit)
    control = f"<gazebo>{ros2_plugin(file)}</gazebo>"
    path = written(tmp_path, arm, ros2_system(ros2_joint("beam_joint")), control)
    verdict = try_robot(path, standing=1.0)
    assert verdict.good is good
    assert [(each.test, each.code) for each in verdict.faults] == [("reach", EFFORT_ZERO)][good:]
