"""gz-sim's differential drive: circles, limits and names."""

import math
import re

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.drives.carts import (
    cart_sdf,
    circle,
    path,
    spawn,
    where,
)

from cartwheel.codes import devices, robot
from cartwheel.codes.world import PHYSICS_SETTING_IGNORED
from cartwheel.errors import PluginError

TWO = {"left": (0.0, 0.15), "right": (0.0, -0.15)}


GLIDERS = ((0.15, 0.0), (-0.15, 0.0))


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
    reported = read(world, "/model/cart/odometry", 2 * math.pi / turn)
    assert circle(path(reported)) == pytest.approx(forward / turn, rel=0.02)
    assert reported[0].header.frame_id == "cart/odom"
    assert reported[0].child_frame_id == "cart/base_link"
    assert len(reported) == pytest.approx(50 * 2 * math.pi / turn, abs=1)
    start, end = path(reported)[0], path(reported)[-1]
    assert np.linalg.norm(end - start) < 0.05
    # The odometry is the wheels' turning; the robot itself lags by what its tyres creep.
    place = world.model("cart").pose
    assert math.hypot(place.x - end[0], place.y - end[1]) < 0.05
    twist = reported[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((forward, turn), rel=0.01)


def test_gz_topics_and_frames_can_be_named(make, cart):
    tags = """<topic>cmd_vel</topic><odom_topic>odom</odom_topic><tf_topic>tf</tf_topic>
      <frame_id>odom</frame_id><child_frame_id>base_link</child_frame_id>
      <odom_publish_frequency>20</odom_publish_frequency>"""
    world = spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    boxes = {topic: world.graph.mailbox(topic, size=1000) for topic in ("/odom", "/tf")}
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
    reported = read(world, "/model/cart/odometry", 2.0)
    speeds = np.array([message.twist.twist.linear.x for message in reported])
    times = np.array([m.header.stamp.sec + m.header.stamp.nanosec * 1e-9 for m in reported]) - 0.5
    on_the_way = (times > 0.1) & (times < 0.55)
    assert speeds[on_the_way] == pytest.approx(0.5 * times[on_the_way], abs=0.02)
    assert speeds[times > 0.7] == pytest.approx(0.3, abs=0.01)
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED)


def test_a_limit_that_contradicts_itself_is_refused(make, cart):
    tags = "<min_velocity>1</min_velocity><max_velocity>-1</max_velocity>"
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    assert caught.value.code is devices.PLUGIN_RANGE_REVERSED


@pytest.mark.parametrize(
    ("left", "right", "reversed_", "swapped"),
    [
        ((0.0, 0.15), (0.0, -0.15), False, False),
        ((0.0, -0.15), (0.0, 0.15), False, True),
        # It faces backwards, and turns as commanded.
        ((0.0, -0.15), (0.0, 0.15), True, False),
    ],
)
def test_the_sides_of_the_wheels_depend_on_their_axes(make, left, right, reversed_, swapped):
    text = cart_sdf({"left": left, "right": right}, gz_diff(), balls=GLIDERS)
    if reversed_:
        assert text.count("<xyz>0 0 1</xyz>") >= 2
        text = text.replace("<xyz>0 0 1</xyz>", "<xyz>0 0 -1</xyz>")
    assert bool(coded(spawn(make, make.sdf(text)), robot.WHEELS_SWAPPED)) == swapped


@pytest.mark.parametrize("swapped", [False, True])
def test_the_axes_define_the_sides_of_a_robot_that_faces_along_y(make, swapped):
    side = -0.15 if swapped else 0.15
    text = cart_sdf({"left": (0.0, side), "right": (0.0, -side)}, gz_diff(), balls=GLIDERS)
    quarter = math.pi / 2
    turned = re.sub(
        rf"<pose>(\S+) (\S+) (\S+) {-quarter} 0 0</pose>",
        lambda at: f"<pose>{-float(at[2])} {at[1]} {at[3]} {-quarter} 0 {quarter}</pose>",
        text,
    )
    assert turned != text
    assert bool(coded(spawn(make, make.sdf(turned)), robot.WHEELS_SWAPPED)) == swapped


def test_a_wheel_on_the_wrong_side_is_reported(make, cart, read):
    """As in Gazebo's own pioneer3dx: it turns right if a left turn is commanded."""
    swapped = {"left": (0.0, -0.15), "right": (0.0, 0.15)}
    world = spawn(make, cart(swapped, gz_diff(), balls=GLIDERS))
    assert coded(world, robot.WHEELS_SWAPPED)
    world.publish("/model/cart/cmd_vel", angular_z=0.5)
    world.run(1.0)
    assert world.model("cart").pose.yaw < -0.3


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
    reported = box.drain()[-1]
    assert where(reported)[:2] == pytest.approx((0, 0), abs=1e-3)
    assert reported.twist.twist.linear.x == pytest.approx(0, abs=1e-3)


def test_the_velocity_limits_of_the_wheels_apply(make):
    """gz-sim's physics clips the commanded velocity of a joint: 2 rad/s on a radius of 0.1 m."""
    limited = cart_sdf(TWO, gz_diff(), balls=GLIDERS).replace(
        "<axis><xyz>", "<axis><limit><velocity>2</velocity></limit><xyz>"
    )
    world = spawn(make, make.sdf(limited))
    for forward, speed in ((0.5, 0.2), (-0.5, -0.2), (0.15, 0.15)):
        world.publish("/model/cart/cmd_vel", linear_x=forward)
        world.run(1.0)
        before = world.model("cart").pose.x
        world.run(1.0)
        assert world.model("cart").pose.x - before == pytest.approx(speed, rel=0.01)
    assert not coded(world, PHYSICS_SETTING_IGNORED)
