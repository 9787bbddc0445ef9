"""The few lines that stand in the README, and what around them may go wrong."""

import math

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices
from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.codes.world import UNKNOWN_JOINT
from cartwheel.errors import CartwheelError, UnknownNameError


def test_the_example():
    world = cw.World("empty")
    cart = world.spawn("rosbots.xacro", z=0.1)
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(seconds=5)
    assert cart.pose.x > 2.2
    # 0.5 m/s for 5 s, less what the ramp of 1 m/s² takes: v²/2a.
    assert cart.pose.x == pytest.approx(0.5 * 5 - 0.5**2 / 2, abs=0.02)
    assert world.time == 5.0
    world.close()


def test_a_world_closes_as_a_context(make):
    with cw.World("empty") as world:
        world.run(0.1)
    assert world.session.simulation.run_state.value == "stopped"


def test_a_description_is_a_world_or_a_robot_as_well(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, name="second", x=1, y=-2, z=0.05, yaw=0.3)
    assert cart.name == "second"
    assert cart.pose.position == pytest.approx((1, -2, 0.05))
    assert cart.pose.yaw == pytest.approx(0.3)
    assert world.models == ("ground_plane", "second")
    assert world.model("second").pose == cart.pose


def test_a_models_pose_is_set(make):
    world = make.world(make.box("box", (0.2, 0.2, 0.2), static=False))
    box = world.model("box")
    box.pose = cw.Pose.from_xyz_rpy((1, 2, 3), (0, 0, math.pi / 2))
    assert box.pose.position == (1, 2, 3)
    assert box.pose.yaw == pytest.approx(math.pi / 2)


def test_a_static_models_pose_is_set(make):
    world = make.world(make.box("wall", (1, 1, 1), static=True))
    world.run(0.5)
    world.model("wall").pose = cw.Pose((4, 5, 6))
    assert world.model("wall").pose.position == (4, 5, 6)
    assert world.time == 0.5


@pytest.mark.parametrize(
    "message",
    [
        {"linear": {"x": 0.25}, "angular": {"z": -0.5}},
        None,
    ],
)
def test_publishing(make, rosbots, message):
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    got = []
    world.subscribe("/part2_cmr/cmd_vel", got.append)
    if message is None:
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.25, angular_z=-0.5)
    else:
        cart.publish("/part2_cmr/cmd_vel", message)
    cart.publish("/part2_cmr/cmd_vel")
    world.run(0.1)
    assert [(m.linear.x, m.angular.z) for m in got] == [(0.25, -0.5), (0.0, 0.0)]


def test_flat_fields_whose_own_names_hold_underscores(make):
    world = make.world()
    got = []
    world.subscribe("/odom", got.append, type="nav_msgs/Odometry")
    world.publish(
        "/odom",
        header_frame_id="map",
        child_frame_id="base",
        header_stamp_sec=3,
        pose_pose_position_x=1.5,
        twist_twist_angular_z=-2.0,
    )
    world.run(0.1)
    (message,) = got
    assert (message.header.frame_id, message.child_frame_id) == ("map", "base")
    assert message.header.stamp.sec == 3
    assert message.pose.pose.position.x == 1.5
    assert message.twist.twist.angular.z == -2.0


def test_a_field_that_is_none_is_named(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.05)
    with raises(FIELD_UNKNOWN, field="liner_x", meant="linear"):
        world.publish("/part2_cmr/cmd_vel", liner_x=0.5)
    with raises(FIELD_UNKNOWN, field="linear.w"):
        world.publish("/part2_cmr/cmd_vel", linear_w=0.5)


def test_a_topic_that_is_none_names_the_likely_one(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.05)
    with pytest.raises(UnknownNameError) as caught:
        world.publish("/part2_cmr/cmd_vl", linear_x=0.5)
    assert caught.value.values["meant"] == "/part2_cmr/cmd_vel"


def test_mailbox_and_reset(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    odometry = world.mailbox("/odom")
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(1.0)
    assert len(odometry.drain()) == 101
    world.reset()
    assert world.time == 0
    assert cart.pose.position == pytest.approx((0, 0, 0.05))


def test_a_joint_that_is_none_is_named(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    assert cart.joint("wheel_left_joint") == pytest.approx(0.0)
    with raises(UNKNOWN_JOINT, UnknownNameError, name="caster_joint"):
        cart.joint("caster_joint")


def test_delete(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    cart.delete()
    assert world.models == ("ground_plane",)
    with pytest.raises(UnknownNameError):
        world.model("rosbots")


def test_strict_makes_a_warning_an_error(make, rosbots):
    wrong = make.with_parameters(rosbots, "imu_plugin", gausianNoise="0.1")
    world = make.world()
    world.spawn(wrong, z=0.05)
    assert coded(world, devices.PLUGIN_PARAMETER_UNKNOWN, parameter="gausianNoise")
    strict = cw.World(world.session.simulation.world, strict=True)
    with pytest.raises(CartwheelError) as caught:
        strict.spawn(wrong, z=0.05)
    assert caught.value.code is devices.PLUGIN_PARAMETER_UNKNOWN
    assert "rosbots" not in strict.models
    strict.close()


def test_a_single_path_or_text_is_not_a_sequence_of_characters(tmp_path):
    with cw.World(allow_path=str(tmp_path)) as world:
        assert world.session.allow_path == (tmp_path,)
        with world.record(tmp_path / "run.mcap", topics="/clock") as recorder:
            world.run(0.5)
    assert recorder.summary.messages > 0
    missing = str(tmp_path / "missing.py")
    with raises(devices.PLUGIN_FILE_INVALID, path=missing):
        cw.World(plugins=missing)
