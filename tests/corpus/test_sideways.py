"""Bases that also move sideways."""

import pytest
import yaml
from tests.corpus.carts import cart, plugin, written
from tests.dialects.ros_control.arms import ros2_parameters, ros2_plugin
from tests.dialects.ros_control.cars import BASE, RADIUS, TRACK, car, four_wheels, rollers

from cartwheel.codes.robot import WHEEL_DIAMETER_MISMATCH
from cartwheel.corpus import try_robot

PLANAR = '<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"/></gazebo>'
MECANUM = """<plugin name="drive" filename="gz-sim-mecanum-drive-system">
  <front_left_joint>front_left_joint</front_left_joint>
  <front_right_joint>front_right_joint</front_right_joint>
  <back_left_joint>rear_left_joint</back_left_joint>
  <back_right_joint>rear_right_joint</back_right_joint>
  <wheelbase>0.5</wheelbase><wheel_separation>0.4</wheel_separation>
  <wheel_radius>{radius}</wheel_radius></plugin>"""


def mecanum(tmp_path, radius, tags):
    path = tmp_path / "car.urdf"
    path.write_text(car(four_wheels(), MECANUM.format(radius=radius), (), tags))
    verdict = try_robot(path, standing=1.0)
    (drive,) = verdict.drives
    assert drive.commanded_sideways == 0.2
    return verdict, drive.measured_sideways


@pytest.mark.parametrize("tags", ["", rollers()], ids=["pushed", "rollers"])
def test_a_mecanum_drive_is_commanded_sideways(tmp_path, tags):
    verdict, measured = mecanum(tmp_path, RADIUS, tags)
    assert measured == pytest.approx(0.2, rel=0.05)
    assert verdict.good, verdict.faults


def test_a_wheel_of_half_the_stated_radius_moves_sideways_at_half_the_speed(tmp_path):
    verdict, measured = mecanum(tmp_path, 2 * RADIUS, rollers())
    assert measured == pytest.approx(0.1, rel=0.05)
    codes = {each.test: each.code for each in verdict.faults}
    assert codes["sideways"] is WHEEL_DIAMETER_MISMATCH
    assert verdict.outcome == "file"


def test_a_differential_drive_is_not(tmp_path):
    (drive,) = try_robot(written(tmp_path, cart(), plugin()), standing=1.0).drives
    assert drive.commanded_sideways == drive.error_sideways == 0.0
    assert drive.slides


def test_a_base_without_wheels_is_commanded_sideways(tmp_path):
    box = cart().replace('type="continuous"', 'type="fixed"')
    (drive,) = try_robot(written(tmp_path, box, PLANAR), standing=1.0).drives
    assert drive.commanded_sideways == 0.2
    assert drive.slides


def test_wheels_that_roll_sideways_do_not_turn_the_frame_of_a_pushed_base(tmp_path):
    """Axles along x: the wheels roll when the base is pushed along y."""
    turned = cart().replace('rpy="-1.5708 0 0"', 'rpy="0 1.5708 0"')
    assert turned != cart()
    (drive,) = try_robot(written(tmp_path, turned, PLANAR), standing=1.0).drives
    assert drive.measured_sideways == pytest.approx(0.2, rel=0.05)
    assert drive.slides


@pytest.mark.parametrize("yaw", [1.5707963, -1.5707963, 0.0])
def test_a_base_that_drives_along_y_moves_to_its_own_left(tmp_path, yaw):
    """The wheels show the forward direction while it drives forward, but not to the side."""
    names = ("front_left", "front_right", "rear_left", "rear_right")
    settings = {
        "type": "mecanum_drive_controller/MecanumDriveController",
        **{f"{name}_wheel_command_joint_name": f"{name}_joint" for name in names},
        "kinematics": {
            "wheels_radius": RADIUS,
            "sum_of_robot_center_projection_on_X_Y_axis": (BASE + TRACK) / 2,
        },
    }
    file = tmp_path / "drive.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(base=settings)))
    text = car(four_wheels(), ros2_plugin(file), file.read_text(), rollers())
    turned = (
        '<link name="footprint"/><joint name="turned" type="fixed"><parent link="footprint"/>'
        f'<child link="base_link"/><origin rpy="0 0 {yaw}"/></joint></robot>'
    )
    path = tmp_path / "car.urdf"
    path.write_text(text.replace("</robot>", turned))
    (drive,) = try_robot(path, standing=1.0).drives
    assert drive.measured == pytest.approx(0.2, rel=0.05)
    assert drive.measured_sideways == pytest.approx(0.2, rel=0.05)
