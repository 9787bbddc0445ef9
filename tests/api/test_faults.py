"""Faults of sensors and of communication, at run time."""

import dataclasses
import pickle

import numpy as np
import pytest
from tests.api.scenes import LASER
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.api.exchange import faults as fault_module
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import DELAYED_LOST, FIELD_UNKNOWN, FIELD_VALUE_INVALID, TOPIC_UNKNOWN
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, SIMULATION_CLOSED, VALUE_INVALID
from cartwheel.errors import CartwheelError, GraphError, SimulationError, UnknownNameError
from cartwheel.msgs.geometry_msgs import Twist


@pytest.fixture
def world(make):
    return make.world()


@pytest.fixture
def cart(world, rosbots):
    return world.spawn(rosbots, name="cart", z=0.05)


def test_a_sensor_is_switched_off_and_on(world, cart):
    odometry = cart.topic("/odom")
    world.run(0.5)
    with cart.fault("/odom", drop=1.0) as fault:
        assert fault.active and fault.topics == ("/odom",)
        assert world.faults == (fault,)
        before = odometry.count
        world.run(0.5)
        assert odometry.count == before > 0
    assert not fault.active and world.faults == ()
    world.run(0.5)
    assert odometry.count == pytest.approx(2 * before, abs=2)
    fault.end()


def test_a_share_of_the_messages_is_lost(world, cart):
    odometry = cart.topic("/odom", keep=5000)
    fault = world.fault("/odom", drop=0.25)
    world.run(20.0)
    # 2000 messages: the standard deviation of the share is 0.0097.
    assert odometry.count / 2000 == pytest.approx(0.75, abs=0.04)
    fault.drop = 0.0
    before = odometry.count
    world.run(1.0)
    assert odometry.count - before == 100


@pytest.mark.parametrize("delay", [0.035, 0.5])
def test_messages_are_late(world, cart, delay):
    odometry = cart.topic("/odom", keep=1000)
    fault = world.fault("/odom", delay=delay)
    assert fault.delay == pytest.approx(delay)
    world.run(2.0)
    stamps = odometry.values("header.stamp")
    assert np.array(odometry.times()) - stamps == pytest.approx(delay)
    assert len(stamps) == pytest.approx((2.0 - delay) * 100, abs=2)
    fault.end()
    world.run(delay + 0.1)
    # The late ones have come as well.
    assert sorted(odometry.values("header.stamp")) == pytest.approx(
        np.arange(len(odometry.history())) / 100 + min(stamps)
    )


def test_a_topic_that_is_named_twice_has_the_fault_once(world):
    publisher = world.advertise("/level", "std_msgs/msg/Float64")
    level = world.topic("/level")
    fault = world.fault(["/level", "level", "/level"], bias={"data": 2.0})
    assert fault.topics == ("/level",)
    publisher.publish(data=1.0)
    world.run(0.1)
    assert level.latest.data == 3.0


def test_a_late_message_does_not_wait_for_the_next_task(make):
    """The laser measures at 10 Hz, and nothing else happens between two scans."""
    world = make.world(make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((5, 0, 1))))
    world.spawn(make.sdf(LASER))
    scans = world.topic("/scan")
    world.fault("/scan", delay=0.015)
    world.run(1.0)
    late = np.array(scans.times()) - scans.values("header.stamp")
    assert len(late) > 3 and late == pytest.approx(0.015)


def test_a_frozen_sensor_repeats_itself_with_new_stamps(make):
    wall = make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((5, 0, 1)))
    world = make.world(wall)
    world.spawn(make.sdf(LASER))
    scans = world.topic("/scan")
    with world.fault("/scan", frozen=True) as fault:
        world.run(0.5)
        first = scans.latest
        world.model("wall").pose = cw.Pose((3, 0, 1))
        world.run(0.5)
        assert np.array_equal(scans.latest.ranges, first.ranges)
        assert scans.values("header.stamp", 1)[0] > 0.8
        fault.frozen = False
        world.run(0.5)
        assert scans.latest.ranges[1] == pytest.approx(2.9)


def test_noise_and_bias_are_added_to_fields(world, cart):
    imu = cart.topic("/imu/data", keep=5000)
    world.run(5.0)
    still = imu.values("angular_velocity.z").std(), imu.values("linear_acceleration.x").mean()
    count = imu.count
    fault = cart.fault(
        "/imu/data",
        noise={"angular_velocity.z": 0.5},
        bias={"linear_acceleration.x": 2.0, "orientation_covariance": 1.0},
    )
    world.run(5.0)
    assert imu.values("angular_velocity.z", count).std() == pytest.approx(0.5, rel=0.15)
    assert imu.values("linear_acceleration.x", count).mean() == pytest.approx(
        still[1] + 2.0, abs=0.05
    )
    assert imu.latest.orientation_covariance[1] == 1.0
    fault.noise, fault.bias = {}, {}
    world.run(1.0)
    assert imu.values("angular_velocity.z", 20).std() < 2 * still[0] + 0.01
    assert imu.latest.orientation_covariance[1] == 0.0


def test_arrays_and_integers_are_changed_within_their_range(make):
    world = make.world(make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((5, 0, 1))))
    world.spawn(make.sdf(LASER))
    scans = world.topic("/scan")
    world.run(0.5)
    ranges = scans.latest.ranges
    world.fault("/scan", bias={"ranges": 0.25})
    world.run(0.5)
    assert scans.latest.ranges == pytest.approx(ranges + 0.25)
    assert scans.latest.ranges.dtype == ranges.dtype
    world.advertise("/levels", "std_msgs/msg/UInt8MultiArray")
    levels = world.topic("/levels")
    world.fault("/levels", bias={"data": 100.4})
    world.publish("/levels", data=[0, 50, 200])
    world.run(0.1)
    assert list(levels.latest.data) == [100, 150, 255]


def test_a_function_changes_messages(world, cart):
    odometry = cart.topic("/odom")

    def every_second(message):
        return message if message.header.stamp.nanosec % 20_000_000 == 0 else None

    with world.fault("/odom", change=every_second):
        world.run(1.0)
    assert odometry.count == pytest.approx(50, abs=1)


@pytest.mark.parametrize(
    ("wrong", "reported"),
    [(lambda m: 5, "int"), (lambda m: Twist(), "Twist"),
     (lambda m: dataclasses.replace(m, child_frame_id=3), "child_frame_id")],
)  # fmt: skip
def test_the_function_returns_messages_of_the_topic(world, cart, wrong, reported):
    odometry = cart.topic("/odom")
    with world.fault("/odom", change=wrong), raises(FIELD_VALUE_INVALID) as caught:
        world.run(0.1)
    assert "/odom" in str(caught.value) and reported in str(caught.value)
    assert odometry.count == 0


def test_the_function_may_change_its_argument_and_values_are_converted(world, cart):
    def change(message):
        message.child_frame_id = "changed"
        message.pose.covariance = [1.0] * 36
        return message

    odometry = cart.topic("/odom")
    with world.fault("/odom", change=change):
        world.run(0.1)
    assert odometry.latest.child_frame_id == "changed"
    assert odometry.latest.pose.covariance.tolist() == [1.0] * 36


def test_an_error_of_the_function_stops_the_run(world, cart):
    cart.topic("/odom")
    world.fault("/odom", change=lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        world.run(0.1)


def test_late_messages_are_bounded(world, cart, monkeypatch):
    monkeypatch.setattr(fault_module, "_MOST_LATE", 20)
    odometry = cart.topic("/odom")
    fault = world.fault("/odom", delay=1.0)
    world.run(0.5)
    state = world.save()
    world.run(1.0)
    # 20 are late, and those after them are lost until the first ones are delivered.
    first = odometry.values("header.stamp")
    assert len(first) == 20
    (found,) = coded(world, DELAYED_LOST, topic="/odom", delay=1.0, messages=20)
    assert found.severity == "warning"
    world.run(1.0)
    assert np.array(odometry.times()) - odometry.values("header.stamp") == pytest.approx(1.0)
    seen = odometry.values("header.stamp")
    assert 20 < len(seen) <= 40 and seen[20] > first[-1] + 0.5
    # Those of a saved state are late again, and count.
    world.restore(state)
    world.run(2.0)
    assert odometry.values("header.stamp")[:20] == pytest.approx(first)
    assert len(coded(world, DELAYED_LOST)) == 1
    fault.delay = 0.1
    world.run(1.0)
    count = odometry.count
    world.run(1.0)
    assert odometry.count == count + 100


def test_the_size_of_late_messages_is_bounded(world, cart, monkeypatch):
    monkeypatch.setattr(fault_module, "_MOST_BYTES", 3 * 320 * 240 * 3)
    images = cart.topic("/cart/camera1/image_raw")
    world.fault(images.name, delay=0.5)
    world.run(0.9)
    assert images.count == 3 and coded(world, DELAYED_LOST, messages=3)


def test_commands_are_lost_and_late(world, cart):
    with cart.fault("/part2_cmr/cmd_vel", drop=1.0):
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
        world.run(0.5)
    assert abs(cart.velocity.linear[0]) < 0.01
    with cart.fault("/part2_cmr/cmd_vel", delay=0.3):
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
        world.run(0.29)
        assert abs(cart.velocity.linear[0]) < 0.01
        world.run(0.7)
    assert cart.velocity.linear[0] == pytest.approx(0.5, abs=0.02)


def test_several_faults_of_a_topic_apply_in_turn(world, cart):
    odometry = cart.topic("/odom")
    one = world.fault("/odom", bias={"pose.pose.position.x": 1.0})
    two = world.fault(["/odom", "/clock"], change=lambda message: message, delay=0.1)
    world.fault("/odom", bias={"pose.pose.position.x": 2.0})
    world.run(0.5)
    assert odometry.latest.pose.pose.position.x == pytest.approx(3.0, abs=0.01)
    one.end()
    two.end()
    world.run(0.5)
    assert odometry.latest.pose.pose.position.x == pytest.approx(2.0, abs=0.01)


def test_faults_are_the_same_in_each_run_and_after_a_restore(make, rosbots):
    def faulty(seed):
        world = make.world(seed=seed)
        cart = world.spawn(rosbots, z=0.05)
        imu = cart.topic("/imu/data", keep=1000)
        world.fault("/imu/data", drop=0.3, delay=0.02, noise={"angular_velocity.z": 0.1})
        return world, imu

    runs = []
    for seed in (1, 1, 2):
        world, imu = faulty(seed)
        world.run(0.5)
        state = world.save()
        assert "fault of /imu/data" in state.left_out
        pickle.dumps(state)
        ends = []
        for _ in range(2):
            world.run(0.5)
            ends.append((imu.times(), imu.values("angular_velocity.z").tolist()))
            world.restore(state)
        assert ends[0] == ends[1]
        world.reset()
        world.run(1.0)
        assert (imu.times(), imu.values("angular_velocity.z").tolist()) == ends[0]
        runs.append(ends[0])
    assert runs[0] == runs[1] != runs[2]


def test_a_world_without_faults_has_the_same_bits(make, rosbots):
    """Nor does a fault of one sensor change others."""
    seen = []
    for faults in (False, True):
        world = make.world()
        cart = world.spawn(rosbots, z=0.05)
        imu, odometry = cart.topic("/imu/data", keep=1000), cart.topic("/odom", keep=1000)
        if faults:
            world.fault("/odom", drop=0.5, noise={"pose.pose.position.x": 0.1})
        world.run(1.0)
        seen.append(imu.values("angular_velocity.z").tolist())
        assert (odometry.count < 80) is faults
    assert seen[0] == seen[1]


def test_faults_that_are_refused(world, cart):
    with raises(TOPIC_UNKNOWN, UnknownNameError, name="/odmo"):
        world.fault("/odmo", drop=1.0)
    for share in (-0.1, 1.1, "0.5", None):
        with raises(VALUE_INVALID, name="drop"):
            world.fault("/odom", drop=share)
    with raises(VALUE_INVALID, name="delay"):
        world.fault("/odom", delay=-1.0)
    with raises(NUMBER_OUT_OF_RANGE):
        world.fault("/odom", delay=1e300)
    with raises(OPTION_INVALID, name="frozen"):
        world.fault("/odom", frozen=1)
    with raises(OPTION_INVALID, name="noise"):
        world.fault("/odom", noise=0.1)
    with raises(OPTION_INVALID, name="change"):
        world.fault("/odom", change="no")
    for field in ("pose.pose.position.w", "child_frame_id", "pose"):
        with raises(FIELD_UNKNOWN, GraphError):
            world.fault("/odom", noise={field: 0.1})
    fault = world.fault("/odom")
    with pytest.raises(AttributeError):
        fault.dorp = 0.5
    with raises(VALUE_INVALID, CartwheelError):
        fault.noise = {"pose.pose.position.x": -1.0}
    world.close()
    fault.end()
    with raises(SIMULATION_CLOSED, SimulationError):
        world.fault("/odom")
