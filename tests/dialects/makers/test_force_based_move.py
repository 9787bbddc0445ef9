"""A base that is pushed to its velocity: against Newton and dry friction."""

import math

import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, quat_from_rpy

MASS, SIZE = 20.0, 0.4
TURNED = MASS * 2 * SIZE**2 / 12
G = 9.8


def base(make, tags=""):
    return make.sdf(f"""<model name="base"><link name="link"><inertial><mass>{MASS}</mass>
      <inertia><ixx>{TURNED}</ixx><iyy>{TURNED}</iyy><izz>{TURNED}</izz></inertia></inertial>
      <collision name="c"><geometry><box><size>{SIZE} {SIZE} 0.2</size></box></geometry>
      <surface><friction><ode><mu>0.2</mu><mu2>0.2</mu2></ode></friction></surface></collision>
      </link><plugin name="p" filename="libridgeback_ros_force_based_move.so">
      {tags}<cmdVelTimeOut>5</cmdVelTimeOut><odometryRate>50</odometryRate></plugin></model>""")


def spawn(make, tags="", *, ground=None, gravity=0.0, pose=Pose()):  # noqa: B008 - immutable
    world = make.world(ground=ground, gravity=gravity, step=0.001)
    world.session.spawn(base(make, tags), pose=pose)
    return world


def test_it_nears_its_velocity_with_the_time_constant_of_mass_and_gain(make, read):
    """Free of friction: v = u (1 - exp(-k t / m)), and k / m is 5 /s here."""
    world = spawn(make, "<x_velocity_p_gain>100</x_velocity_p_gain>"
                        "<y_velocity_p_gain>100</y_velocity_p_gain>")  # fmt: skip
    world.publish("/cmd_vel", linear_x=0.6, linear_y=-0.3)
    reported = read(world, "/odom", 0.4)
    assert reported
    for message in reported:
        time = message.header.stamp.nanosec * 1e-9
        share = 1 - math.exp(-100 / MASS * time)
        assert message.twist.twist.linear.x == pytest.approx(0.6 * share, abs=4e-3)
        assert message.twist.twist.linear.y == pytest.approx(-0.3 * share, abs=4e-3)


def test_it_turns_by_its_own_gain(make, read):
    gain = 2.0
    world = spawn(make, f"<yaw_velocity_p_gain>{gain}</yaw_velocity_p_gain>")
    world.publish("/cmd_vel", angular_z=0.5)
    message = read(world, "/odom", 0.2)[-1]
    time = message.header.stamp.nanosec * 1e-9
    wanted = 0.5 * (1 - math.exp(-gain / TURNED * time))
    assert message.twist.twist.angular.z == pytest.approx(wanted, rel=0.01)
    assert message.pose.covariance[35] == 100.0


def test_friction_costs_it_what_the_gain_says(make, read):
    """Steadily, k (u - v) = mu m g."""
    gain = 400.0
    world = spawn(make, f"<x_velocity_p_gain>{gain}</x_velocity_p_gain>"
                        f"<y_velocity_p_gain>{gain}</y_velocity_p_gain>",
                  ground=1.0, gravity=G, pose=Pose((0, 0, 0.1)))  # fmt: skip
    world.publish("/cmd_vel", linear_x=0.6)
    reported = read(world, "/odom", 2.0)[-1].twist.twist.linear.x
    assert reported == pytest.approx(0.6 - 0.2 * MASS * G / gain, rel=0.03)


def test_its_odometry_begins_where_it_does_and_counts_sideways(make, read):
    start = Pose((3, -2, 1), quat_from_rpy(0, 0, math.pi / 2))
    world = spawn(make, pose=start)
    world.publish("/cmd_vel", linear_x=0.2, linear_y=0.1)
    message = read(world, "/odom", 2.0)[-1]
    seconds = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    where = message.pose.pose.position
    assert (where.x, where.y) == pytest.approx((0.2 * seconds, 0.1 * seconds), rel=0.01)
    pose = world.model("base").pose
    assert (pose.x, pose.y) == pytest.approx((3 - 0.2, -2 + 0.4), abs=0.01)
    assert message.pose.covariance[35] == 0.01


def test_without_a_command_it_stands(make, read):
    world = spawn(make, "<cmdVelTimeOut>0.25</cmdVelTimeOut>")
    world.publish("/cmd_vel", linear_x=0.5)
    assert read(world, "/odom", 0.24)[-1].twist.twist.linear.x == pytest.approx(0.5, rel=0.01)
    assert read(world, "/odom", 0.2)[-1].twist.twist.linear.x == pytest.approx(0.0, abs=1e-3)


def test_gains_that_differ_are_reported_and_none_is_refused(make):
    world = spawn(make, "<y_velocity_p_gain>5</y_velocity_p_gain>")
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED, parameter="y_velocity_p_gain")
    with pytest.raises(PluginError) as caught:
        spawn(make, "<x_velocity_p_gain>-1</x_velocity_p_gain>")
    assert caught.value.values["parameter"] == "x_velocity_p_gain"
