"""Topics of the simulation over DDS, as a program on Fast DDS sees and fills them."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator

import numpy as np
import pytest
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer, Ros2Bridged
from tests.coded import coded

from cartwheel.codes.wires import PEER_TYPE_MISMATCH, QOS_INCOMPATIBLE, UNRESPONSIVE_SUBSCRIBER
from cartwheel.messages import decode_cdr, encode_cdr, from_dict

pytestmark = pytest.mark.skipif(bool(REASON), reason=REASON)

IMAGE, ODOMETRY = "sensor_msgs/msg/Image", "nav_msgs/msg/Odometry"
TF, CLOCK, TWIST = "tf2_msgs/msg/TFMessage", "rosgraph_msgs/msg/Clock", "geometry_msgs/msg/Twist"
CAMERA = "/rosbots/camera1/image_raw"


@pytest.fixture(scope="module")
def bridged() -> Iterator[Ros2Bridged]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
        made = Ros2Bridged()
        yield made
        made.close()


@pytest.fixture
def peer(bridged: Ros2Bridged) -> Iterator[Peer]:
    made = Peer()
    yield made
    made.close()


def entities(peer: Peer) -> list[tuple[str, str, int, int]]:
    """Nodes as last published on ``ros_discovery_info``: namespace, name, readers, writers."""
    name = "rmw_dds_common/msg/ParticipantEntitiesInfo"
    data = [
        bytes.fromhex(line[3])
        for line in peer.lines
        if line[0] == "DATA" and line[1] == "ros_discovery_info"
    ]
    return [
        (
            node.node_namespace,
            node.node_name,
            len(node.reader_gid_seq),
            len(node.writer_gid_seq),
        )
        for node in decode_cdr(data[-1], name).node_entities_info_seq
    ]


def test_endpoints_have_ros_names_types_hashes_and_qos(peer: Peer) -> None:
    # Each endpoint arrives by itself, in any order.
    names = {f"rt{topic}" for topic in (CAMERA, "/odom", "/tf", "/tf_static", "/clock")}
    wait_for(lambda: names <= peer.endpoints("WRITER").keys(), "the writers")
    wait_for(lambda: "rt/part2_cmr/cmd_vel" in peer.endpoints("READER"), "the reader of cmd_vel")
    writers = peer.endpoints("WRITER")
    # Hashes as ROS 2 Jazzy publishes them in its installed type descriptions.
    assert writers["rt/odom"] == [
        "nav_msgs::msg::dds_::Odometry_",
        "1",
        "0",
        "typehash=RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0;",
    ]
    assert writers["rt/tf"][:3] == ["tf2_msgs::msg::dds_::TFMessage_", "1", "0"]
    assert writers["rt/tf_static"][:3] == ["tf2_msgs::msg::dds_::TFMessage_", "1", "1"]
    assert writers["rt/clock"][:3] == ["rosgraph_msgs::msg::dds_::Clock_", "1", "0"]
    assert writers[f"rt{CAMERA}"] == [
        "sensor_msgs::msg::dds_::Image_",
        "0",
        "0",
        "typehash=RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47;",
    ]
    reader = peer.endpoints("READER")["rt/part2_cmr/cmd_vel"]
    assert reader[:3] == ["geometry_msgs::msg::dds_::Twist_", "1", "0"]
    # What ROS 1 alone has is not offered.
    assert not [name for name in writers if "parameter_descriptions" in name]


def test_the_participant_says_that_it_is_a_node(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.tell(
        "sub", "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", 1, 1
    )
    wait_for(lambda: any(line[0] == "DATA" for line in peer.lines), "what belongs to the node")
    assert ["PARTICIPANT", "enclave=/;"] in peer.lines
    ((namespace, name, readers, writers),) = entities(peer)
    assert (namespace, name) == ("/", "gazebo")
    known = peer.endpoints("WRITER")
    wait_for(
        lambda: (
            entities(peer)[0][2:]
            == (len(peer.endpoints("READER")), len(peer.endpoints("WRITER")) - 1)
        ),
        f"all endpoints but that of the discovery itself: {readers}, {writers} of {len(known)}",
    )


def test_odometry_transforms_and_clock_arrive(bridged: Ros2Bridged, peer: Peer) -> None:
    for topic, type_name in (("/odom", ODOMETRY), ("/tf", TF), ("/clock", CLOCK)):
        peer.subscribe(topic, type_name)
    for topic in ("/odom", "/tf", "/clock"):
        wait_for(lambda topic=topic: len(peer.received(topic)) > 100, topic)
    stamps = [
        message.clock.sec * 10**9 + message.clock.nanosec
        for message in peer.messages("/clock", CLOCK)
    ]
    # 100 Hz of simulation time, none lost, none twice.
    assert np.diff(stamps).tolist() == [10**7] * (len(stamps) - 1)
    odometry = peer.messages("/odom", ODOMETRY)[-1]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    frames = {
        (one.header.frame_id, one.child_frame_id)
        for message in peer.messages("/tf", TF)
        for one in message.transforms
    }
    assert ("odom", "base_footprint") in frames


def test_images_arrive_whole(bridged: Ros2Bridged, peer: Peer) -> None:
    assert not bridged.wanted(CAMERA)
    peer.subscribe(CAMERA, IMAGE, reliable=False)
    wait_for(lambda: len(peer.received(CAMERA)) > 10, "images")
    assert bridged.wanted(CAMERA)
    size, head = peer.received(CAMERA)[-1]
    image = decode_cdr(head + bytes(size - len(head)), IMAGE)
    assert (image.height * image.width * 3, image.encoding) == (image.data.size, "rgb8")
    peer.close()
    wait_for(lambda: not bridged.wanted(CAMERA), "that nothing is drawn for nobody")


def test_large_images_arrive_at_best_effort(bridged: Ros2Bridged, peer: Peer) -> None:
    # 47 datagrams each, to a receiver that has room for three.
    image = from_dict(IMAGE, {"width": 1280, "height": 720, "step": 3840, "encoding": "rgb8"})
    image.data = np.zeros(1280 * 720 * 3, np.uint8)
    publisher = bridged.graph.advertise("/large", IMAGE, node="test", qos="sensor")

    def publish() -> None:
        publisher.publish(image)

    simulation = bridged.simulation
    task = simulation.call(
        lambda: simulation.schedule(30.0, after=publish, active=lambda: publisher.wanted)
    ).result()
    peer.subscribe("/large", IMAGE, reliable=False)
    wait_for(lambda: len(peer.received("/large")) > 20, "images")
    assert {size - size % 4 for size, _ in peer.received("/large")} == {
        len(encode_cdr(image)) // 4 * 4
    }
    simulation.call(lambda: simulation.unschedule(task)).result()
    bridged.simulation.call(publisher.close).result()


def test_who_asks_for_more_than_is_offered_gets_nothing(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.subscribe(CAMERA, IMAGE, reliable=True)
    peer.subscribe("/clock", CLOCK)
    wait_for(lambda: len(peer.received("/clock")) > 50, "the clock")
    assert not peer.received(CAMERA)
    assert coded(bridged.reports, QOS_INCOMPATIBLE, name=CAMERA, policy="RELIABILITY")


def test_who_takes_a_topic_for_another_type_is_reported(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.subscribe("/odom", CLOCK)
    peer.publish("/part2_cmr/cmd_vel", CLOCK, {})
    wait_for(lambda: mismatched(bridged, "/odom"), "the reader")
    wait_for(lambda: mismatched(bridged, "/part2_cmr/cmd_vel"), "the writer")


def mismatched(bridged: Ros2Bridged, topic: str) -> bool:
    """Whether another type of a topic was reported."""
    return bool(coded(bridged.reports, PEER_TYPE_MISMATCH, name=topic, type=CLOCK))


def test_static_transforms_reach_who_comes_late(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.subscribe("/tf_static", TF, transient=True)
    (message,) = wait_for(lambda: peer.messages("/tf_static", TF), "the static transforms")
    assert ("base_footprint", "base_link") in {
        (one.header.frame_id, one.child_frame_id) for one in message.transforms
    }
    late = Peer()
    try:
        late.subscribe("/tf_static", TF, transient=True)
        wait_for(lambda: late.received("/tf_static"), "them for one who comes later")
    finally:
        late.close()


def test_cmd_vel_drives_the_cart(bridged: Ros2Bridged, peer: Peer) -> None:
    start = bridged.simulation.call(lambda: bridged.simulation.pose("rosbots")).result()
    peer.publish("/part2_cmr/cmd_vel", TWIST, {"linear": {"x": 0.5}})

    def moved() -> float:
        pose = bridged.simulation.call(lambda: bridged.simulation.pose("rosbots")).result()
        return float(np.hypot(*np.subtract(pose.position, start.position)[:2]))

    wait_for(lambda: moved() > 0.5, "the cart's way")
    peer.tell("quiet", "rt/part2_cmr/cmd_vel")


def test_a_topic_that_comes_and_goes_is_seen_to(bridged: Ros2Bridged, peer: Peer) -> None:
    def advertise() -> object:
        return bridged.graph.advertise("/for_a_while", "std_msgs/msg/String", node="test")

    publisher = bridged.simulation.call(advertise).result()
    wait_for(lambda: "rt/for_a_while" in peer.endpoints("WRITER"), "the new topic")
    bridged.simulation.call(publisher.close).result()  # type: ignore[attr-defined]
    wait_for(lambda: any(line[0] == "NO_WRITER" for line in peer.lines), "its end")


def test_a_frozen_reader_holds_nobody_up(bridged: Ros2Bridged) -> None:
    with contextlib.ExitStack() as stack:
        frozen, other = Peer(), Peer()
        stack.callback(frozen.close)
        stack.callback(other.close)
        for each in (frozen, other):
            each.subscribe("/odom", ODOMETRY)
            each.subscribe(CAMERA, IMAGE, reliable=False)
            wait_for(lambda each=each: len(each.received(CAMERA)) > 5, "images")
        os.kill(frozen.process.pid, signal.SIGSTOP)
        before = len(other.received("/odom"))
        wait_for(lambda: len(other.received("/odom")) > before + 300, "odometry for the other")
        stamps = [
            message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            for message in other.messages("/odom", ODOMETRY)
        ]
        # A reader that is slow for a moment may lose more than the ten messages of its queue.
        steps = np.diff(stamps)
        assert steps.min() == np.median(steps) == 10_000_000
        assert steps.max() < 10**9
        wait_for(
            lambda: coded(bridged.reports, UNRESPONSIVE_SUBSCRIBER),
            "the report of who is frozen",
        )
        (missed,) = bridged.graph.topic("/odom").dropped
        assert missed > 0
        assert bridged.graph.topic("/odom").readers == (f"ros2 ({missed} dropped)",)
        os.kill(frozen.process.pid, signal.SIGCONT)
        after = len(frozen.received("/odom"))
        wait_for(lambda: len(frozen.received("/odom")) > after + 100, "that it goes on")


def test_who_leaves_is_forgotten(bridged: Ros2Bridged, peer: Peer) -> None:
    peer.subscribe("/odom", ODOMETRY)
    wait_for(lambda: peer.received("/odom"), "odometry")
    dds = bridged.bridge.middleware
    assert isinstance(dds.participant._remotes.by_prefix, dict)  # type: ignore[attr-defined]
    peer.kill()
    # It was killed, so only its silence shows that.
    wait_for(lambda: not dds.participant._remotes.by_prefix, "its end", 40.0)  # type: ignore[attr-defined]
    wait_for(lambda: not bridged.wanted("/odom"), "that nothing is published for nobody")


def test_on_the_network_it_is_found_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 5))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    with contextlib.ExitStack() as stack:
        made = Ros2Bridged()
        stack.callback(made.close)
        assert "visible on the network" in made.bridge.description
        peer = Peer(DOMAIN + 5)
        stack.callback(peer.close)
        peer.subscribe("/odom", ODOMETRY)
        wait_for(lambda: len(peer.received("/odom")) > 50, "odometry")
