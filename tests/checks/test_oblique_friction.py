"""Wheels whose friction is oblique to the direction in which they roll."""

import pytest
from tests.checks.test_steering_and_casters import BODY, REAR, found

from cartwheel.codes.robot import WHEEL_FRICTION_OBLIQUE

DRIVE = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
  <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter></plugin></gazebo>"""
MECANUM = """<gazebo><plugin name="drive" filename="gz-sim-mecanum-drive-system">
  <front_left_joint>left_joint</front_left_joint><front_right_joint>right_joint</front_right_joint>
  <back_left_joint>left_joint</back_left_joint><back_right_joint>right_joint</back_right_joint>
  <wheel_separation>0.3</wheel_separation><wheelbase>0.4</wheelbase>
  <wheel_radius>0.1</wheel_radius></plugin></gazebo>"""


def tags(first, second, direction):
    """For both wheels. The z axis of their collisions is the axle."""
    fdir = f"<fdir1>{direction}</fdir1>" if direction else ""
    return "".join(
        f'<gazebo reference="{name}"><mu1>{first}</mu1><mu2>{second}</mu2>{fdir}</gazebo>'
        for name in ("left", "right")
    )


@pytest.mark.parametrize(
    ("first", "second", "direction", "angle"),
    [
        (100, 0.2, "1 0 1", 45.0),
        (0.2, 100, "1 0 1", 45.0),
        (100, 0.2, "0.966 0 -0.259", 15.0),
        (100, 0.2, "1 0 0", None),
        (100, 0.2, "0 0 1", None),
        (100, 0.2, "", None),
        (1.2, 1.0, "1 0 1", None),
    ],
)
def test_a_direction_between_the_axle_and_the_way_is_reported(
    tmp_path, first, second, direction, angle
):
    text = BODY.format(more="") + REAR + tags(first, second, direction)
    findings = found(tmp_path, text + DRIVE, WHEEL_FRICTION_OBLIQUE)
    expected = [] if angle is None else [("left_joint", angle), ("right_joint", angle)]
    assert [(each.values["joint"], each.values["angle"]) for each in findings] == [
        (joint, pytest.approx(degrees, abs=0.1)) for joint, degrees in expected
    ]
    # It is the purpose of mecanum wheels.
    assert found(tmp_path, text + MECANUM, WHEEL_FRICTION_OBLIQUE) == []
