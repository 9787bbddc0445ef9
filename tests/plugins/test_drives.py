"""Drives with pairs of wheels: by their geometry."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.drives.carts import (
    CAR,
    FOUR,
    FRONT,
    PLANAR,
    RADIUS,
    ackermann,
    circle,
    path,
    spawn,
    turned,
    where,
)

from cartwheel.codes import devices, robot
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose

# -- skid steer


def skid(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_skid_steer_drive.so">
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame>{tags}</plugin>"""


def test_skid_steer_goes_straight_as_told(make, cart, read):
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    told = read(world, "/odom", 4.0)
    assert len(told) == 400
    x, y, yaw = np.array(where(told[-1])) - np.array(where(told[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 3.99, rel=0.01)
    assert abs(yaw) < 0.01
    assert np.diag(told[0].pose.covariance.reshape(6, 6)) == pytest.approx(
        [1e-4, 1e-4, 1e12, 1e12, 1e12, 1e-2]
    )


def test_skid_steer_turns_by_what_sliding_leaves(make, cart, read):
    """In place, every tyre slides along and across, and its friction points against the sum.

    A wheel at (L/2, W/2) slides by (ω - ω₀) W/2 along and ω L/2 across, all by the same
    speed; the moments of their friction cancel where (ω - ω₀) W² + ω L² = 0.
    """
    length, width, wanted = 0.4, 0.3, 1.0
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", angular_z=wanted)
    world.run(2.0)
    told = read(world, "/odom", 6.0)
    rate = turned(told) / 5.99
    assert rate == pytest.approx(wanted * width**2 / (width**2 + length**2), rel=0.1)
    # The odometry is the truth, not what the wheels believe.
    yaw = world.model("cart").pose.yaw
    assert math.remainder(where(told[-1])[2] - yaw, 2 * math.pi) == pytest.approx(0, abs=0.02)
    assert told[-1].twist.twist.angular.z == pytest.approx(rate, rel=0.2)


def test_skid_steer_publishes_its_transform_only_when_asked(make, cart):
    world = spawn(make, cart(FOUR, skid()))
    assert "/tf" not in [topic.name for topic in world.graph.topics()]
    world = spawn(make, cart(FOUR, skid("<broadcastTF>true</broadcastTF>")))
    assert "/tf" in [topic.name for topic in world.graph.topics()]


def test_skid_steer_names_a_wheel_it_lacks(make, cart):
    wheels = {name: place for name, place in FOUR.items() if name != "left_rear"}
    with pytest.raises(UnknownNameError) as caught:
        spawn(make, cart(wheels, skid()))
    assert caught.value.values["name"] == "left_rear_joint"
    assert caught.value.origin is not None


# -- several pairs of ROS 2's diff drive, and new Gazebo's

TWO = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
GLIDERS = ((0.15, 0.0), (-0.15, 0.0))


def test_ros2_drives_several_pairs_each_by_its_own_size(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs>
      <left_joint>left_front_joint</left_joint><right_joint>right_front_joint</right_joint>
      <left_joint>left_rear_joint</left_joint><right_joint>right_rear_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_separation>0.6</wheel_separation>
      <wheel_diameter>0.2</wheel_diameter><wheel_diameter>0.4</wheel_diameter>
      <max_wheel_torque>50</max_wheel_torque></plugin>"""
    # In the air, where nothing holds the wheels.
    world = spawn(make, cart(FOUR, plugin), Pose((0, 0, 500)), ground=None)
    world.publish("/cmd_vel", linear_x=0.5, angular_z=1.0)
    world.run(1.0)
    model, speeds = world.session.simulation, {}
    for name in FOUR:
        before = model.joint_position("cart", f"{name}_joint")
        world.run(0.1)
        speeds[name] = (model.joint_position("cart", f"{name}_joint") - before) / 0.1
    assert speeds["left_front"] == pytest.approx((0.5 - 0.15) / 0.1, rel=0.01)
    assert speeds["right_front"] == pytest.approx((0.5 + 0.15) / 0.1, rel=0.01)
    assert speeds["left_rear"] == pytest.approx((0.5 - 0.3) / 0.2, rel=0.01)
    assert speeds["right_rear"] == pytest.approx((0.5 + 0.3) / 0.2, rel=0.01)
    # ROS 2's plugin publishes only what it is told to.
    assert not {"/odom", "/tf"} & {topic.name for topic in world.graph.topics()}


def test_pairs_must_be_complete(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs><left_joint>left_joint</left_joint></plugin>"""
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, plugin))
    assert caught.value.code is devices.WHEELS_UNPAIRED
    assert caught.value.values == {"left": 1, "right": 1}


def gz_diff(tags="", prefix="gz-sim"):
    return f"""<plugin name="drive" filename="{prefix}-diff-drive-system">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius>{tags}</plugin>"""


@pytest.mark.parametrize("prefix", ["gz-sim", "ignition-gazebo", "libignition-gazebo"])
def test_gz_diff_drive_closes_a_circle(make, cart, read, prefix):
    """v/ω is the radius, and after 2π/ω the odometry and the robot are where they began."""
    forward, turn = 0.4, 0.8
    world = spawn(make, cart(TWO, gz_diff(prefix=prefix), balls=GLIDERS))
    world.publish("/model/cart/cmd_vel", linear_x=forward, angular_z=turn)
    world.run(1.0)
    told = read(world, "/model/cart/odometry", 2 * math.pi / turn)
    assert circle(path(told)) == pytest.approx(forward / turn, rel=0.02)
    assert told[0].header.frame_id == "cart/odom"
    assert told[0].child_frame_id == "cart/base_link"
    assert len(told) == pytest.approx(50 * 2 * math.pi / turn, abs=1)
    start, end = path(told)[0], path(told)[-1]
    assert np.linalg.norm(end - start) < 0.05
    # The odometry is the wheels' turning; the robot itself lags by what its tyres creep.
    place = world.model("cart").pose
    assert math.hypot(place.x - end[0], place.y - end[1]) < 0.05
    twist = told[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((forward, turn), rel=0.01)


def test_gz_topics_and_frames_can_be_named(make, cart):
    tags = """<topic>cmd_vel</topic><odom_topic>odom</odom_topic><tf_topic>tf</tf_topic>
      <frame_id>odom</frame_id><child_frame_id>base_link</child_frame_id>
      <odom_publish_frequency>20</odom_publish_frequency>"""
    world = spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    boxes = {topic: world.mailbox(topic, size=1000) for topic in ("/odom", "/tf")}
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(2.0)
    odometry, transforms = boxes["/odom"].drain(), boxes["/tf"].drain()
    assert len(odometry) == len(transforms) == 40
    sent = transforms[-1].transforms[0]
    assert (sent.header.frame_id, sent.child_frame_id) == ("odom", "base_link")
    assert sent.transform.translation.x == odometry[-1].pose.pose.position.x > 0.3


def test_gz_limits_are_kept(make, cart, read):
    """At most 0.3 m/s, reached by 0.5 m/s²: after 0.6 s."""
    tags = """<max_linear_velocity>0.3</max_linear_velocity>
      <max_linear_acceleration>0.5</max_linear_acceleration><max_jerk>1</max_jerk>"""
    world = spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    world.publish("/model/cart/cmd_vel", linear_x=5.0)
    told = read(world, "/model/cart/odometry", 2.0)
    speeds = np.array([message.twist.twist.linear.x for message in told])
    times = np.array([m.header.stamp.sec + m.header.stamp.nanosec * 1e-9 for m in told]) - 0.5
    on_the_way = (times > 0.1) & (times < 0.55)
    assert speeds[on_the_way] == pytest.approx(0.5 * times[on_the_way], abs=0.02)
    assert speeds[times > 0.7] == pytest.approx(0.3, abs=0.01)
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED)


def test_a_limit_that_contradicts_itself_is_refused(make, cart):
    tags = "<min_velocity>1</min_velocity><max_velocity>-1</max_velocity>"
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    assert caught.value.code is devices.PLUGIN_RANGE_REVERSED


# -- hector's multi wheel


def test_multi_wheel_drives_sides_of_unlike_count(make, cart, read):
    wheels = {**FOUR, "left_middle": (0.0, 0.15)}
    plugin = """<plugin name="drive" filename="libdiffdrive_plugin_multi_wheel.so">
      <leftJoints>left_front_joint left_middle_joint left_rear_joint</leftJoints>
      <rightJoints>right_front_joint right_rear_joint</rightJoints>
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame></plugin>"""
    world = spawn(make, cart(wheels, plugin))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    told = read(world, "/odom", 2.0)
    x, y, _ = np.array(where(told[-1])) - np.array(where(told[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 1.99, rel=0.01)
    speeds = [world.session.simulation.data.joint(f"cart::{name}_joint").qvel[0] for name in wheels]
    assert speeds == pytest.approx([0.5 / RADIUS] * 5, rel=0.01)


def test_a_wheel_on_the_wrong_side_is_told(make, cart, read):
    """As in Gazebo's own pioneer3dx: it turns to the right when it is told to turn left."""
    swapped = {"left": (0.0, -0.15), "right": (0.0, 0.15)}
    world = spawn(make, cart(swapped, gz_diff(), balls=GLIDERS))
    assert coded(world, robot.WHEELS_SWAPPED)
    world.publish("/model/cart/cmd_vel", angular_z=0.5)
    world.run(1.0)
    assert world.model("cart").pose.yaw < -0.3


# -- two of a kind


@pytest.mark.parametrize(
    ("wheels", "plugin", "forks"),
    [
        (FOUR, skid("<broadcastTF>true</broadcastTF>"), ()),
        (FOUR, PLANAR.format(""), ()),
        (CAR, ackermann("<publish_odom_tf>true</publish_odom_tf>"), FRONT),
    ],
)
def test_a_namespace_and_a_prefix_keep_two_apart(make, cart, wheels, plugin, forks):
    world = make.world()
    model = cart(wheels, plugin, forks=forks)
    for name, y in (("one", 0.0), ("two", 3.0)):
        world.session.spawn(
            model, name=name, pose=Pose((0, y, 0.002)), namespace=name, frame_prefix=name
        )
    boxes = {topic: world.mailbox(topic, size=1000) for topic in ("/one/odom", "/two/odom", "/tf")}
    world.run(0.5)
    world.publish("/one/cmd_vel", linear_x=0.3)
    world.run(2.0)
    one, two = (boxes[f"/{name}/odom"].drain()[-1] for name in ("one", "two"))
    assert (one.header.frame_id, one.child_frame_id) == ("one/odom", "one/base_link")
    assert (two.header.frame_id, two.child_frame_id) == ("two/odom", "two/base_link")
    assert one.pose.pose.position.x > 0.4
    assert abs(two.pose.pose.position.x) < 0.01
    children = {t.child_frame_id for m in boxes["/tf"].drain() for t in m.transforms}
    assert children == {"one/base_link", "two/base_link"}


def test_a_reset_takes_drives_back(make, cart):
    world = spawn(make, cart(TWO, gz_diff(), balls=GLIDERS))
    box = world.mailbox("/model/cart/odometry", size=1000)
    world.publish("/model/cart/cmd_vel", linear_x=0.4)
    world.run(2.0)
    assert world.model("cart").pose.x > 0.5
    world.session.simulation.reset()
    box.drain()
    world.run(1.0)
    assert abs(world.model("cart").pose.x) < 1e-3
    told = box.drain()[-1]
    assert where(told)[:2] == pytest.approx((0, 0), abs=1e-3)
    assert told.twist.twist.linear.x == pytest.approx(0, abs=1e-3)
