"""Nothing is made for nobody, and no reader disturbs the simulation."""

import itertools
import os
import signal
import struct

import numpy as np
import pytest
from tests.bridges.conftest import Bridge
from tests.bridges.ros1_peers import Master, Subscriber, wait_for

from cartwheel.codes.wires import PEER_TYPE_MISMATCH, SLOW_SUBSCRIBER, TYPE_UNSUPPORTED
from cartwheel.messages import from_dict, message_class, zero

pytestmark = pytest.mark.timeout(300)

IMAGE = "/rosbots/camera1/image_raw"
READ = """
import sys, rospy
rospy.init_node("reader", disable_rostime=True)
first = []
def take(message):
    if not first:
        first.append(1)
        print("first", flush=True)
rospy.Subscriber(sys.argv[1], rospy.AnyMsg, take)
rospy.spin()
"""


def test_a_camera_works_while_somebody_looks(bridge: Bridge, master: Master) -> None:
    run = bridge()
    assert not run.wanted(IMAGE)
    subscriber = Subscriber(master, IMAGE)
    assert len(subscriber.read()) > 320 * 240 * 3
    assert run.wanted(IMAGE)
    assert not run.wanted("/odom")
    subscriber.close()
    wait_for(lambda: not run.wanted(IMAGE), "nobody to look")
    again = Subscriber(master, IMAGE)
    again.read()
    assert run.wanted(IMAGE)
    again.close()
    wait_for(lambda: not run.wanted(IMAGE), "nobody to look again")


def test_messages_are_stamped_and_counted(bridge: Bridge, master: Master) -> None:
    bridge()
    subscriber = Subscriber(master, "/odom")
    heads = [struct.unpack_from("<III", subscriber.read()) for _ in range(5)]
    subscriber.close()
    times = [seconds * 1_000_000_000 + nanoseconds for _, seconds, nanoseconds in heads]
    assert [later - sooner for sooner, later in itertools.pairwise(times)] == [10**7] * 4
    assert [head[0] - heads[0][0] for head in heads] == list(range(5))


def test_what_is_latched_reaches_who_comes_late(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    publisher = run.graph.advertise("/map_name", "std_msgs/msg/String", qos="latched")
    run.graph.post(lambda: publisher.publish(from_dict("std_msgs/String", {"data": "maze"})))
    wait_for(lambda: "/map_name" in master.types(), "/map_name")
    first = Subscriber(master, "/map_name")
    assert first.header["latching"] == "1"
    assert first.read() == b"\4\0\0\0maze"
    second = Subscriber(master, "/map_name")
    assert second.read() == b"\4\0\0\0maze"
    first.close()
    second.close()
    wait_for(lambda: not run.graph.topic("/map_name").subscribers, "nobody")
    third = Subscriber(master, "/map_name")
    assert third.read() == b"\4\0\0\0maze"
    third.close()


def test_graph_changes_are_followed(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    publisher = run.graph.advertise("/late", "std_msgs/msg/String")
    heard: list[str] = []
    subscription = run.graph.subscribe(
        "/words", lambda message: heard.append(message.data), type_name="std_msgs/msg/String"
    )
    service = run.graph.serve(
        "/ask", "std_srvs/srv/Trigger", lambda _: zero("std_srvs/srv/Trigger_Response")
    )
    wait_for(lambda: "/late" in master.state()[0], "the publisher")
    wait_for(lambda: "/words" in master.state()[1], "the subscriber")
    wait_for(lambda: "/ask" in master.state()[2], "the service")
    publisher.close()
    subscription.close()
    run.graph.withdraw(service)
    wait_for(lambda: "/late" not in master.state()[0], "no publisher")
    wait_for(lambda: "/words" not in master.state()[1], "no subscriber")
    wait_for(lambda: "/ask" not in master.state()[2], "no service")


def test_a_message_from_ros_is_not_sent_back(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    ours = run.graph.advertise("/chat", "std_msgs/msg/String")
    heard: list[str] = []
    run.graph.subscribe("/chat", lambda message: heard.append(message.data))
    wait_for(lambda: "/chat" in master.state()[1], "/chat")
    subscriber = Subscriber(master, "/chat")
    talker = master.python(
        "import rospy; from std_msgs.msg import String\n"
        "rospy.init_node('talker', disable_rostime=True)\n"
        "rospy.Publisher('/chat', String, queue_size=9, latch=True).publish('from ros')\n"
        "rospy.spin()"
    )
    try:
        wait_for(lambda: heard, "the talker")
    finally:
        talker.kill()
        talker.communicate()
    run.graph.post(lambda: ours.publish(from_dict("std_msgs/String", {"data": "from us"})))
    assert subscriber.read() == b"\7\0\0\0from us"
    assert heard == ["from ros", "from us"]


def test_a_wrong_type_is_refused_and_reported(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    subscriber = Subscriber(master, "/clock", type="std_msgs/String", md5sum="0" * 32)
    assert "rosgraph_msgs/Clock" in subscriber.header["error"]
    with pytest.raises(ConnectionError):
        subscriber.read()
    wait_for(lambda: run.reported(PEER_TYPE_MISMATCH, type="std_msgs/String") == 1, "the report")
    assert not run.wanted("/clock")


def test_types_that_ros1_lacks_are_reported_and_left_out(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    run.graph.advertise("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
    wait_for(
        lambda: run.reported(TYPE_UNSUPPORTED, type="rcl_interfaces/msg/ParameterEvent"),
        "the report",
    )
    assert "/parameter_events" not in master.types()


@pytest.mark.parametrize("end", ["stops", "dies"])
def test_a_reader_that_fails_disturbs_nobody(bridge: Bridge, master: Master, end: str) -> None:
    run = bridge(robot=False)
    publisher = run.graph.advertise("/big", "sensor_msgs/msg/Image")
    image = zero("sensor_msgs/Image")
    image.data = np.zeros(1 << 20, np.uint8)
    run.simulation.post(
        lambda: run.simulation.schedule(
            50.0, after=lambda: publisher.publish(image), active=lambda: publisher.wanted
        )
    )
    wait_for(lambda: "/big" in master.types(), "/big")
    reader = master.python(READ, "/big")
    assert reader.stdout is not None
    assert reader.stdout.readline() == "first\n"
    os.kill(reader.pid, signal.SIGSTOP if end == "stops" else signal.SIGKILL)
    try:
        other = Subscriber(master, "/big")
        for _ in range(60):
            assert len(other.read()) > 1 << 20
        other.close()
        if end == "stops":
            wait_for(lambda: run.reported(SLOW_SUBSCRIBER, topic="/big"), "the report")
            publication = run.bridge._node.publications["/big"]
            assert sum(link._queued for link in publication.links) < 20 << 20
            assert run.reported(SLOW_SUBSCRIBER) == 1
            (count,) = run.graph.topic("/big").dropped
            assert count > 0
    finally:
        reader.kill()
        reader.communicate()
    wait_for(lambda: not run.wanted("/big"), "nobody")


def test_diagnostics_go_to_rosout(bridge: Bridge, master: Master) -> None:
    from cartwheel.errors import Diagnostic, Origin

    run = bridge(robot=False)
    origin = Origin(file="a.urdf", line=7)
    run.bridge.log(Diagnostic(severity="warning", message="said before", origin=origin))
    subscriber = Subscriber(master, "/rosout")
    early = subscriber.read()
    assert b"said before" in early
    assert b"a.urdf" in early
    run.bridge.log(Diagnostic(severity="error", message="said later"))
    later = subscriber.read()
    from cartwheel.messages.ros1 import decode_ros1

    log = decode_ros1(later, "rosgraph_msgs/Log")
    assert (log.level, log.name, log.msg) == (8, "/gazebo", "said later")
    assert message_class("rosgraph_msgs/msg/Log").__msgtype__ == log.__msgtype__
