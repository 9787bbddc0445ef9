"""Topics of a world whose message class a program gives."""

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTIONS_CONFLICT
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    FIELD_VALUE_INVALID,
    MESSAGE_TYPE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
)
from cartwheel.msgs.geometry_msgs import Twist, Vector3
from cartwheel.msgs.nav_msgs import Odometry
from cartwheel.msgs.sensor_msgs import Imu
from cartwheel.msgs.std_msgs import Float64

COMMANDS = "/part2_cmr/cmd_vel"


def test_messages_have_the_class() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom", Odometry)
        assert odometry.latest is None
        box = world.mailbox("/odom", Odometry)
        received: list[Odometry] = []
        world.subscribe("/odom", received.append, type=Odometry)
        world.publish(COMMANDS, Twist(linear=Vector3(x=0.5)))
        world.run(1.0)
        for messages in (odometry.history(), box.drain(), received):
            assert len(messages) == 101
            assert all(type(each) is Odometry for each in messages)
        assert odometry.latest.twist.twist.linear.x == pytest.approx(0.5, abs=0.01)
        assert world.topic("/odom") is world.topic("/odom", type="nav_msgs/Odometry") is odometry


def test_the_class_of_another_type_is_refused() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        for _ in range(2):
            with raises(TOPIC_TYPE_MISMATCH):
                world.topic("/odom", Imu)
            world.topic("/odom")
        for use in (
            lambda: world.mailbox("/odom", Imu),
            lambda: world.subscribe("/odom", print, type=Imu),
            lambda: world.advertise("/odom", Imu),
        ):
            with raises(TOPIC_TYPE_MISMATCH):
                use()
        with raises(FIELD_VALUE_INVALID):
            world.topic("/odom", Odometry).publish(Imu())  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [int, Odometry(), 5, dict])
def test_what_is_not_a_message_type_is_refused(wrong: object) -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        for use in (
            lambda: world.topic("/odom", wrong),  # type: ignore[call-overload]
            lambda: world.mailbox("/odom", wrong),  # type: ignore[call-overload]
            lambda: world.subscribe("/odom", print, type=wrong),  # type: ignore[call-overload]
            lambda: world.advertise("/x", wrong),  # type: ignore[call-overload]
            lambda: world.message_class(wrong),  # type: ignore[arg-type]
        ):
            with raises(MESSAGE_TYPE_UNKNOWN):
                use()


def test_a_class_creates_a_topic() -> None:
    with cw.World("empty") as world:
        heights = world.topic("/height", Float64)
        box = world.mailbox("/height", Float64)
        publisher = world.advertise("/height", Float64)
        publisher.publish(Float64(2.5))
        assert heights.latest.data == 2.5
        publisher.publish(data=1.5)
        publisher.publish({"data": 0.5})
        assert [each.data for each in box.drain()] == [2.5, 1.5, 0.5]
        with raises(OPTIONS_CONFLICT):
            publisher.publish(Float64(2.5), data=1.0)
        with raises(FIELD_UNKNOWN, field="dta", meant="data"):
            publisher.publish(dta=1.0)
        assert heights.type == "std_msgs/msg/Float64"
