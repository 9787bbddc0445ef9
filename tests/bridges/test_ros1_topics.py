"""The cart on ROS 1 as its tools and rospy see it."""

import itertools
import json
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from tests.bridges.ros1_peers import (
    PATIENCE,
    Master,
    Subscriber,
    registered,
    simulation,
    wait_for,
)

pytestmark = pytest.mark.timeout(300)

CAMERA = "/rosbots/camera1"
# Types and sums as a Gazebo 11 on ROS Noetic has them.
PUBLISHED = {
    "/bumpers": ("gazebo_msgs/ContactsState", "acbcb1601a8e525bf72509f18e6f668d"),
    f"{CAMERA}/camera_info": ("sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214"),
    f"{CAMERA}/image_raw": ("sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743"),
    "/clock": ("rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47"),
    "/gazebo/link_states": ("gazebo_msgs/LinkStates", "48c080191eb15c41858319b4d8a609c2"),
    "/gazebo/model_states": ("gazebo_msgs/ModelStates", "48c080191eb15c41858319b4d8a609c2"),
    "/imu/data": ("sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2"),
    "/joint_states": ("sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"),
    "/odom": ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"),
    "/tf": ("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"),
}
READ = {
    "/gazebo/set_link_state": "gazebo_msgs/LinkState",
    "/gazebo/set_model_state": "gazebo_msgs/ModelState",
    "/part2_cmr/cmd_vel": "geometry_msgs/Twist",
}

LISTEN = """
import sys, json, time, rospy
rospy.init_node("listener", anonymous=True, disable_rostime=True)
topics, found = json.loads(sys.argv[1]), {}
def take(message, topic):
    found.setdefault(topic, []).append([message._connection_header["md5sum"], len(message._buff)])
for topic in topics:
    rospy.Subscriber(topic, rospy.AnyMsg, take, topic)
end = time.time() + 25
while time.time() < end and any(len(found.get(topic, [])) < 3 for topic in topics):
    time.sleep(0.02)
print(json.dumps(found))
"""
DRIVE = """
import rospy, sys, json
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
rospy.init_node("driver", disable_rostime=True)
stamps, seqs = [], []
def take(message):
    stamps.append(message.header.stamp.to_nsec())
    seqs.append(message.header.seq)
    if message.pose.pose.position.x > start[0] + 0.3:
        print(json.dumps([stamps, seqs, message.pose.pose.position.x]))
        rospy.signal_shutdown("there")
start = [rospy.wait_for_message("/odom", Odometry).pose.pose.position.x]
publisher = rospy.Publisher("/part2_cmr/cmd_vel", Twist, queue_size=1)
rospy.Subscriber("/odom", Odometry, take)
import time
end = time.time() + 25
while not rospy.is_shutdown() and time.time() < end:
    command = Twist()
    command.linear.x = 0.5
    publisher.publish(command)
    time.sleep(0.05)
"""


@pytest.fixture(scope="module")
def cart(master: Master) -> Iterator[Master]:
    """A master with a cart that was started by the command."""
    with simulation(master):
        registered(master, "/odom")
        # Services are registered after topics.
        expected = {"/imu/service", "/gazebo/spawn_urdf_model", "/gazebo/reset_world"}
        wait_for(lambda: expected <= set(master.state()[2]), "the services")
        yield master


def test_topics_and_services_are_those_of_gazebo(cart: Master) -> None:
    publishers, subscribers, services = cart.state()
    types = cart.types()
    for topic, (type_name, _) in PUBLISHED.items():
        assert publishers[topic] == ["/gazebo"]
        assert types[topic] == type_name
    for topic, type_name in READ.items():
        assert subscribers[topic] == ["/gazebo"]
        assert types[topic] == type_name
    assert {"/imu/service", "/gazebo/spawn_urdf_model", "/gazebo/reset_world"} <= set(services)
    assert cart.run("rosservice", "type", "/imu/service") == "std_srvs/Empty\n"
    assert cart.run("rosservice", "type", "/gazebo/get_loggers") == "roscpp/GetLoggers\n"


def test_every_connection_states_type_sum_and_definition(cart: Master) -> None:
    for topic, (type_name, md5) in PUBLISHED.items():
        subscriber = Subscriber(cart, topic)
        header = subscriber.header
        subscriber.close()
        assert (header["type"], header["md5sum"]) == (type_name, md5)
        assert header["callerid"] == "/gazebo"
        assert header["latching"] == "0"
        assert header["message_definition"].splitlines()


def test_rospy_receives_every_topic(cart: Master) -> None:
    listener = cart.python(LISTEN, json.dumps(list(PUBLISHED)))
    output, _ = listener.communicate(timeout=60)
    found = json.loads(output)
    assert set(found) == set(PUBLISHED)
    for topic, messages in found.items():
        assert len(messages) >= 3
        assert {md5 for md5, _ in messages} == {PUBLISHED[topic][1]}
    image = found[f"{CAMERA}/image_raw"][0][1]
    # Header, size, encoding and 320x240 pixels of three bytes.
    assert 230_400 < image < 230_400 + 200


def test_rospy_drives_the_cart_and_its_stamps_increase(cart: Master) -> None:
    driver = cart.python(DRIVE)
    output, _ = driver.communicate(timeout=60)
    stamps, seqs, x = json.loads(output)
    assert x > 0.3
    assert all(later - earlier >= 10_000_000 for earlier, later in itertools.pairwise(stamps))
    assert all(later > earlier for earlier, later in itertools.pairwise(seqs))


def test_echo_prints_what_genpy_reads(cart: Master) -> None:
    messages = list(yaml.safe_load_all(cart.run("rostopic", "echo", "-n1", "/odom")))
    assert messages[0]["header"]["frame_id"] == "odom"
    assert messages[0]["child_frame_id"] == "base_link"
    assert len(messages[0]["pose"]["covariance"]) == 36


def test_hz_is_that_of_simulation_time(cart: Master) -> None:
    watcher = subprocess.Popen(
        ["rostopic", "hz", "-w", "50", "/joint_states"],
        env={**cart.environment, "PYTHONUNBUFFERED": "1"},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert watcher.stdout is not None
        for line in watcher.stdout:
            if match := re.search(r"average rate: ([\d.]+)", line):
                assert float(match[1]) == pytest.approx(100.0, rel=0.2)
                break
        else:
            pytest.fail("no rate")
    finally:
        watcher.terminate()
        watcher.wait()


def test_services_are_called_and_fail_as_services_do(cart: Master) -> None:
    assert cart.run("rosservice", "call", "/imu/service").strip() == ""
    assert cart.run("rosservice", "call", "/gazebo/get_loggers") == (
        'loggers: \n  - \n    name: "ros.cartwheel"\n    level: "info"\n'
    )
    cart.run("rosservice", "call", "/gazebo/set_logger_level", "ros.cartwheel", "info")
    refused = cart.run(
        "rosservice", "call", "/gazebo/set_logger_level", "ros.cartwheel", "loud", check=False
    )
    assert refused == ""


def test_simulation_time_is_the_time_of_all(cart: Master) -> None:
    assert cart.run("rosparam", "get", "/use_sim_time") == "true\n"


def test_rosnode_knows_the_node(cart: Master) -> None:
    info = cart.run("rosnode", "info", "/gazebo")
    for topic, (type_name, _) in PUBLISHED.items():
        assert f" * {topic} [{type_name}]\n" in info
    assert " * /imu/service\n" in info
    assert "Pid: " in info
    assert "xmlrpc reply from" in cart.run("rosnode", "ping", "-c1", "/gazebo")


def test_a_bag_is_recorded_and_drives_the_cart(cart: Master, tmp_path: Path) -> None:
    bag = tmp_path / "drive.bag"
    topics = ("/odom", "/tf", "/imu/data", "/bumpers")
    cart.run(
        "rosbag",
        "record",
        "--duration=1.5",
        "-O",
        str(bag),
        "/odom",
        "/tf",
        "/imu/data",
        "/bumpers",
    )
    info = yaml.safe_load(cart.run("rosbag", "info", "--yaml", str(bag)))
    counts = {topic["topic"]: topic for topic in info["topics"]}
    assert set(counts) == set(topics)
    for topic, entry in counts.items():
        assert entry["type"] == PUBLISHED[topic][0]
    types = {entry["type"]: entry["md5"] for entry in info["types"]}
    assert types["gazebo_msgs/ContactsState"] == PUBLISHED["/bumpers"][1]
    assert counts["/odom"]["messages"] > 20
    before = yaml.safe_load(cart.run("rostopic", "echo", "-n1", "/odom").split("---")[0])
    commands = tmp_path / "commands.bag"
    subprocess.run(["/usr/bin/python3", "-c", WRITE, str(commands)], check=True, timeout=PATIENCE)
    cart.run("rosbag", "play", "-q", str(commands))

    def turned() -> bool:
        now = yaml.safe_load(cart.run("rostopic", "echo", "-n1", "/odom").split("---")[0])
        there, here = (pose["pose"]["pose"]["orientation"]["z"] for pose in (now, before))
        return abs(there - here) > 0.01

    wait_for(turned, "the cart to turn as the bag says")


WRITE = """
import sys, rosbag, rospy
from geometry_msgs.msg import Twist
with rosbag.Bag(sys.argv[1], "w") as bag:
    for i in range(20):
        command = Twist()
        command.angular.z = 1.0
        bag.write("/part2_cmr/cmd_vel", command, rospy.Time.from_sec(1 + i * 0.05))
"""
