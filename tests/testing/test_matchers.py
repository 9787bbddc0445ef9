"""Functions that check behaviour: what they return, and the values of a failure."""

from __future__ import annotations

import math
import pickle
import pydoc

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
import cartwheel.testing
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH
from cartwheel.codes.world import UNKNOWN_MODEL, VALUE_INVALID
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.msgs.sensor_msgs import Image, LaserScan, PointCloud2, PointField
from cartwheel.testing import (
    UnmetError,
    holds,
    joint_reaches,
    keeps_clear,
    moves,
    publishes,
    reaches,
    sees,
    stays_within,
    touches,
    touches_nothing,
)

DRIVE = "/part2_cmr/cmd_vel"


@pytest.fixture
def cart():
    with cw.World("post") as world:
        yield world.spawn("rosbots.xacro", name="cart")


def test_reaches_returns_the_time(cart):
    cart.publish(DRIVE, linear_x=0.5)
    time = reaches(cart, (1.0, 0.0), within=0.1)
    # The cart accelerates at 1 m/s² to 0.5 m/s, so it is at 0.9 m after 0.9 / 0.5 + 0.25 s. The
    # position is compared every 0.02 s.
    assert time == pytest.approx(2.05, abs=0.08)


def test_reaches_states_the_closest_approach(cart):
    cart.publish(DRIVE, linear_x=0.5)
    with pytest.raises(UnmetError) as raised:
        reaches(cart, (0.5, 0.3), within=0.1, timeout=3)
    values = raised.value.values
    assert values["closest"] == pytest.approx(0.3, abs=0.01)
    # At 0.5 m after 0.5 / 0.5 + 0.25 s.
    assert values["closest_time"] == pytest.approx(1.25, abs=0.1)
    assert raised.value.time == pytest.approx(3.0)
    assert isinstance(raised.value, AssertionError)


def test_links_reach_move_and_stay(cart):
    """The left wheel is beside the frame of the cart, which drives straight."""
    wheel = cart.link("wheel_left_link")
    x, y, z = wheel.pose.position
    assert y > 0.1
    stays_within(wheel, y=(y - 0.01, y + 0.01), z=(z - 0.02, z + 0.02), seconds=0.1)
    cart.publish(DRIVE, linear_x=0.5)
    moves(wheel, distance=0.1)
    assert reaches(wheel, (x + 0.5, y), within=0.02) == pytest.approx(0.1 + 1.25, abs=0.06)
    with pytest.raises(UnmetError) as raised:
        reaches(wheel, (x, y), within=0.02, timeout=0.1)
    assert raised.value.expected.startswith("cart::wheel_left_link reaches")
    assert raised.value.values["y"] == pytest.approx(y, abs=0.01)


def test_a_robot_keeps_clear_of_a_post(cart):
    """The front of the cart is 0.6 m before its frame, and the post begins at 2.3 m."""
    base = cart.link("base_link")
    cart.publish(DRIVE, linear_x=0.5)
    keeps_clear(cart, "post", distance=0.8, seconds=1.3)
    keeps_clear(cart, "p*t", distance=0.8, seconds=0.1)
    keeps_clear(cart, "post::*", distance=0.8, seconds=0.1)
    # A pattern does not mean the model itself, and need not match anything later on.
    keeps_clear(cart, "c*", distance=0.8, seconds=0.02)
    keeps_clear(cart, distance=0.8, ignore=["ground*"], seconds=0.02)
    keeps_clear(base, distance=0.5, seconds=0.1)
    with pytest.raises(UnmetError) as raised:
        keeps_clear(base, cart._world.model("post"), distance=0.5, seconds=5)
    values = raised.value.values
    assert values["closest"] == pytest.approx(0.5, abs=0.02) and values["other"] == "post"
    assert values["closest_time"] == raised.value.time
    # x = 1.2 m: after 1.2 / 0.5 + 0.25 s.
    assert raised.value.time == pytest.approx(2.65, abs=0.05)
    for wrong in ("posd", "posd*"):
        with raises(UNKNOWN_MODEL, UnknownNameError, name=wrong):
            keeps_clear(cart, wrong)
    with raises(VALUE_INVALID):
        keeps_clear(cart._world)


def test_a_function_stays_true(cart):
    world = cart._world
    cart.publish(DRIVE, linear_x=0.5)
    holds(world, lambda: cart.pose.x < 1.0, seconds=1.0)
    assert world.time == pytest.approx(1.0)
    with pytest.raises(UnmetError) as raised:
        holds(world, lambda w: w.model("cart").pose.x < 1.0, seconds=5.0)
    # x = 1 m: after 1.0 / 0.5 + 0.25 s.
    assert raised.value.time == pytest.approx(2.25, abs=0.02)
    (x,) = raised.value.values.values()
    assert float(x) == pytest.approx(1.0, abs=0.01)
    with pytest.raises(UnmetError) as raised:
        holds(world, bool_of_nothing, seconds=1.0, period=0.1)
    assert raised.value.values == {}
    for wrong in ({"condition": 3}, {"seconds": -1.0}, {"period": 0.0}):
        with pytest.raises(cw.CartwheelError):
            holds(world, **{"condition": lambda: True, **wrong})
    world.on(world.time + 0.1, lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        holds(world, lambda: True, seconds=1.0)


def bool_of_nothing():
    return None


def test_reaches_compares_the_yaw(cart):
    cart.publish(DRIVE, angular_z=1.0)
    reaches(cart, (None, None), yaw=math.pi, yaw_within=0.05)
    with pytest.raises(UnmetError) as raised:
        reaches(cart, cw.Pose.from_xyz_rpy((1, 0, 0), (0, 0, 1)), timeout=0.1)
    assert raised.value.values["yaw_error"] == pytest.approx(math.pi - 1.1, abs=0.15)


def test_stays_within_states_the_coordinate(cart):
    stays_within(cart, x=(-0.1, 0.1), y=(-0.1, 0.1), z=(-0.1, 0.1), tilt=0.05, seconds=1)
    cart.publish(DRIVE, linear_x=0.5)
    with pytest.raises(UnmetError) as raised:
        stays_within(cart, x=(-0.1, 0.1), tilt=0.3)
    assert raised.value.values["coordinate"] == "x"
    assert raised.value.values["value"] == pytest.approx(0.1, abs=0.02)


def test_stays_within_compares_speed_and_tilt(cart):
    cart.publish(DRIVE, linear_x=0.5)
    with pytest.raises(UnmetError) as raised:
        stays_within(cart, speed=0.3)
    assert raised.value.values["coordinate"] == "speed"
    cart.pose = cw.Pose.from_xyz_rpy((0, 0, 1), (1.0, 0, 0))
    with pytest.raises(UnmetError) as raised:
        stays_within(cart, tilt=0.5)
    assert raised.value.values["value"] == pytest.approx(1.0, abs=0.1)


def test_moves_states_the_distance(cart):
    with pytest.raises(UnmetError) as raised:
        moves(cart, timeout=0.5)
    assert raised.value.values["moved"] < 0.01
    cart.publish(DRIVE, linear_x=0.5)
    assert moves(cart) < 2


def test_publishes_measures_the_rate(cart):
    assert publishes(cart, "/imu/data", rate=30) == pytest.approx(30, abs=1)
    publishes(cart._world, "/odom")
    with pytest.raises(UnmetError) as raised:
        publishes(cart, "/imu/data", rate=50)
    assert raised.value.values["rate"] == pytest.approx(30, abs=1)
    with pytest.raises(UnmetError) as raised:
        publishes(cart, DRIVE, seconds=0.1)
    assert raised.value.values["count"] == 0


def test_a_message_at_the_beginning_does_not_count_in_the_rate():
    with cw.World() as world:
        world.spawn("rosbots.xacro")
        assert publishes(world, "/imu/data", rate=30, seconds=1) == pytest.approx(30, abs=0.1)


def test_a_topic_with_a_fault_is_named(cart):
    with cart.fault("/odom", drop=1.0), pytest.raises(UnmetError) as raised:
        publishes(cart, "/odom", seconds=0.2)
    assert "World.faults" in str(raised.value)
    with pytest.raises(UnmetError) as raised:
        publishes(cart, DRIVE, seconds=0.1)
    assert "World.faults" not in str(raised.value)


def test_an_unknown_topic_is_an_error(cart):
    with pytest.raises(cw.CartwheelError) as raised:
        publishes(cart, "/odmo")
    assert raised.value.values["meant"] == "/odom"


def test_touches(cart):
    touches_nothing(cart, seconds=0.2)
    with pytest.raises(UnmetError):
        touches(cart, timeout=0.2)
    cart.publish(DRIVE, linear_x=1.0)
    touches(cart, "post", timeout=15)
    with pytest.raises(UnmetError) as raised:
        touches_nothing(cart, cart._world.model("post"))
    assert str(raised.value.values["other"]).startswith("post::")
    with pytest.raises(cw.CartwheelError):
        touches(cart, "wall*")


def test_joint_reaches(cart):
    cart.publish(DRIVE, linear_x=0.5)
    joint_reaches(cart, "wheel_left_joint", 1.0, within=0.1)
    with pytest.raises(UnmetError) as raised:
        joint_reaches(cart, "wheel_left_joint", -5.0, timeout=0.2)
    assert raised.value.values["position"] > 0.9


def test_sees_a_colour_and_a_distance():
    with cw.World("walls") as world:
        cart = world.spawn("rosbots.xacro")
        # The camera faces a yellow box and orange cones.
        sees(cart, "/rosbots/camera1/image_raw", color=(1.0, 0.4, 0.0), share=0.0005)
        sees(cart, "/rosbots/camera1/image_raw")
        with pytest.raises(UnmetError) as raised:
            sees(cart, "/rosbots/camera1/image_raw", color=(1.0, 0.0, 1.0), timeout=0.2)
        assert raised.value.values["share"] == 0
        with pytest.raises(cw.CartwheelError):
            sees(cart, "/odom")


def test_sees_a_range(make):
    laser = make.sdf(
        '<model name="laser"><static>true</static><pose>0 0 0.5 0 0 0</pose><link name="link">'
        '<sensor name="scan" type="ray"><update_rate>20</update_rate><ray><scan><horizontal>'
        "<samples>11</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></horizontal>"
        "</scan><range><min>0.1</min><max>10</max></range></ray>"
        '<plugin name="p" filename="libgazebo_ros_laser.so"><topicName>/scan</topicName>'
        "<frameName>link</frameName></plugin></sensor></link></model>"
    )
    box = make.box("box", (0.2, 2, 2), static=True, pose=cw.Pose((2.1, 0, 0.5)))
    world = make.world(laser, box)
    sees(world, "/scan", range=2.0, within=0.01)
    with pytest.raises(UnmetError) as raised:
        sees(world, "/scan", range=3.0, timeout=0.2)
    assert raised.value.values["range"] == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("turn", [0.0, math.tau, -math.tau])
def test_sees_a_range_at_an_angle(make, turn):
    """The ray at 0.2 rad measures 2 m / cos(0.2), although the one at -0.2 rad is shorter."""
    laser = make.sdf(
        '<model name="laser"><static>true</static><pose>0 0 0.5 0 0 0</pose><link name="link">'
        '<sensor name="scan" type="ray"><update_rate>20</update_rate><ray><scan><horizontal>'
        "<samples>5</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></horizontal>"
        "</scan><range><min>0.1</min><max>2.5</max></range></ray>"
        '<plugin name="p" filename="libgazebo_ros_laser.so"><topicName>/scan</topicName>'
        "<frameName>link</frameName></plugin></sensor></link></model>"
    )
    wall = make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((2.1, 0, 0.5)))
    post = make.box("post", (0.2, 0.1, 2), static=True, pose=cw.Pose((1.1, -0.2, 0.5)))
    world = make.world(laser, wall, post)
    sees(world, "/scan", range=2.0 / math.cos(0.2), within=0.001, angle=0.2 + turn)
    sees(world, "/scan", range=1.0 / math.cos(0.2), within=0.001, angle=-0.2 + turn)
    sees(world, "/scan", angle=turn)
    with pytest.raises(UnmetError) as raised:
        sees(world, "/scan", range=1.0, angle=turn, timeout=0.2)
    assert raised.value.values["range"] == pytest.approx(2.0, abs=1e-3)
    world.model("wall").pose = cw.Pose((9.0, 0.0, 0.5))
    with pytest.raises(UnmetError):
        sees(world, "/scan", angle=0.2 + turn, timeout=0.2)
    with raises(OPTION_INVALID, name="angle"):
        sees(world, "/scan", angle=0.3 + turn)


def test_sees_the_range_of_a_cloud():
    """The nearest point is at a distance of 5 m; those without a measurement are NaN or at 0."""
    points = np.array([[3, 0, 4], [0, 0, 0], [np.nan, 0, 0], [-9, 0, 0]], np.float32)
    fields = [
        PointField(name=axis, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, axis in enumerate("xyz")
    ]
    message = PointCloud2(
        height=1, width=4, fields=fields, point_step=12, row_step=48,
        data=points.view(np.uint8).ravel(),
    )  # fmt: skip
    with cw.World("empty") as world:
        publisher = world.advertise("/points", PointCloud2)
        world.every(20.0, lambda: publisher.publish(message))
        sees(world, "/points", range=5.0, within=0.001)
        with pytest.raises(UnmetError) as raised:
            sees(world, "/points", range=4.0, timeout=0.2)
        assert raised.value.values["range"] == 5.0
        with raises(TOPIC_TYPE_MISMATCH, name="color"):
            sees(world, "/points", color=(1.0, 0.0, 0.0))
        with raises(TOPIC_TYPE_MISMATCH, name="angle"):
            sees(world, "/points", angle=0.0)


RED = """<robot name="red"><link name="red"><inertial><mass value="5"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="0.4 0.4 1"/></geometry></visual>
  <collision><geometry><box size="0.4 0.4 1"/></geometry></collision></link>
  <gazebo reference="red"><material>Gazebo/Red</material></gazebo></robot>"""


def test_sees_a_colour_that_is_shaded():
    topic = "/rosbots/camera1/image_raw"
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        with pytest.raises(UnmetError):
            sees(cart, topic, color=(1.0, 0.0, 0.0), timeout=0.2)
        world.spawn(RED, x=2.0, z=0.5)
        sees(cart, topic, color=(1.0, 0.0, 0.0))
        for other in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.6, 0.0)):
            with pytest.raises(UnmetError) as raised:
                sees(cart, topic, color=other, timeout=0.2)
            assert "the most similar colour was" in raised.value.actual
        with raises(VALUE_INVALID, name="color"):
            sees(cart, topic, color=(255, 0, 0))


@pytest.mark.wording
def test_a_position_of_almost_zero_has_no_sign(cart):
    cart.pose = cw.Pose((-1e-5, -1e-5, 0.0))
    with pytest.raises(UnmetError) as raised:
        reaches(cart, (5.0, 0.0), timeout=0.1)
    assert "x = 0.000, y = 0.000" in raised.value.actual


@pytest.mark.wording
def test_a_distance_in_millimetres_is_written_out(cart):
    with pytest.raises(UnmetError) as raised:
        reaches(cart, (3000, 0), timeout=0.1)
    assert "the closest approach was 3000 m" in raised.value.actual


CAMERA = "/rosbots/camera1/image_raw"


@pytest.mark.parametrize(
    ("topic", "asked", "name"),
    [
        ("/scan", {"color": (1, 0, 0)}, "color"),
        ("/scan", {"model": "nobody"}, "model"),
        ("/scan", {"range": 2.0, "model": "nobody"}, "model"),
        (CAMERA, {"model": "nobody"}, "model"),
        (CAMERA, {"range": 2.0}, "range"),
        (CAMERA, {"range": 2.0, "color": (1, 0, 0)}, "range"),
        ("/rosbots/camera1/depth", {"color": (1, 0, 0)}, "color"),
    ],
)
def test_what_a_sensor_cannot_see_is_refused(topic, asked, name):
    with cw.World("post") as world:
        world.spawn("rosbots.xacro")
        scan = {"range_max": 10.0, "ranges": [2.0]}
        world.topic("/scan", LaserScan).hold(scan, rate=20)
        # 2.0 as a float32.
        depth = {"encoding": "32FC1", "width": 1, "height": 1, "step": 4, "data": [0, 0, 0, 64]}
        world.topic("/rosbots/camera1/depth", Image).hold(depth, rate=20)
        sees(world, "/scan", range=2.0)
        sees(world, "/rosbots/camera1/depth", range=2.0)
        with raises(TOPIC_TYPE_MISMATCH, GraphError, topic=topic, name=name):
            sees(world, topic, **asked)


def test_an_image_without_colours_and_depths_is_refused():
    with cw.World("empty") as world:
        grey = {"encoding": "mono8", "width": 1, "height": 1, "step": 1, "data": [3]}
        world.topic("/grey", Image).hold(grey, rate=20)
        with raises(TOPIC_TYPE_MISMATCH, GraphError, topic="/grey", encoding="mono8"):
            sees(world, "/grey")


@pytest.mark.parametrize(
    ("check", "name"),
    [
        (stays_within, "limits"),
        (lambda cart: stays_within(cart, x=(1, -1)), "x"),
        (lambda cart: stays_within(cart, y=1.0), "y"),
        (lambda cart: reaches(cart, (None, None)), "target"),
        (lambda cart: reaches(cart, 1.0), "target"),
        (lambda cart: reaches(cart, (1.0,)), "target"),
        (lambda cart: reaches(cart, (1.0, "far")), "target"),
        (lambda cart: reaches(cart, (1.0, math.nan)), "target"),
        (lambda cart: sees(cart, CAMERA, share=0.5), "share"),
        (lambda cart: sees(cart, CAMERA, within=0.5), "within"),
    ],
)
def test_a_condition_that_says_nothing_is_refused(cart, check, name):
    with raises(OPTION_INVALID, name=name):
        check(cart)
    assert cart._world.time == 0.0


NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("check", "name"),
    [
        (lambda cart: reaches(cart, (1, 0), within="a"), "within"),
        (lambda cart: reaches(cart, (1, 0), within=-1), "within"),
        (lambda cart: reaches(cart, (1, 0), yaw=NAN), "yaw"),
        (lambda cart: reaches(cart, (1, 0), timeout=INF), "timeout"),
        (lambda cart: reaches(cart, (1, 0), timeout=-1), "timeout"),
        (lambda cart: stays_within(cart, tilt=NAN), "tilt"),
        (lambda cart: stays_within(cart, speed="a"), "speed"),
        (lambda cart: stays_within(cart, x=(0, 1), seconds=-1), "seconds"),
        (lambda cart: stays_within(cart, x=(0, 1), seconds="a"), "seconds"),
        (lambda cart: moves(cart, distance=-1), "distance"),
        (lambda cart: publishes(cart, "/odom", rate=0), "rate"),
        (lambda cart: publishes(cart, "/odom", rate=10, tolerance=NAN), "tolerance"),
        (lambda cart: sees(cart, CAMERA, range="2"), "range"),
        (lambda cart: sees(cart, CAMERA, range=2, within=NAN), "within"),
        (lambda cart: sees(cart, CAMERA, color=1), "color"),
        (lambda cart: sees(cart, CAMERA, color=(1, 0, 0), share=2), "share"),
        (lambda cart: keeps_clear(cart, "ground_plane", distance=NAN), "distance"),
        (lambda cart: joint_reaches(cart, "wheel_left_joint", NAN), "position"),
        (lambda cart: joint_reaches(cart, "wheel_left_joint", 0, within="a"), "within"),
        (lambda cart: touches(cart, timeout=NAN), "timeout"),
        (lambda cart: touches_nothing(cart, seconds=INF), "seconds"),
    ],
)
def test_a_number_that_cannot_be_is_refused(cart, check, name):
    with raises(VALUE_INVALID, name=name):
        check(cart)
    assert cart._world.time == 0.0


@pytest.mark.parametrize(("x", "code"), [((0, NAN), OPTION_INVALID), ((-INF, 1), None)])
def test_limits_may_be_open_but_not_unknown(cart, x, code):
    if code is None:
        stays_within(cart, x=x, seconds=0.1)
    else:
        with raises(code, name="x"):
            stays_within(cart, x=x)


@pytest.mark.parametrize(
    "check",
    [
        lambda model: reaches(model, (1, 0)),
        lambda model: stays_within(model, x=(0, 1)),
        moves,
        touches,
        touches_nothing,
        lambda model: joint_reaches(model, "elbow", 1.0),
        lambda model: publishes(model, "/odom"),
        lambda model: sees(model, "/scan"),
    ],
)
@pytest.mark.parametrize("model", ["cart", None])
def test_what_is_not_a_model_is_refused(check, model):
    with raises(VALUE_INVALID):
        check(model)


def test_the_error_reaches_another_process(cart):
    with pytest.raises(UnmetError) as raised:
        moves(cart, timeout=0.1)
    error = raised.value
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is UnmetError and copy.args == error.args
    assert vars(copy) == vars(error) and copy.values["moved"] == error.values["moved"]


def test_help_and_completion_list_the_functions():
    assert {"reaches", "sees", "stays_within"} <= set(dir(cartwheel.testing))
    assert "\n    reaches(" in pydoc.render_doc(cartwheel.testing, renderer=pydoc.plaintext)


def test_stays_within_compares_the_yaw(cart):
    cart.pose = cw.Pose.from_xyz_rpy((0, 0, cart.pose.z), (0, 0, -3.1))
    stays_within(cart, yaw=(3.1, 3.3), seconds=0.2)
    cart.publish(DRIVE, angular_z=1.0)
    with pytest.raises(UnmetError, match=r"stays within 3.1 ≤ yaw ≤ 3.3 rad") as failed:
        stays_within(cart, yaw=(3.1, 3.3))
    assert failed.value.values["coordinate"] == "yaw"
    assert failed.value.values["value"] == pytest.approx(3.3, abs=0.03)


def test_links_touch(cart):
    world = cart._world
    link = next(each for each in cart.links if "wheel" in each)
    other = cw.Model(world, "post")
    cart.pose = cw.Pose((0.0, 0.0, 0.05))
    touches(cart.link(link), "ground_plane", timeout=1)
    touches_nothing(cart.link(link), seconds=0.1)
    touches_nothing(cart.link(link), other, seconds=0.1)
    with pytest.raises(UnmetError, match=f"cart::{link} touches another model"):
        touches(cart.link(link), timeout=0.1)
    with pytest.raises(UnmetError) as failed:
        touches_nothing(cart, world.model("ground_plane").link("link"), seconds=0.1)
    assert failed.value.values["other"] == "ground_plane::link"
    cart.publish(DRIVE, linear_x=0.5)
    time = touches(cart, "post", timeout=15)
    touched = {each.links[0] for each in world.contacts(between=(cart, "post"))}
    assert time == world.time and touched
    (first, *_) = touched
    touches(cart.link(first), other)
    touches(cart, f"post::{other.links[0]}")
    touches(other.link(other.links[0]), f"cart::{first[:3]}*")
    for wrong in ("post::nothing", "cart::no*"):
        with pytest.raises(UnknownNameError) as unknown:
            touches(cart, wrong)
        assert unknown.value.values["kind"] == "link"


def test_errors_name_the_parameter(cart):
    for name, refused in (
        ("robot", lambda: touches_nothing(cart._world, "post")),
        ("other", lambda: touches(cart, 3)),
        ("robot", lambda: joint_reaches(cart.link(cart.links[0]), "wheel_left_joint", 1.0)),
        ("world", lambda: sees("cart", "/scan")),
    ):
        with raises(VALUE_INVALID, name=name):
            refused()


def test_topics_of_a_model_are_in_its_namespace():
    with cw.World("post") as world:
        world.spawn("rosbots.xacro", name="b", namespace="b", y=3)
        robot = world.spawn("rosbots.xacro", name="a", namespace="a")
        assert publishes(robot, "odom", rate=100, seconds=0.5) == pytest.approx(100, rel=0.1)
        sees(robot, "camera1/image_raw")
        assert publishes(robot, "/b/odom") > 0
        with pytest.raises(UnknownNameError) as failed:
            publishes(robot, "odm")
        assert failed.value.values["name"] == "/a/odm"
        assert failed.value.values["meant"] == "/a/odom"
