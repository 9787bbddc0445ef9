"""The stand-in of the iRobot Create 3: frames, sensors and drive in both dialects."""

import math

import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.checks import check
from cartwheel.codes.files import STAND_IN_USED
from cartwheel.description import load_text
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import rotate

FILE = "$(find irobot_create_description)/urdf/create3.urdf.xacro"
TEXT = (
    '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    f'<xacro:include filename="{FILE}"/>{{}}</robot>'
)
FRAMES = {
    "left_wheel": (0, 0.1165, 0.0402),
    "right_wheel": (0, -0.1165, 0.0402),
    "wheel_drop_left": (0, 0.1165, 0.0402),
    "imu_link": (0.050613, 0.043673, 0.0844),
    "bump_front_center": (0, 0, 0.0392),
    "bump_left": (0.0875, -0.15155, 0.0642),
    "cliff_front_left": (0.16, 0.045, 0.0192),
    "ir_intensity_side_left": (0.0399, 0.1488, 0.0572),
    "ir_omni": (0.153, 0, 0.0992),
    "mouse": (0.1015, 0.087, 0.0092),
    "button_power": (0.06, 0, 0.1442),
}
BEHIND = (
    '<link name="load"><inertial><mass value="1"/><inertia ixx="0.001" iyy="0.001" izz="0.001" '
    'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="load_joint" type="fixed">'
    '<parent link="base_link"/><child link="load"/><origin xyz="-0.12 0 0.2"/></joint>'
)


def create3(*, more: str = "", **arguments: str) -> RobotDescription:
    robot = load_text(TEXT.format(more), arguments=arguments)
    assert isinstance(robot, RobotDescription)
    return robot


@pytest.mark.parametrize("gazebo", ["classic", "ignition"])
def test_frames(gazebo):
    robot = create3(gazebo=gazebo)
    (used,) = coded(robot, STAND_IN_USED)
    assert used.values["package"] == "irobot_create_description"
    assert [each for each in robot.diagnostics if each.severity != "info"] == []
    for frame, position in FRAMES.items():
        assert robot.link(frame).pose.position == pytest.approx(position, abs=2e-5), frame
    # The IR sensors look outward, and the buttons' x axes point up.
    assert rotate(robot.link("ir_intensity_left").pose.orientation, (1, 0, 0)) == pytest.approx(
        (math.cos(math.radians(50)), math.sin(math.radians(50)), 0)
    )
    assert rotate(robot.link("button_1").pose.orientation, (1, 0, 0)) == pytest.approx((0, 0, 1))


def test_check_reports_only_that_it_is_used(tmp_path):
    file = tmp_path / "robot.urdf.xacro"
    file.write_text(TEXT.format(""))
    assert [each.code for each in check(file).findings] == [STAND_IN_USED]


@pytest.mark.parametrize("more", ["", BEHIND], ids=["alone", "load behind"])
@pytest.mark.parametrize("gazebo", ["classic", "ignition"])
@pytest.mark.parametrize("namespace", ["", "/one"])
def test_the_wheels_carry_and_drive_the_robot(make, gazebo, namespace, more):
    world: cw.World = make.world()
    robot = world.spawn(create3(gazebo=gazebo, namespace=namespace, more=more), z=0.01)
    odometry, imu = world.mailbox(f"{namespace}/odom"), world.mailbox(f"{namespace}/imu")
    world.run(1)
    assert imu.drain()[-1].header.frame_id == "imu_link"
    start = robot.pose
    world.publish(f"{namespace}/cmd_vel", linear_x=0.2)
    world.run(4)
    moved = start.inverse() @ robot.pose
    # The acceleration of 0.9 m/s² delays it by 0.1 s.
    assert moved.position[0] == pytest.approx(0.8, rel=0.05)
    assert abs(moved.position[1]) < 0.01
    assert odometry.drain()[-1].twist.twist.linear.x == pytest.approx(0.2, rel=0.05)
    world.publish(f"{namespace}/cmd_vel", angular_z=1.0)
    world.run(1)
    before = robot.pose
    world.run(1)
    assert (before.inverse() @ robot.pose).yaw == pytest.approx(1, rel=0.05)


@pytest.mark.parametrize("gazebo", ["classic", "ignition"])
@pytest.mark.parametrize("angle", [-60, -30, 0, 30, 60])
def test_every_piece_of_the_bumper_feels(make, gazebo, angle):
    world: cw.World = make.world()
    world.spawn(create3(gazebo=gazebo), z=0.001)
    contacts = world.mailbox("/bumper_contact")
    world.run(0.3)
    assert not any(message.states for message in contacts.drain())
    place = (0.19 * math.cos(math.radians(angle)), 0.19 * math.sin(math.radians(angle)))
    world.spawn(make.box("wall", size=(0.05, 0.05, 0.2)), x=place[0], y=place[1], z=0.1)
    world.run(0.3)
    assert any(message.states for message in contacts.drain())


def test_the_macros_of_a_robot_on_it(make):
    """As a robot uses them: units, inertias, materials and a laser."""
    laser = """<link name="post">
      <visual><geometry><sphere radius="0.1"/></geometry><xacro:insert_block name="material_black"/>
      </visual>
      <xacro:inertial_sphere mass="5" radius="${10*cm2m}"/></link>
    <link name="laser"><visual><geometry><sphere radius="${50*mm2m}"/></geometry></visual>
      <xacro:inertial_cylinder mass="12" radius="1" length="${1/in2m*0.0254}"/></link>
    <link name="dummy"><xacro:inertial_dummy/></link>
    <joint name="a" type="fixed"><parent link="base_link"/><child link="post"/></joint>
    <joint name="c" type="fixed"><parent link="base_link"/><child link="dummy"/></joint>
    <joint name="b" type="fixed"><parent link="base_link"/><child link="laser"/>
      <origin xyz="0 0 0.3" rpy="0 0 ${90*deg2rad}"/></joint>
    <gazebo reference="laser"><xacro:ray_sensor sensor_name="eye" gazebo="$(arg gazebo)"
      update_rate="10" visualize="1" h_samples="9" h_res="1" h_min_angle="-1" h_max_angle="1"
      r_min="0.1" r_max="12" r_res="0.01"><plugin name="eye" filename="libgazebo_ros_ray_sensor.so">
      <ros><remapping>~/out:=scan</remapping></ros><output_type>sensor_msgs/LaserScan</output_type>
      </plugin></xacro:ray_sensor><xacro:material_black/></gazebo>
    <gazebo reference="post"><xacro:material_darkgray/></gazebo>"""
    for gazebo, plugins in (("classic", 1), ("ignition", 0)):
        robot = create3(gazebo=gazebo, more=laser)
        assert [each for each in robot.diagnostics if each.severity != "info"] == []
        (sensor,) = robot.link("laser").sensors
        assert len(sensor.plugins) == plugins
        assert robot.link("post").inertial.ixx == pytest.approx(0.4 * 5 * 0.01)
        assert robot.link("laser").inertial.ixx == pytest.approx(3 + 1)
        assert robot.link("dummy").inertial.mass < 0.01
