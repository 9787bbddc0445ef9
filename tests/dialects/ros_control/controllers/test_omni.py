"""Omni wheels: three of them move a robot in all directions, and measure how it moves."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ros2_joint, ros2_parameters, ros2_plugin, ros2_system
from tests.dialects.ros_control.cars import Car, heading

from cartwheel.codes import devices, robot, running

RADIUS, REACH, OFFSET = 0.05, 0.2, math.pi / 3
"""m: of the wheels, and their distance from the centre; rad: direction of the first wheel."""
PLACES = [OFFSET + 2 * math.pi * number / 3 for number in range(3)]


def omni(plugin, *, rollers, inwards=()):
    """A robot on three spheres, whose joints' axes point outwards."""
    parts = """<link name="base_link"><inertial><mass value="6"/><inertia ixx="0.05" iyy="0.05"
      izz="0.08" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    for number, place in enumerate(PLACES):
        x, y = math.cos(place), math.sin(place)
        turn = place + (math.pi if number in inwards else 0.0)
        parts += f"""<link name="wheel{number}"><inertial><mass value="0.4"/><inertia ixx="4e-4"
          iyy="4e-4" izz="4e-4" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>
          <sphere radius="{RADIUS}"/></geometry></collision></link>
          <joint name="wheel{number}_joint" type="continuous"><parent link="base_link"/>
          <child link="wheel{number}"/><origin xyz="{REACH * x} {REACH * y} 0" rpy="0 0 {turn}"/>
          <axis xyz="1 0 0"/></joint>"""
        if rollers:
            parts += f"""<gazebo reference="wheel{number}" xmlns:gz="http://gazebosim.org/schema">
              <collision><surface><friction><ode><mu>1.0</mu><mu2>0.0</mu2>
              <fdir1 gz:expressed_in="base_link">{-y} {x} 0</fdir1></ode></friction></surface>
              </collision></gazebo>"""
    system = ros2_system(*(ros2_joint(f"wheel{number}_joint", "velocity") for number in range(3)))
    return f'<robot name="car">{parts}{system}<gazebo>{plugin}</gazebo></robot>'


class Omni(Car):
    def __init__(self, make, folder, *, rollers=True, inwards=(), **settings):
        given = {
            "type": "omni_wheel_drive_controller/OmniWheelDriveController",
            "wheel_names": [f"wheel{number}_joint" for number in range(3)],
            "wheel_offset": OFFSET,
            "robot_radius": REACH,
            "wheel_radius": RADIUS,
            **settings,
        }
        file = folder / "drive.yaml"
        file.write_text(yaml.safe_dump(ros2_parameters(base=given)))
        path = folder / "omni.urdf"
        path.write_text(omni(ros2_plugin(file), rollers=rollers, inwards=inwards))
        self.topic = "cmd_vel"
        self.world = make.world()
        self.model = self.world.spawn(path, z=RADIUS)
        self.world.run(0.2)


@pytest.fixture(params=[False, True], ids=["pushed", "on rollers"])
def drive(make, tmp_path, request):
    """With wheels like any others a servo pushes it; rollers take it along by friction."""
    return lambda **settings: Omni(make, tmp_path, rollers=request.param, **settings)


@pytest.mark.parametrize(
    "motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 1.0), (0.2, -0.1, 0.4)]
)
def test_it_moves_as_commanded(drive, motion):
    """The distance and the rotation of two seconds, less the time to start, on an arc."""
    made = drive()
    made.go(0.5, *motion)
    x, y, yaw = made.place
    made.go(2.0, *motion)
    ended = made.place
    turned = math.remainder(ended[2] - yaw, 2 * math.pi)
    assert turned == pytest.approx(2.0 * motion[2], abs=0.02)
    half = motion[2]
    chord = 2.0 * (math.sin(half) / half if half else 1.0)
    way = (
        complex(motion[0], motion[1]) * chord * complex(math.cos(yaw + half), math.sin(yaw + half))
    )
    found = complex(ended[0] - x, ended[1] - y)
    assert abs(found - way) < max(0.05 * abs(way), 0.01)


def test_its_odometry_is_published_at_each_update(drive):
    made = drive()
    box = made.world.mailbox("/base/odom", size=1000)
    frames = made.world.graph.mailbox("/tf", size=1000)
    x, y, yaw = made.place
    made.go(2.0, 0.2, -0.1, 0.4)
    reported = box.drain()
    assert len(reported) == pytest.approx(200, abs=2)
    assert len(frames.drain()) == pytest.approx(200, abs=2)
    pose, twist = reported[-1].pose.pose, reported[-1].twist.twist
    ended = made.place
    assert heading(reported[-1]) == pytest.approx(ended[2] - yaw, rel=0.05)
    assert math.hypot(pose.position.x, pose.position.y) == pytest.approx(
        math.hypot(ended[0] - x, ended[1] - y), rel=0.05
    )
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx(
        (0.2, -0.1, 0.4), abs=0.02
    )
    assert (reported[-1].header.frame_id, reported[-1].child_frame_id) == ("odom", "base_link")


def test_it_stops_without_commands(drive):
    made = drive(cmd_vel_timeout=0.3)
    made.send(x=0.2)
    made.world.run(1.0)
    before = made.place
    made.world.run(0.5)
    assert math.dist(before[:2], made.place[:2]) < 0.005


def test_covariances_are_those_stated(make, tmp_path):
    made = Omni(make, tmp_path, **{"diagonal_covariance.pose": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]})
    found = made.odometry("/base/odom").pose.covariance
    assert [found[7 * row] for row in range(6)] == [1, 2, 3, 4, 5, 6]
    assert not coded(made.world, devices.CONTROLLER_PARAMETER_UNKNOWN)


def test_two_wheels_are_too_few(make, tmp_path):
    made = Omni(make, tmp_path, wheel_names=["wheel0_joint", "wheel1_joint"])
    (reported,) = coded(made.world, running.CONTROLLER_NOT_STARTED)
    assert reported.values["parameter"] == "wheel_names"


@pytest.mark.parametrize("name", ["robot_radius", "wheel_radius"])
def test_a_size_that_is_not_positive_is_reported(make, tmp_path, name):
    made = Omni(make, tmp_path, **{name: 0.0})
    (reported,) = coded(made.world, running.CONTROLLER_NOT_STARTED)
    assert reported.values["parameter"] == name


def test_an_axis_that_points_inwards_is_reported(make, tmp_path):
    made = Omni(make, tmp_path, inwards=(1,))
    (reported,) = coded(made.world, robot.WHEEL_AXIS_MISALIGNED)
    assert reported.values["joint"] == "wheel1_joint"
