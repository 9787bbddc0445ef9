"""Recordings that a program reads."""

import math
from pathlib import Path

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    FRAME_UNKNOWN,
    FRAMES_SHARED,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
    TRANSFORM_TIME,
)
from cartwheel.codes.recording import NOT_A_RECORDING
from cartwheel.errors import GraphError, RecordingError, UnknownNameError
from cartwheel.gazebo.robot_states import hold_states
from cartwheel.messages import encode_cdr
from cartwheel.msgs.nav_msgs import Odometry
from cartwheel.msgs.sensor_msgs import BatteryState

TOPICS = ["/odom", "/imu/data", "/scan", "/state", "/clock"]
LASER = """<sdf version="1.9"><model name="laser"><static>true</static><pose>0 0 1 0 0 0</pose>
<link name="link"><sensor name="scan" type="ray"><update_rate>10</update_rate><ray><scan>
<horizontal><samples>20</samples><min_angle>-1.1</min_angle><max_angle>1.3</max_angle></horizontal></scan><range>
<min>0.12</min><max>3.3</max></range></ray><plugin name="p" filename="libgazebo_ros_laser.so">
<topicName>/scan</topicName></plugin></sensor></link></model></sdf>"""
"""Its messages have single numbers of 32 bits, unlike those of the cart."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[cw.RecordedMessage]]:
    """A folder with a recording in each format, and what was received meanwhile."""
    folder = tmp_path_factory.mktemp("recorded")
    received: list[cw.RecordedMessage] = []
    with cw.World("walls", seed=3) as world:
        world.spawn("rosbots.xacro", z=0.05)
        world.spawn(LASER)
        battery = world.advertise("/state", BatteryState)
        world.every(10.0, lambda: battery.publish(voltage=12.1 + world.time, charge=math.nan))
        for topic in ("/odom", "/imu/data", "/scan", "/state"):
            world.subscribe(
                topic,
                lambda m, t=topic: received.append(cw.RecordedMessage(world.time, t, m)),
            )
        with (
            world.record(folder / "drive.mcap", topics=TOPICS),
            world.record(folder / "drive.bag", topics=TOPICS),
            world.record(folder / "drive.db3", topics=TOPICS),
            world.record(folder / "drive", topics=TOPICS),
        ):
            world.publish("/part2_cmr/cmd_vel", linear_x=0.4)
            world.run(1.0)
    return folder, received


@pytest.mark.parametrize("name", ["drive.mcap", "drive.bag", "drive.db3", "drive"])
def test_messages_are_those_that_were_published(
    name: str, recorded: tuple[Path, list[cw.RecordedMessage]]
) -> None:
    folder, received = recorded
    with cw.Recording(folder / name) as recording:
        assert recording.complete
        assert set(TOPICS) == set(recording.topics)
        assert recording.type("/odom") == "nav_msgs/msg/Odometry"
        assert recording.count("/odom") == sum(each.topic == "/odom" for each in received)
        assert (recording.start, recording.end) == pytest.approx((0.0, 1.0), abs=1e-8)
        read = list(recording.messages("/odom", "/imu/data", "/scan", "/state"))
        assert [each.topic for each in read] == [each.topic for each in received]
        for one, other in zip(read, received, strict=True):
            assert one.time == pytest.approx(other.time, abs=1e-8)
            assert one.message == other.message
            if name != "drive.bag":  # a bag has sequence numbers, and no time 0
                assert encode_cdr(one.message) == encode_cdr(other.message)
        part = list(recording.messages("/odom", start=0.3, end=0.5))
        assert [each.time for each in part] == [
            each.time for each in read if each.topic == "/odom" and 0.3 <= each.time <= 0.5
        ]
        assert {each.topic for each in recording.messages()} == set(recording.topics)


def test_values_of_a_topic(recorded: tuple[Path, list[cw.RecordedMessage]]) -> None:
    folder, received = recorded
    odometry = [each for each in received if each.topic == "/odom"]
    with cw.Recording(folder / "drive.mcap") as recording:
        assert recording.times("/odom") == pytest.approx([each.time for each in odometry])
        places = recording.values("/odom", "pose.pose.position.x")
        assert places.tolist() == [each.message.pose.pose.position.x for each in odometry]
        assert recording.values("/odom", "pose.covariance").shape == (len(odometry), 36)
        with raises(FIELD_UNKNOWN):
            recording.values("/odom", "pose.nothing")


def test_unknown_topics_and_files(recorded: tuple[Path, list[cw.RecordedMessage]]) -> None:
    folder, _ = recorded
    with cw.Recording(folder / "drive.mcap") as recording:
        for use in (recording.count, recording.type, recording.times, recording.messages):
            with raises(TOPIC_UNKNOWN, UnknownNameError, meant="/odom"):
                use("/odm")
    (folder / "text.mcap").write_text("not a recording")
    with raises(NOT_A_RECORDING, RecordingError):
        cw.Recording(folder / "text.mcap")


ARM = """<robot name="arm"><link name="world"/><link name="base"/>
<link name="upper"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="tip"/>
<joint name="ground" type="fixed"><parent link="world"/><child link="base"/></joint>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
<joint name="glue" type="fixed"><parent link="upper"/><child link="tip"/><origin xyz="0.4 0 0"/>
</joint></robot>"""


def test_a_recording_contains_the_transforms_of_all_links(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        arm = world.spawn(ARM)
        arm.joints.positions["shoulder"] = 0.5
        world.run(0.2)
        assert not {"/tf", "/tf_static"} & set(world.topics)
        with world.record(tmp_path / "arm.mcap"):
            world.run(0.1)
            world.spawn(ARM, name="other", frame_prefix="other", x=2.0)
            world.run(0.1)
        assert not {"/tf", "/tf_static", "/robot_description"} & set(world.topics)
    with cw.Recording(tmp_path / "arm.mcap") as recording:
        fixed = list(recording.messages("/tf_static"))
        moving = list(recording.messages("/tf"))
    assert [each.time for each in fixed] == pytest.approx([0.2, 0.3], abs=1e-3)
    pairs = [(t.header.frame_id, t.child_frame_id) for t in fixed[-1].message.transforms]
    assert pairs == [("upper", "tip"), ("other/upper", "other/tip")]
    assert [each.time for each in moving] == pytest.approx([0.2 + i / 50 for i in range(11)])
    first = moving[0].message.transforms[0]
    assert (first.header.frame_id, first.child_frame_id) == ("base", "upper")
    assert first.transform.rotation.z == pytest.approx(math.sin(0.25), abs=1e-3)
    assert len(moving[-1].message.transforms) == 2


@pytest.mark.parametrize("file", ["drive.mcap", "drive.bag", "drive.db3"])
def test_transforms_of_a_recording(tmp_path: Path, file: str) -> None:
    """They are those of the world, also after more than the 10 s for which a world keeps them."""
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro", z=0.05)
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.1, angular_z=0.1)
        world.keep_transforms(60.0)
        with world.record(tmp_path / file, topics=["/tf", "/tf_static"]):
            world.run(12.0)
        with cw.Recording(tmp_path / file) as recording:
            for time in (0.5, 3.0123, 11.9, None):
                found = recording.transform("odom", "camera", time)
                assert found == world.transform("odom", "camera", time)
            with raises(TRANSFORM_TIME, GraphError, time=13.0):
                recording.transform("odom", "camera", 13.0)
            with raises(FRAME_UNKNOWN, UnknownNameError, name="camra", meant="camera"):
                recording.transform("odom", "camra")


def test_a_recording_without_transforms(recorded: tuple[Path, list[cw.RecordedMessage]]) -> None:
    with (
        cw.Recording(recorded[0] / "drive.mcap") as recording,
        raises(TOPIC_UNKNOWN, UnknownNameError, name="/tf"),
    ):
        recording.transform("odom", "camera")


def test_transforms_are_published_once_something_subscribes() -> None:
    with cw.World("empty") as world:
        moving, fixed = world.topic("/tf"), world.topic("tf_static")
        received: list[object] = []
        world.subscribe("/tf", received.append)
        world.spawn(ARM)
        world.run(0.1)
        assert moving.type == fixed.type == "tf2_msgs/msg/TFMessage"
        assert moving.latest.transforms[0].child_frame_id == "upper"
        assert fixed.latest.transforms[0].child_frame_id == "tip"
        assert received == moving.history()
        state = world.save()
        world.run(0.1)
        before = moving.history()[-5:]
        world.restore(state)
        world.run(0.1)
        assert [encode_cdr(m) for m in moving.history()[-5:]] == [encode_cdr(m) for m in before]


def test_robots_with_the_same_frames_are_reported_when_recorded(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        world.spawn(ARM)
        world.spawn(ARM, name="other", x=2.0)
        release = hold_states(world.session, reports=False)
        world.run(0.1)
        assert coded(world, FRAMES_SHARED) == []
        with world.record(tmp_path / "arms.mcap"):
            world.run(0.1)
        (found,) = coded(world, FRAMES_SHARED)
        assert found.values["model"] == "other"
        assert "/tf" in world.topics
        release()
        assert "/tf" not in world.topics


@pytest.mark.parametrize("name", ["drive.mcap", "drive.bag", "drive"])
def test_messages_of_a_type(name: str, recorded: tuple[Path, list[cw.RecordedMessage]]) -> None:
    folder, received = recorded
    with cw.Recording(folder / name) as recording:
        odometry = list(recording.messages("/odom", type=Odometry))
        assert len(odometry) == sum(each.topic == "/odom" for each in received)
        speed: float = odometry[-1].message.twist.twist.linear.x
        assert speed > 0.3
        of_type = list(recording.messages(type="sensor_msgs/msg/Imu", start=0.5))
        assert {each.topic for each in of_type} == {"/imu/data"}
        with raises(TOPIC_TYPE_MISMATCH, topic="/imu/data"):
            recording.messages("/imu/data", type=Odometry)
