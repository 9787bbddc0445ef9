"""Topics as objects: their messages, waiting, and publishing at a rate."""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    NO_MESSAGE,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, WAIT_TIMED_OUT
from cartwheel.description import load_robot
from cartwheel.errors import GraphError, UnknownNameError

CMD = "/part2_cmr/cmd_vel"


def test_names_without_a_slash_are_in_the_root_namespace() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        assert world.topic("odom") is odometry and odometry.name == "/odom"
        box = world.mailbox("odom")
        world.subscribe("odom", lambda message: None)
        world.publish(CMD[1:], linear_x=0.3)
        assert world.topic(CMD[1:]).latest is None
        world.serve("lamp/switch", "std_srvs/srv/SetBool", lambda request: {"success": True})
        assert world.call("lamp/switch", data=True).success
        world.run(1.0)
        assert len(box.drain()) == 101 and odometry.latest.twist.twist.linear.x > 0.29
        with world.fault("odom", drop=1.0) as fault:
            assert fault.topics == ("/odom",)
            world.run(0.5)
        assert odometry.count == 101
        with raises(TOPIC_UNKNOWN, meant="/odom"):
            world.topic("odm")


def test_a_topic_has_the_newest_messages() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        assert (odometry.name, odometry.type) == ("/odom", "nav_msgs/msg/Odometry")
        assert (odometry.latest, odometry.latest_time, odometry.count) == (None, None, 0)
        assert odometry.history() == []
        assert world.topic("/odom") is odometry
        world.run(0.5)
        assert odometry.count == 51
        assert odometry.latest is odometry.history()[-1]
        assert odometry.times(3) == [0.48, 0.49, 0.5]
        assert odometry.history(2) == odometry.history()[-2:]
        with raises(NUMBER_OUT_OF_RANGE):
            odometry.history(0)
        odometry.close()
        world.run(0.1)
        assert odometry.count == 51
        assert world.topic("/odom") is not odometry


def test_it_keeps_as_many_as_asked() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        clock = world.topic("/clock", keep=5)
        images = world.topic("/rosbots/camera1/image_raw")
        world.run(1.0)
        assert (clock.count, len(clock.history())) == (101, 5)
        assert (images.count, len(images.history())) == (31, 10)
        assert world.topic("/clock", keep=20) is clock
        world.run(1.0)
        assert len(clock.history()) == 20
        for bad in (0, -1, True, 1.5, "2"):
            with raises(NUMBER_OUT_OF_RANGE):
                world.topic("/clock", keep=bad)  # type: ignore[arg-type]


def test_descriptions_of_robots_need_no_connection(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro", name="first")
        assert "/robot_description" not in world.topics
        described = world.topic("/robot_description")
        assert described.latest.data == load_robot("rosbots.xacro").text
        world.spawn("rosbots.xacro", name="second", namespace="other", y=3)
        assert world.topic("/other/robot_description").latest.data == described.latest.data
        with raises(TOPIC_UNKNOWN):
            world.topic("/third/robot_description")
        box = world.mailbox("/robot_description")
        received: list[str] = []
        world.subscribe("/other/robot_description", lambda message: received.append(message.data))
        # A recording contains each of them once, and they are still published after it.
        path = tmp_path / "a.mcap"
        with world.record(path, topics="*robot_description"):
            world.run(0.3)
        with cw.Recording(path) as recording:
            assert Counter(each.topic for each in recording.messages()) == {
                "/robot_description": 1,
                "/other/robot_description": 1,
            }
        assert (described.count, len(box.drain()), len(received)) == (1, 1, 1)
        assert [each.node for each in publishers(world, "/robot_description")] == ["first"]
        cart.delete()
        world.run(0.2)
        assert not publishers(world, "/robot_description")


def publishers(world: cw.World, topic: str) -> list[Any]:
    return [each for each in world.graph.publishers() if each.topic == topic]


def test_a_field_must_be_named_by_a_text() -> None:
    with cw.World("empty") as world:
        clock = world.topic("/clock")
        world.run(0.1)
        with raises(FIELD_UNKNOWN, field="5"):
            clock.values(5)  # type: ignore[arg-type]


def test_an_unknown_field_is_refused_before_the_first_message() -> None:
    with cw.World("empty") as world:
        odometry = world.topic("/odom", type="nav_msgs/Odometry")
        assert odometry.values("pose.pose.position.x").shape == (0,)
        assert odometry.values("pose.covariance[3]").shape == (0,)
        for _ in range(2):
            with raises(FIELD_UNKNOWN, field="pose.pose.positon.x", meant="position"):
                odometry.values("pose.pose.positon.x")
            with raises(FIELD_UNKNOWN, field="pose.pose.position.x.y", meant=""):
                odometry.plot("pose.pose.position.x.y")
            odometry.publish()
            world.run(0.1)


def test_a_name_is_in_the_namespace_of_the_model() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro", namespace="left")
        odometry = cart.topic("odom")
        assert odometry is world.topic("/left/odom") is cart.topic("/left/odom")
        cart.publish("part2_cmr/cmd_vel", linear_x=0.5)
        world.run(1.0)
        assert odometry.values("twist.twist.linear.x")[-1] > 0.3
        with raises(TOPIC_UNKNOWN):
            cart.topic("/odom")
        plain = world.spawn("rosbots.xacro", name="plain", y=2.0)
        assert plain.topic("odom") is world.topic("/odom")


def test_a_latched_message_is_there_at_once() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        transforms = world.topic("/tf_static")
        assert transforms.latest is not None
        assert transforms.count == 1
        world.run(0.1)
        assert transforms.count == 1


def test_a_sensor_without_topic_measures_nothing() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        publisher = next(p for p in world.graph.publishers() if p.topic == "/odom")
        world.run(0.5)
        assert publisher.sent == 0
        topic = world.topic("/odom")
        world.run(0.1)
        assert publisher.sent == topic.count == 10


def test_unknown_topics_and_types() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with raises(TOPIC_UNKNOWN, UnknownNameError, meant="/odom"):
            world.topic("/odm")
        mine = world.topic("/mine", type="std_msgs/Float64")
        assert mine.type == "std_msgs/msg/Float64"
        assert world.topic("/mine", type="std_msgs/msg/Float64") is mine
        with raises(TOPIC_TYPE_MISMATCH, GraphError):
            world.topic("/mine", type="std_msgs/Int32")
        mine.publish(data=2.5)
        world.run(0.0)
        assert mine.latest.data == 2.5
        assert "/mine" in world.topics


def test_waiting_runs_until_the_next_message() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        world.run(0.2)
        last = odometry.latest
        message = odometry.wait()
        assert message is odometry.latest is not last
        assert world.time == odometry.latest_time == 0.21


def test_a_wait_that_times_out_reports_what_is_known() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        scans = world.topic("/odom2", type="nav_msgs/Odometry")
        with raises(WAIT_TIMED_OUT, cw.TimedOutError, publishers=(), messages=0, meant="/odom"):
            scans.wait(timeout=0.2)
        assert world.time == pytest.approx(0.2)
        heights = world.topic("/height", type="std_msgs/Float32")
        with raises(WAIT_TIMED_OUT, topic="/height", meant=""):
            heights.wait(timeout=0.01)
        images = world.topic("/rosbots/camera1/image_raw")
        world.run(0.1)
        with raises(WAIT_TIMED_OUT, topic=images.name, rate=30.0, timeout=0.005):
            images.wait(timeout=0.005)


def test_holding_publishes_at_a_rate() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        commands = world.topic(CMD)
        held = commands.hold(linear_x=0.5, rate=20)
        assert held.active
        assert commands.count == 0
        world.run(1.0)
        assert commands.times() == pytest.approx([k / 20 for k in range(21)])
        # The ramp of 1 m/s² from the first update: v t - v²/2a.
        assert cart.pose.x == pytest.approx(0.5 - 0.5**2 / 2, abs=0.01)
        held.stop()
        held.stop()
        assert not held.active
        world.run(0.5)
        assert commands.count == 21
        # 30 Hz is no multiple of the step: at the step after each due time, without drift.
        with commands.hold({"linear": {"x": 0.1}}, rate=30) as thirty:
            world.run(1.0)
            assert commands.count == 21 + 31
        assert not thirty.active
        world.run(0.5)
        assert commands.count == 21 + 31
        assert world.graph.topic(CMD).publishers == ()


def test_a_reset_starts_a_held_message_again() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        commands = world.topic(CMD)
        held = commands.hold(linear_x=0.5, rate=10)
        world.run(0.35)
        world.reset()
        world.run(0.35)
        assert commands.times() == pytest.approx([0, 0.1, 0.2, 0.3]) and commands.count == 8
        assert held.active


def test_bad_messages_and_rates_are_refused() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        commands = world.topic(CMD)
        for use in (commands.publish, commands.hold):
            with raises(FIELD_UNKNOWN):
                use(liner_x=1.0)
        for rate in (0, -1, math.nan, math.inf, 1e300, "10", True, None):
            with raises(NUMBER_OUT_OF_RANGE):
                commands.hold(linear_x=1.0, rate=rate)  # type: ignore[arg-type]
        assert world.graph.topic(CMD).publishers == ()


def test_arrays_of_topics() -> None:
    with cw.World("walls") as world:
        world.spawn("rosbots.xacro")
        image = world.topic("/rosbots/camera1/image_raw")
        joints = world.topic("/joint_states")
        with raises(NO_MESSAGE, GraphError, topic=image.name):
            image.array()
        world.run(0.1)
        pixels = image.array()
        assert pixels.shape == (240, 320, 3)
        assert pixels.dtype == np.uint8
        assert np.shares_memory(pixels, image.latest.data)
        assert joints.array() == pytest.approx(joints.latest.position)


def test_the_world_is_freed_with_its_topics() -> None:
    import gc
    import weakref

    world: Any = cw.World("empty")
    topic = world.topic("/clock")
    topic.hold(rate=10)
    world.on(5.0, lambda: None)
    world.run(0.1)
    world.close()
    freed = weakref.ref(world.session.simulation)
    assert topic.count > 0
    gc.disable()
    try:
        del world, topic
        assert freed() is None
    finally:
        gc.enable()


def test_a_subscription_can_be_closed() -> None:
    with cw.World("empty") as world:
        times: list[float] = []
        subscription = world.subscribe("/clock", lambda _: times.append(world.time))
        world.run(0.1)
        assert len(times) == 11
        # Also by its own callback.
        other = world.subscribe("/clock", lambda _: other.close())
        world.run(0.1)
        subscription.close()
        subscription.close()
        world.run(0.1)
        assert len(times) == 21
        assert world.save().left_out == ()
