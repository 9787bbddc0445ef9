"""Transforms between frames of a world: what a node would look up."""

import pytest
from tests.coded import raises
from tests.devices.drives.carts import cart_sdf

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import FRAME_UNKNOWN, TRANSFORM_TIME
from cartwheel.codes.world import SIMULATION_CLOSED, UNKNOWN_MODEL, VALUE_INVALID
from cartwheel.errors import GraphError, SimulationError, UnknownNameError


@pytest.fixture
def world(make):
    return make.world()


@pytest.fixture
def cart(world, rosbots):
    return world.spawn(rosbots, name="cart", z=0.05)


def close(one: cw.Pose, two: cw.Pose, tolerance: float = 1e-9) -> bool:
    between = one.inverse() @ two
    return max(map(abs, (*between.position, *between.rpy))) < tolerance


def test_links_are_known_at_once_and_as_exact_as_their_poses(world, cart):
    cart.joints.positions["wheel_left_joint"] = 0.7
    for link in cart.links:
        found = world.transform("base_link", cart.link(link))
        assert close(found, cart.link("base_link").pose.inverse() @ cart.link(link).pose), link
    assert set(cart.links) <= set(world.frames)


def test_the_past_of_a_drive_is_interpolated(world, cart):
    world.keep_transforms()
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.4)
    poses = {}
    for _ in range(40):
        world.run(0.05)
        poses[round(world.time, 2)] = cart.pose
    for time, pose in poses.items():
        assert close(world.transform("odom", "base_footprint", time), pose), time
    between = world.transform("odom", "base_footprint", 1.0123)
    assert poses[1.0].x < between.x < poses[1.05].x
    assert world.transform("odom", cart.link("base_link")) == world.transform("odom", "base_link")
    with raises(TRANSFORM_TIME, GraphError, time=3.0, newest=2.0):
        world.transform("odom", "base_link", 3.0)


def test_frames_of_a_robot_have_its_prefix(world, rosbots):
    left = world.spawn(rosbots, name="left", namespace="left", frame_prefix="left", z=0.05)
    other = left.transform("base_link", left.link("camera"))
    assert other == world.transform("left/base_link", "left/camera")
    assert other == left.transform("/left/base_link", "camera")
    with raises(FRAME_UNKNOWN, UnknownNameError, name="base_link"):
        world.transform("base_link", "left/camera")


def test_programs_add_transforms(world, cart):
    world.keep_transforms()
    map_to_odom = {
        "header": {"frame_id": "map"},
        "child_frame_id": "odom",
        "transform": {"translation": {"x": 3.0}},
    }
    world.publish("/tf_static", transforms=[map_to_odom])
    world.run(0.5)
    assert close(world.transform("map", "odom"), cw.Pose((3.0, 0.0, 0.0)))
    assert abs(world.transform("map", "base_footprint").x - 3.0 - cart.pose.x) < 1e-9


def test_time_that_goes_back_takes_the_transforms_with_it(world, cart):
    world.keep_transforms()
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(1.0)
    state, then = world.save(), world.transform("odom", "base_link")
    world.run(1.0)
    assert world.transform("odom", "base_link") != then
    world.restore(state)
    assert world.transform("odom", "base_link") == then
    with raises(TRANSFORM_TIME, GraphError, newest=1.0):
        world.transform("odom", "base_link", 1.5)
    assert world.transform("odom", "base_link", 0.5).x < then.x
    world.reset()
    assert "odom" not in world.frames
    assert close(
        world.transform("base_link", "wheel_left_link"),
        cart.link("base_link").pose.inverse() @ cart.link("wheel_left_link").pose,
    )


def test_reading_transforms_changes_nothing(make, rosbots):
    ends = []
    for reads in (False, True):
        world = make.world()
        cart = world.spawn(rosbots, z=0.05)
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
        for _ in range(10):
            world.run(0.1)
            if reads:
                world.transform("base_link", "camera")
        ends.append((cart.pose, cart.velocity))
    assert ends[0] == ends[1]


def test_nothing_is_published_for_worlds_that_do_not_ask(world, cart):
    world.run(0.1)
    assert not {"/tf", "/tf_static"} & {
        topic.name for topic in world.graph.topics() if topic.subscribers
    }


def test_what_cannot_be_looked_up_is_refused(world, cart):
    with raises(OPTION_INVALID, name="target"):
        world.transform(3, "base_link")
    with raises(VALUE_INVALID, name="seconds"):
        world.keep_transforms(0.0)
    gone = cart.link("base_link")
    cart.delete()
    with raises(UNKNOWN_MODEL, UnknownNameError, name="cart"):
        world.transform(gone, "camera")
    world.close()
    with raises(SIMULATION_CLOSED, SimulationError):
        world.transform("base_link", "camera")


GZ = """<plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
<wheel_separation>0.4</wheel_separation><wheel_radius>0.1</wheel_radius>{tags}</plugin>"""


@pytest.mark.parametrize("prefix", ["", "own"])
@pytest.mark.parametrize("late", [False, True])
def test_the_odometry_of_gz_sim_is_on_a_topic_of_its_own(world, prefix, late):
    """Its frames have the name of the model, or its prefix, also on a robot spawned later."""
    if late:
        world.keep_transforms()
    sdf = cart_sdf({"left": (0, 0.2), "right": (0, -0.2)}, GZ.format(tags=""))
    cart = world.spawn(f'<sdf version="1.9">{sdf}</sdf>', frame_prefix=prefix)
    world.keep_transforms()
    cart.publish("/model/cart/cmd_vel", linear_x=0.2, angular_z=0.3)
    odometry = world.topic("/model/cart/odometry")
    world.run(1.0)
    stamp, at = odometry.latest.header.stamp, odometry.latest.pose.pose
    first = prefix or "cart"
    own = f"{prefix}/" if prefix else ""
    base = world.transform(f"{first}/odom", f"{own}base_link", time=stamp)
    assert (base.x, base.y, base.orientation[2]) == (at.position.x, at.position.y, at.orientation.z)
    assert world.transform(f"/{first}/odom", f"{first}/base_link", time=stamp) == base
    between = cart.link("base_link").pose.inverse() @ cart.link("left_wheel").pose
    wheel = world.transform(f"{first}/odom", cart.link("left_wheel"), time=stamp)
    assert close(wheel, base @ between, 0.02)
    assert world.transform(f"{first}/left_wheel", f"{own}left_wheel") == cw.Pose()
    assert f"{first}/base_link" in world.frames or not prefix
    world.reset()
    with raises(FRAME_UNKNOWN, UnknownNameError, name=f"{first}/odom"):
        world.transform(f"{first}/odom", f"{own}base_link")


def test_a_drive_of_gz_sim_can_publish_on_tf(world):
    tags = "<tf_topic>/tf</tf_topic><frame_id>odom</frame_id>"
    tags += "<child_frame_id>base_link</child_frame_id>"
    sdf = cart_sdf({"left": (0, 0.2), "right": (0, -0.2)}, GZ.format(tags=tags))
    world.spawn(f'<sdf version="1.9">{sdf}</sdf>')
    world.keep_transforms()
    world.run(1.0)
    wheel = world.transform("base_link", "left_wheel")
    assert close(world.transform("odom", "left_wheel"), wheel, 1e-3)


POSES = """<plugin name="p" filename="gz-sim-pose-publisher-system">
<use_pose_vector_msg>true</use_pose_vector_msg></plugin>"""


def test_a_frame_that_is_only_on_another_topic_names_it(world):
    """A similar frame that is known is more likely meant."""
    sdf = cart_sdf({"left": (0, 0.2), "right": (0, -0.2)}, POSES)
    world.spawn(f'<sdf version="1.9">{sdf}</sdf>')
    world.keep_transforms()
    world.run(0.1)
    with raises(FRAME_UNKNOWN, UnknownNameError, elsewhere=("/model/cart/pose",)):
        world.transform("somewhere", "left_wheel")
    with raises(FRAME_UNKNOWN, UnknownNameError, meant="base_link") as caught:
        world.transform("base_lnk", "left_wheel")
    assert "elsewhere" not in caught.value.values
