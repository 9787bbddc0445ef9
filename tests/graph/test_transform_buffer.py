"""Transforms at any time, with the rules and the errors of tf2."""

import math

import pytest
from tests.coded import raises

from cartwheel.codes.graph import FRAME_UNKNOWN, FRAMES_NOT_CONNECTED, TRANSFORM_TIME
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.geometry import Pose, interpolated, quat_from_rpy
from cartwheel.graph.transform_buffer import SECOND, TransformBuffer
from cartwheel.messages import header, message_class


def stamped(time, parent, child, pose):
    return message_class("geometry_msgs/msg/TransformStamped")(
        header(round(time * SECOND), parent),
        child,
        message_class("geometry_msgs/msg/Transform")(
            message_class("geometry_msgs/msg/Vector3")(*pose.position),
            message_class("geometry_msgs/msg/Quaternion")(*pose.orientation),
        ),
    )


@pytest.fixture
def buffer():
    return TransformBuffer(0)


def move(buffer, time, x, *, yaw=0.0, parent="odom", child="base"):
    pose = Pose((x, 0.0, 0.0), quat_from_rpy(0, 0, yaw))
    buffer.add([stamped(time, parent, child, pose)], static=False)


def mount(buffer, child, x, parent="base"):
    buffer.add([stamped(0.0, parent, child, Pose((x, 0.0, 0.0)))], static=True)


def test_a_pose_between_two_transforms_is_interpolated(buffer):
    move(buffer, 1.0, 0.0)
    move(buffer, 2.0, 2.0, yaw=1.0)
    mount(buffer, "laser", 0.5)
    found = buffer.lookup("odom", "laser", round(1.25 * SECOND))
    assert found.position == pytest.approx((0.5 + 0.5 * math.cos(0.25), 0.5 * math.sin(0.25), 0))
    assert found.yaw == pytest.approx(0.25)
    back = buffer.lookup("laser", "odom", round(1.25 * SECOND)) @ found
    assert back.position == pytest.approx((0, 0, 0), abs=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_orientations_turn_at_a_constant_rate_the_shorter_way(share):
    start = Pose((0.0, 0.0, 0.0), quat_from_rpy(0, 0, 3.0))
    end = Pose((1.0, 2.0, 3.0), tuple(-each for each in quat_from_rpy(0, 0, -3.0)))
    turned = 2 * math.pi - 6.0
    found = interpolated(start, end, share)
    assert math.remainder(found.yaw - (3.0 + turned * share), 2 * math.pi) == pytest.approx(0)
    assert found.position == pytest.approx((share, 2 * share, 3 * share))


def test_without_a_time_the_newest_common_one_counts(buffer):
    for time, x in ((1.0, 1.0), (2.0, 2.0), (3.0, 3.0)):
        move(buffer, time, x)
    for time, x in ((1.0, 0.1), (2.0, 0.2)):
        move(buffer, time, x, parent="base", child="arm")
    assert buffer.lookup("odom", "base").x == 3.0
    assert buffer.lookup("odom", "arm").x == pytest.approx(2.2)
    assert buffer.lookup("base", "arm").x == 0.2
    mount(buffer, "lamp", 0.5)
    assert buffer.lookup("lamp", "base").x == -0.5
    assert buffer.lookup("lamp", "lamp") == Pose()


def test_frames_of_two_branches_need_only_the_transforms_between_them(buffer):
    """As in tf2: that the robot's pose in odom is old does not matter within the robot."""
    move(buffer, 1.0, 1.0)
    move(buffer, 5.0, 0.3, parent="base", child="arm")
    mount(buffer, "laser", 0.5)
    assert buffer.lookup("laser", "arm", 5 * SECOND).x == pytest.approx(-0.2)
    with raises(TRANSFORM_TIME, GraphError, frame="base", time=5.0, newest=1.0):
        buffer.lookup("odom", "arm", 5 * SECOND)


@pytest.mark.parametrize("time", [0.5, 2.5])
def test_nothing_is_extrapolated(buffer, time):
    move(buffer, 1.0, 1.0)
    move(buffer, 2.0, 2.0)
    with raises(TRANSFORM_TIME, GraphError, frame="base", time=time, oldest=1.0, newest=2.0):
        buffer.lookup("odom", "base", round(time * SECOND))


def test_transforms_are_kept_for_ten_seconds_and_longer_if_asked(buffer):
    for kept, oldest in ((10, 40), (25, 25)):
        buffer.kept_ns = kept * SECOND
        buffer.rewind(0)
        for tenth in range(501):
            move(buffer, tenth / 10, tenth / 10)
        assert buffer.lookup("odom", "base", oldest * SECOND).x == oldest
        assert len(buffer._moving["base"]) <= 10 * kept * 9 / 8 + 2
        with raises(TRANSFORM_TIME, GraphError):
            buffer.lookup("odom", "base", (oldest - 4) * SECOND)
    move(buffer, 1.0, 1.0)
    with raises(TRANSFORM_TIME, GraphError, newest=50.0):
        buffer.lookup("odom", "base", SECOND)


def test_transforms_may_arrive_in_any_order_and_the_last_of_a_time_counts(buffer):
    for time, x in ((3.0, 3.0), (1.0, 1.0), (2.0, 5.0), (2.0, 2.0)):
        move(buffer, time, x)
    assert buffer.lookup("odom", "base", round(1.5 * SECOND)).x == 1.5
    assert buffer.lookup("odom", "base", round(2.5 * SECOND)).x == 2.5


def test_a_frame_may_get_another_parent(buffer):
    move(buffer, 1.0, 1.0, parent="table", child="cup")
    move(buffer, 2.0, 0.1, parent="hand", child="cup")
    assert buffer.lookup("table", "cup", round(1.9 * SECOND)).x == 1.0
    assert buffer.lookup("hand", "cup").x == 0.1
    with raises(FRAMES_NOT_CONNECTED, GraphError, target="table", source="cup"):
        buffer.lookup("table", "cup")


def test_unknown_frames_have_a_suggestion(buffer):
    move(buffer, 1.0, 1.0)
    with raises(FRAME_UNKNOWN, UnknownNameError, name="bas", meant="base"):
        buffer.lookup("odom", "bas")
    assert buffer.lookup("/odom", "/base").x == 1.0


@pytest.mark.wording
def test_a_frame_that_a_drive_does_not_publish_has_a_hint():
    buffer = TransformBuffer(SECOND // 2)
    mount(buffer, "laser", 1.0, parent="base")
    with raises(FRAME_UNKNOWN, UnknownNameError, name="odom", since=0.5) as caught:
        buffer.lookup("odom", "laser")
    assert "<publish_odom_tf>" in caught.value.hint


@pytest.mark.parametrize(
    "parent, child, pose",
    [
        ("", "base", Pose()),
        ("base", "base", Pose()),
        ("odom", "base", Pose((math.nan, 0.0, 0.0))),
        ("odom", "base", Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))),
    ],
)
def test_what_tf2_ignores_is_ignored_and_the_error_says_why(buffer, parent, child, pose):
    mount(buffer, "odom", 1.0, parent="map")
    buffer.add([stamped(1.0, parent, child, pose)], static=False)
    assert buffer.frames == ["map", "odom"]
    with raises(FRAME_UNKNOWN, UnknownNameError, name="base") as caught:
        buffer.lookup("odom", "base")
    assert caught.value.values["ignored"]


def test_frames_in_a_circle_are_not_connected(buffer):
    for parent, child in (("a", "b"), ("b", "c"), ("c", "a"), ("x", "y")):
        mount(buffer, child, 1.0, parent=parent)
    with raises(FRAMES_NOT_CONNECTED, GraphError):
        buffer.lookup("x", "a")


def test_the_future_is_forgotten_when_time_goes_back(buffer):
    mount(buffer, "laser", 0.5)
    for time in (1.0, 2.0, 3.0):
        move(buffer, time, time)
    buffer.rewind(2 * SECOND)
    assert buffer.lookup("odom", "base").x == 2.0
    buffer.rewind(0)
    assert buffer.frames == ["base", "laser"]
