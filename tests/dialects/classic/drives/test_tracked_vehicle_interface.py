"""ROS topics of Gazebo Classic's vehicles on tracks: commands and odometry."""

import math

import pytest
from tests.dialects.classic.drives.test_tracked_vehicle import (
    HEIGHT,
    SEPARATION,
    Vehicle,
    crawler,
    wheeled,
)

from cartwheel.codes import devices
from cartwheel.description import load_text

TEXTS = {"surfaces": crawler, "wheels": wheeled}
TOPIC = "/cmd_vel"


def interface(tags="", topic=TOPIC):
    return (
        '<plugin name="interface" filename="libgazebo_ros_tracked_vehicle_interface.so">'
        f"<commandROSTopic>{topic}</commandROSTopic><commandIGNTopic>~/cmd_vel_twist"
        f"</commandIGNTopic><robotBaseFrame>base</robotBaseFrame>{tags}</plugin>"
    )


def with_interface(text, plugin, *, first=False):
    """A vehicle with the interface before or after its own plugin."""
    mark = '<plugin name="tracks"' if first else "</model>"
    return text.replace(mark, plugin + mark)


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("kind", TEXTS)
def test_the_vehicle_follows_its_commands(make, kind, first):
    made = Vehicle(make, with_interface(TEXTS[kind](), interface(), first=first), TOPIC)
    forward, turn = made.driven(0.5)
    assert forward == pytest.approx(0.5, rel=0.01)
    assert turn == pytest.approx(0.0, abs=0.01)
    assert made.driven(turn=0.5)[1] > 0.1
    assert made.driven(turn=-0.5)[1] < -0.1


def test_the_vehicle_keeps_its_own_topic(make):
    made = Vehicle(make, with_interface(crawler(), interface()))
    assert made.driven(0.4)[0] == pytest.approx(0.4, rel=0.01)


@pytest.mark.parametrize(
    ("tags", "topic"),
    [
        ("", "/cmd"),
        ("<robotNamespace>tank</robotNamespace>", "/tank/cmd"),
        ("<ros><namespace>a</namespace></ros>", "/a/cmd"),
    ],
)
def test_its_topics_are_in_its_namespace(make, tags, topic):
    made = Vehicle(make, with_interface(crawler(), interface(tags, "cmd")), topic)
    assert made.driven(0.4)[0] == pytest.approx(0.4, rel=0.01)


def test_the_odometry_is_the_truth(make, read):
    made = Vehicle(make, with_interface(crawler(), interface()), TOPIC)
    made.driven(0.4, 0.3)
    *_, last = read(made.world, "/odom", 1.0)
    pose = last.pose.pose
    yaw = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
    assert pose.position.x == pytest.approx(made.model.pose.x, abs=0.01)
    assert math.remainder(yaw - made.model.pose.yaw, 2 * math.pi) == pytest.approx(0.0, abs=0.01)
    assert last.pose.covariance[[0, 7, 14, 35]].tolist() == [1e-5, 1e-5, 1e12, 1e-3]
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base")


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize("separation", [SEPARATION, 2 * SEPARATION])
def test_the_dead_reckoning_takes_the_speeds_of_the_tracks(make, read, kind, separation):
    """The tracks move as for wheels that do not slip with a quarter of the efficiency."""
    tags = (
        "<odometrySource>encoder</odometrySource>"
        f"<tracks_separation>{separation}</tracks_separation>"
    )
    text = TEXTS[kind]("<steering_efficiency>0.25</steering_efficiency>")
    made = Vehicle(make, with_interface(text, interface(tags)), TOPIC)
    made.driven(0.2, 0.3)
    *_, last = read(made.world, "/odom", 1.0)
    twist = last.twist.twist
    assert twist.linear.x == pytest.approx(0.2)
    assert twist.angular.z == pytest.approx(0.3 / 0.25 * SEPARATION / separation)
    made.world.reset()
    *_, last = read(made.world, "/odom", 0.5)
    assert last.pose.pose.position.x == 0.0


@pytest.mark.parametrize(
    ("tags", "odometry", "transform"),
    [
        ("", True, True),
        ("<publishOdomTF>false</publishOdomTF>", True, False),
        ("<publishTf>false</publishTf>", False, False),
    ],
)
def test_what_it_publishes(make, tags, odometry, transform):
    made = Vehicle(make, with_interface(crawler(), interface(tags)), TOPIC)
    topics = {topic.name for topic in made.world.graph.topics()}
    assert ("/odom" in topics, "/tf" in topics) == (odometry, transform)


def test_without_a_vehicle_it_is_idle(make):
    head, _, _ = crawler().partition('<plugin name="tracks"')
    world = make.world()
    world.spawn(load_text(f"{head}{interface()}</model></sdf>", file="c.sdf"), z=HEIGHT)
    assert [each.code for each in world.diagnostics if each.severity == "warning"] == [
        devices.PLUGIN_IDLE
    ]
    world.publish(TOPIC, linear_x=0.4)
    world.run(0.1)
