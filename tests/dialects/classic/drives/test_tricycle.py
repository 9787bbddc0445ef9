"""Tricycles: the circle that they drive, and their tags in ROS 1 and ROS 2."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.drives.carts import (
    circle,
    path,
    spawn,
    turned,
    where,
)

from cartwheel.codes import devices
from cartwheel.devices.drives.drive import Drives
from cartwheel.messages import to_dict

THREE = {"front": (0.3, 0.0), "left": (0.0, 0.15), "right": (0.0, -0.15)}


def tricycle(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">
      <steeringJoint>front_steering</steeringJoint><actuatedWheelJoint>front_joint</actuatedWheelJoint>
      <encoderWheelLeftJoint>left_joint</encoderWheelLeftJoint>
      <encoderWheelRightJoint>right_joint</encoderWheelRightJoint>
      <actuatedWheelDiameter>0.2</actuatedWheelDiameter>
      <encoderWheelDiameter>0.2</encoderWheelDiameter>
      <encoderWheelSeparation>0.3</encoderWheelSeparation><wheelTorque>20</wheelTorque>
      {tags}</plugin>"""


@pytest.mark.parametrize("source", ["world", "encoder"])
def test_tricycle_circles_about_its_rear_axle(make, cart, read, source):
    """The front wheel at L steers by a: the rear axle's middle goes round at L / tan a.

    The front wheel, which has the commanded speed v, is at L / sin a.
    """
    speed, angle, base = 0.4, 0.5, 0.3
    tags = f"<odometrySource>{source}</odometrySource>"
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    world.publish("/cmd_vel", linear_x=speed, angular_z=angle)
    world.run(1.5)
    reported = read(world, "/odom", 10.0)
    assert circle(path(reported)) == pytest.approx(base / math.tan(angle), rel=0.03)
    assert turned(reported) / 9.99 == pytest.approx(speed * math.sin(angle) / base, rel=0.03)
    (drive,) = world.session.shared.get(Drives).all
    expected = (speed * math.cos(angle), speed * math.sin(angle) / base)
    assert drive.commanded(speed, angle) == pytest.approx(expected)
    truth = world.model("cart").pose
    if source == "world":
        assert where(reported[-1])[:2] == pytest.approx((truth.x, truth.y), abs=0.01)


def test_tricycle_ramps_its_wheel_and_swings_its_fork(make, cart):
    """0 to 4 rad/s at 2 rad/s² takes 2 s; 0.6 rad at 0.5 rad/s takes 1.2 s."""
    tags = """<wheelAcceleration>2</wheelAcceleration><steeringSpeed>0.5</steeringSpeed>
      <publishWheelJointState>true</publishWheelJointState>"""
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    box = world.mailbox("/joint_states", size=1000)
    world.publish("/cmd_vel", linear_x=0.4, angular_z=0.6)
    world.run(3.0)
    states = box.drain()
    assert states[0].name == ["front_steering", "front_joint", "left_joint", "right_joint"]
    times = np.arange(len(states)) / 100
    angles = np.array([state.position[0] for state in states])
    speeds = np.array([state.velocity[1] for state in states])
    assert angles == pytest.approx(np.minimum(0.5 * times, 0.6), abs=0.03)
    assert speeds == pytest.approx(np.minimum(2 * times, 4), abs=0.2)
    assert len(states[0].effort) == 4


ROS2_TRICYCLE = """<steering_joint>front_steering</steering_joint>
  <actuated_wheel_joint>front_joint</actuated_wheel_joint>
  <encoder_wheel_left_joint>left_joint</encoder_wheel_left_joint>
  <encoder_wheel_right_joint>right_joint</encoder_wheel_right_joint>"""


def ros2_tricycle(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">{ROS2_TRICYCLE}
      {tags}</plugin>"""


def test_every_tag_of_ros2s_tricycle_says_what_ros1s_does(make, cart):
    """The same command gives the same messages, bit for bit."""
    ros1 = tricycle("""<wheelAcceleration>2</wheelAcceleration>
      <wheelDeceleration>3</wheelDeceleration>
      <wheelSpeedTolerance>0.02</wheelSpeedTolerance><steeringSpeed>0.5</steeringSpeed>
      <steeringAngleTolerance>0.02</steeringAngleTolerance><odometrySource>encoder</odometrySource>
      <odometryFrame>map</odometryFrame><robotBaseFrame>left_wheel</robotBaseFrame>
      <updateRate>50</updateRate><publishWheelTF>true</publishWheelTF>
      <publishWheelJointState>true</publishWheelJointState>""")
    ros2 = ros2_tricycle("""<ros/><actuated_wheel_diameter>0.2</actuated_wheel_diameter>
      <encoder_wheel_diameter>0.2</encoder_wheel_diameter><wheel_separation>0.3</wheel_separation>
      <max_wheel_torque>20</max_wheel_torque><max_wheel_acceleration>2</max_wheel_acceleration>
      <max_wheel_deceleration>3</max_wheel_deceleration>
      <max_wheel_speed_tolerance>0.02</max_wheel_speed_tolerance>
      <max_steering_speed>0.5</max_steering_speed>
      <max_steering_angle_tolerance>0.02</max_steering_angle_tolerance>
      <odometry_source>0</odometry_source><odometry_frame>map</odometry_frame>
      <robot_base_frame>left_wheel</robot_base_frame><update_rate>50</update_rate>
      <publish_odom>true</publish_odom><publish_wheel_tf>true</publish_wheel_tf>
      <publish_wheel_joint_state>true</publish_wheel_joint_state>""")
    reported = []
    for plugin in (ros1, ros2):
        world = spawn(make, cart(THREE, plugin, forks=("front",)))
        boxes = [world.mailbox(topic, size=1000) for topic in ("/odom", "/tf", "/joint_states")]
        world.publish("/cmd_vel", linear_x=0.4, angular_z=0.6)
        world.run(1.0)
        reported.append([[to_dict(message) for message in box.drain()] for box in boxes])
        assert not coded(world, devices.PLUGIN_PARAMETER_UNKNOWN)
    assert all(reported[0])
    assert reported[0] == reported[1]


def test_ros2s_tricycle_publishes_nothing_unless_that_is_set(make, cart):
    world = spawn(make, cart(THREE, ros2_tricycle(), forks=("front",)))
    topics = {topic.name for topic in world.graph.topics()}
    assert "/cmd_vel" in topics
    assert not topics & {"/odom", "/tf", "/joint_states"}


@pytest.mark.parametrize(
    ("plugin", "torque"),
    [
        (ros2_tricycle("<publish_wheel_joint_state>1</publish_wheel_joint_state>"), 0.15),
        (
            tricycle("<publishWheelJointState>1</publishWheelJointState>").replace(
                "<wheelTorque>20</wheelTorque>", ""
            ),
            5.0,
        ),
    ],
    ids=["ROS 2", "ROS 1"],
)
def test_a_tricycle_that_states_no_torque_has_its_gazebos(make, cart, plugin, torque):
    """Towards a speed that it cannot reach in that time the motor gives all it has."""
    world = spawn(make, cart(THREE, plugin, forks=("front",)))
    box = world.mailbox("/joint_states")
    world.publish("/cmd_vel", linear_x=100.0)
    world.run(0.05)
    state = box.drain()[-1]
    assert state.effort[state.name.index("front_joint")] == pytest.approx(torque, rel=1e-3)


def test_a_fork_that_is_seldom_steered_stands_still(make, cart):
    """At 10 Hz a fork that went on at full speed would be far past its angle at the next call."""
    tags = "<updateRate>10</updateRate>"
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    world.publish("/cmd_vel", linear_x=0.0, angular_z=0.5)
    world.run(5.0)
    simulation = world.session.simulation
    for _ in range(20):
        world.run(0.05)
        assert simulation.joint_position("cart", "front_steering") == pytest.approx(0.5, abs=0.01)
