"""Recordings that a program reads."""

from pathlib import Path

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.graph import FIELD_UNKNOWN, TOPIC_UNKNOWN
from cartwheel.codes.recording import NOT_A_RECORDING
from cartwheel.errors import RecordingError, UnknownNameError
from cartwheel.messages import encode_cdr

TOPICS = ["/odom", "/imu/data", "/scan", "/clock"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[cw.RecordedMessage]]:
    """A folder with a recording in each format, and what was received meanwhile."""
    folder = tmp_path_factory.mktemp("recorded")
    received: list[cw.RecordedMessage] = []
    with cw.World("walls", seed=3) as world:
        world.spawn("rosbots.xacro", z=0.05)
        for topic in ("/odom", "/imu/data"):
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
        assert {"/odom", "/imu/data", "/clock"} == set(recording.topics)
        assert recording.type("/odom") == "nav_msgs/msg/Odometry"
        assert recording.count("/odom") == sum(each.topic == "/odom" for each in received)
        assert (recording.start, recording.end) == pytest.approx((0.0, 1.0), abs=1e-8)
        read = list(recording.messages("/odom", "/imu/data"))
        assert [each.topic for each in read] == [each.topic for each in received]
        for one, other in zip(read, received, strict=True):
            assert one.time == pytest.approx(other.time, abs=1e-8)
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
