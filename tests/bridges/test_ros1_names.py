"""Names of the node and of what it offers: remapped, in namespaces, as every node does."""

import itertools
import json

import pytest
from tests.bridges.conftest import Bridged
from tests.bridges.ros1_peers import Master, Subscriber, registered, simulation
from tests.coded import raises

from cartwheel.bridges.ros1.names import Arguments, NodeNames
from cartwheel.codes.wires import ROS_ARGUMENT_INVALID, ROS_NODE_NAME_INVALID
from cartwheel.description import load_robot
from cartwheel.errors import Code

pytestmark = pytest.mark.timeout(300)


def names(*words: str, node: str = "gazebo") -> NodeNames:
    return NodeNames(node, Arguments.parse(words))


def test_words_are_sorted_by_their_first_letters() -> None:
    found = Arguments.parse(["__name:=sim", "_rate:=50", "_on:=true", "odom:=/truth", "_l:=[1, 2]"])
    assert found.special == {"__name": "sim"}
    assert found.parameters == {"rate": 50, "on": True, "l": [1, 2]}
    assert found.remappings == {"odom": "/truth"}


@pytest.mark.parametrize(
    ("words", "node", "odom"),
    [
        ((), "/gazebo", "/odom"),
        (("__name:=sim",), "/sim", "/odom"),
        (("__ns:=lab",), "/lab/gazebo", "/lab/odom"),
        (("__ns:=/lab/left/", "__name:=sim"), "/lab/left/sim", "/lab/left/odom"),
        (("odom:=truth",), "/gazebo", "/truth"),
        (("/odom:=/a/b",), "/gazebo", "/a/b"),
        (("__ns:=lab", "odom:=truth"), "/lab/gazebo", "/lab/truth"),
        (("__ns:=lab", "/odom:=/truth"), "/lab/gazebo", "/lab/odom"),
        (("odom:=~here",), "/gazebo", "/gazebo/here"),
    ],
)
def test_names_resolve(words: tuple[str, ...], node: str, odom: str) -> None:
    found = names(*words)
    assert (found.node, found.outer("/odom")) == (node, odom)


def test_some_names_are_everybodys_and_some_the_nodes_own() -> None:
    found = names("__ns:=lab", "__name:=sim")
    assert found.outer("/clock") == "/clock"
    assert found.outer("/tf") == "/tf"
    assert found.outer("/gazebo/model_states") == "/lab/sim/model_states"
    assert found.private("rate") == "/lab/sim/rate"
    assert found.parameter("/gazebo/time_step") == "/lab/sim/time_step"
    assert found.parameter("/robot_description") == "/robot_description"
    assert names("/tf:=/robot/tf").outer("/tf") == "/robot/tf"


def test_the_environment_gives_a_namespace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "lab")
    assert names().node == "/lab/gazebo"
    assert names("__ns:=/").node == "/gazebo"


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("__name:=a b",), ROS_NODE_NAME_INVALID),
        (("__name:=1st",), ROS_NODE_NAME_INVALID),
        (("__ns:=a b",), ROS_NODE_NAME_INVALID),
        (("odom:=a b",), ROS_ARGUMENT_INVALID),
        (("odom:=" + 60 * "a" + "!",), ROS_ARGUMENT_INVALID),
        (("odom",), ROS_ARGUMENT_INVALID),
    ],
)
def test_names_that_ros_refuses_are_refused(words: tuple[str, ...], code: Code) -> None:
    with raises(code):
        names(*words)


def test_a_command_takes_what_ros_nodes_take(master: Master) -> None:
    words = ("__name:=sim", "__log:=/tmp/x.log", "_rate:=3", "/clock:=/time", "tf:=moved")
    with simulation(master, "empty.world", *words) as process:
        registered(master, "/time")
        assert master.state()[0]["/time"] == ["/sim"]
        assert master.api.getParam("/test", "/sim/rate")[2] == 3
        assert "/sim/model_states" in master.types()
        assert process.poll() is None


CLOCK = """
import rospy, json, sys
from rosgraph_msgs.msg import Clock
rospy.init_node("watcher", disable_rostime=True)
times = []
rospy.Subscriber("/clock", Clock, lambda message: times.append(message.clock.to_nsec()))
import time
end = time.time() + 20
while len(times) < 5 and time.time() < end:
    time.sleep(0.01)
print(json.dumps(times))
"""


def test_the_clock_has_the_rate_of_the_parameter(master: Master) -> None:
    with simulation(master, "empty.world", "_pub_clock_frequency:=20"):
        registered(master)
        output, _ = master.python(CLOCK).communicate(timeout=120)
    times = json.loads(output)
    assert [later - sooner for sooner, later in itertools.pairwise(times)] == [50_000_000] * (
        len(times) - 1
    )


def test_two_carts_have_their_own_names(master: Master, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", master.uri)
    run = Bridged(False, "gazebo", ())
    for name in ("left", "right"):
        run.session.spawn(load_robot("rosbots.xacro"), name=name, namespace=name)
    topics = {topic.name for topic in run.graph.topics()}
    assert {"/left/imu/data", "/right/imu/data"} <= topics
    run.start()
    try:
        for topic in topics:
            registered(master, topic)
        left = Subscriber(master, "/left/imu/data")
        assert left.header["topic"] == "/left/imu/data"
        left.read()
        assert run.wanted("/left/imu/data")
        assert not run.wanted("/right/imu/data")
        left.close()
    finally:
        run.close()
