"""Ramps of a tricycle's wheel and steering."""

import math

import pytest

from cartwheel.devices.drives.drive import Drives
from cartwheel.devices.drives.tricycle import next_angle, next_speed


@pytest.mark.parametrize(
    ("speed", "target", "expected"),
    [(0.0, 4.0, 0.2), (3.9, 4.0, 4.0), (4.0, 1.0, 3.7), (-4.0, 1.0, -3.7), (-1.0, -4.0, -1.2)],
)
def test_a_wheel_gains_and_loses_speed_at_its_own_rates(speed, target, expected):
    """At 2 rad/s² and 3 rad/s², in 0.1 s."""
    limits = {"acceleration": 2.0, "deceleration": 3.0, "seconds": 0.1}
    assert next_speed(speed, target, **limits) == pytest.approx(expected)


def test_without_limits_a_target_is_reached_at_once():
    assert next_speed(0.0, 4.0, acceleration=0.0, deceleration=0.0, seconds=0.1) == 4.0
    assert next_angle(0.0, 0.6, rate=0.0, seconds=0.1) == 0.6


def test_steering_takes_its_time_and_ends_at_a_right_angle():
    assert next_angle(0.2, 0.6, rate=0.5, seconds=0.1) == pytest.approx(0.25)
    assert next_angle(0.0, -9.0, rate=0.0, seconds=0.1) == -math.pi / 2


@pytest.mark.parametrize(("place", "sense"), [(0.4, 1.0), (-0.4, -1.0)])
def test_a_tricycle_steered_at_its_back_turns_to_the_other_side(make, place, sense):
    """`angular.z` is the angle of the steered wheel, wherever it is."""
    wheel = """<link name="{0}"><pose relative_to="base">{1} {2} 0 -1.5707963 0 0</pose><inertial>
      <mass>0.5</mass><inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.003</izz></inertia></inertial>
      <collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.03</length></cylinder>
      </geometry></collision></link><joint name="{0}_joint" type="revolute"><parent>{3}</parent>
      <child>{0}</child><axis><xyz>0 0 1</xyz></axis></joint>"""
    fork = f"""<link name="fork"><pose relative_to="base">{place} 0 0 0 0 0</pose><inertial>
      <mass>0.2</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial>
      </link><joint name="fork_joint" type="revolute"><parent>base</parent><child>fork</child>
      <axis><xyz>0 0 1</xyz></axis></joint>"""
    model = f"""<model name="tricycle"><link name="base"><pose>0 0 0.1 0 0 0</pose><inertial>
      <mass>5</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
      {wheel.format("left", 0, 0.15, "base")}{wheel.format("right", 0, -0.15, "base")}{fork}
      {wheel.format("driven", place, 0, "fork")}
      <plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">
      <steering_joint>fork_joint</steering_joint>
      <actuated_wheel_joint>driven_joint</actuated_wheel_joint>
      <encoder_wheel_left_joint>left_joint</encoder_wheel_left_joint>
      <encoder_wheel_right_joint>right_joint</encoder_wheel_right_joint>
      <actuated_wheel_diameter>0.2</actuated_wheel_diameter>
      <max_wheel_torque>5</max_wheel_torque></plugin></model>"""
    world = make.world(make.sdf(model))
    world.run(0.5)
    world.publish("/cmd_vel", linear_x=0.2, angular_z=0.3)
    world.run(2.0)
    before = world.model("tricycle").pose.yaw
    world.run(1.0)
    turned = world.model("tricycle").pose.yaw - before
    (info,) = [each for each in world.graph.topics() if each.drives]
    drive = world.session.shared.get(Drives).of(info.subscribers)
    _, commanded = drive.commanded(0.2, 0.3)
    assert commanded == pytest.approx(sense * 0.2 * math.sin(0.3) / 0.4)
    assert turned == pytest.approx(commanded, rel=0.03)
