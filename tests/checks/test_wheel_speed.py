"""Velocity limits of wheels with which a base hardly drives."""

import pytest
import yaml
from tests.checks.test_steering_and_casters import BODY, REAR

from cartwheel.checks.checking import check
from cartwheel.codes.robot import WHEEL_SPEED_LIMITED

GZ = """<gazebo><plugin name="drive" filename="gz-sim-diff-drive-system">
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
  <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin></gazebo>"""
CAR = GZ.replace("diff-drive", "ackermann-steering")
MECANUM = """<gazebo><plugin name="drive" filename="gz-sim-mecanum-drive-system">
  <front_left_joint>left_joint</front_left_joint><front_right_joint>right_joint</front_right_joint>
  <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin></gazebo>"""
CLASSIC = GZ.replace("gz-sim-diff-drive-system", "libgazebo_ros_diff_drive.so")
CONTROL = '<gazebo><plugin name="c" filename="{}"><parameters>c.yaml</parameters></plugin></gazebo>'
JOINTS = (
    '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
    "</plugin></hardware>"
    + "".join(
        f'<joint name="{side}_joint"><command_interface name="velocity"/>'
        '<state_interface name="position"/><state_interface name="velocity"/></joint>'
        for side in ("left", "right")
    )
    + "</ros2_control>"
)
CONTROLLERS = {
    "controller_manager": {
        "ros__parameters": {"base": {"type": "diff_drive_controller/DiffDriveController"}}
    },
    "base": {
        "ros__parameters": {
            "left_wheel_names": ["left_joint"],
            "right_wheel_names": ["right_joint"],
            "wheel_separation": 0.3,
            "wheel_radius": 0.1,
        }
    },
}


@pytest.mark.parametrize(
    ("drive", "velocity", "reported"),
    [
        (GZ, 0.4, True),
        (GZ, 0.6, False),
        (GZ, 0.0, False),
        (CAR, 0.4, True),
        (CAR, 0.6, False),
        (MECANUM, 0.4, True),
        (CLASSIC, 0.4, False),
        (JOINTS + CONTROL.format("gz_ros2_control-system"), 0.4, True),
        (JOINTS + CONTROL.format("libgazebo_ros2_control.so"), 0.4, False),
    ],
)
def test_a_limit_that_applies_is_reported(tmp_path, drive, velocity, reported):
    """0.4 rad/s on a radius of 0.1 m are 4 cm/s."""
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(CONTROLLERS))
    path = tmp_path / "cart.urdf"
    limit = f'<axis xyz="0 1 0"/><limit effort="9" velocity="{velocity}"/>'
    wheels = REAR.replace('<axis xyz="0 1 0"/>', limit)
    path.write_text(f'<robot name="cart">{BODY.format(more="")}{wheels}{drive}</robot>')
    report = check(path, controller_files=[tmp_path / "c.yaml"])
    found = [each for each in report.findings if each.code is WHEEL_SPEED_LIMITED]
    assert [each.values["joint"] for each in found] == ["left_joint", "right_joint"] * reported
    for each in found:
        assert each.values["speed"] == pytest.approx(0.04)
        assert each.severity == "warning"
