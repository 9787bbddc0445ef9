"""Topics that two models use although each expects to be the only one."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes.graph import TOPICS_SHARED
from cartwheel.component.sharing import shared_topics
from cartwheel.graph import TWIST, Graph

CART = "rosbots.xacro"
LINK = """<link name="{link}"><inertial><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
ARM = (
    '<robot name="arm">'
    + LINK.format(link="base")
    + LINK.format(link="hand")
    + """<joint name="{joint}" type="revolute"><parent link="base"/><child link="hand"/>
  <limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
<gazebo><plugin name="states" filename="libgazebo_ros_joint_state_publisher.so">
  <jointName>{joint}</jointName></plugin></gazebo></robot>"""
)
LASER = (
    '<robot name="post">'
    + LINK.format(link="base")
    + """<gazebo reference="base"><sensor type="ray" name="laser"><update_rate>5</update_rate>
  <ray><scan><horizontal><samples>3</samples><min_angle>-1</min_angle><max_angle>1</max_angle>
  </horizontal></scan><range><min>0.1</min><max>5</max></range></ray>
  <plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>{topic}</topicName>
  <frameName>base</frameName></plugin></sensor></gazebo></robot>"""
)
FOLLOWER = """<sdf version="1.6"><model name="follower"><link name="base"><inertial><mass>1</mass>
  </inertial></link><plugin name="move" filename="libgazebo_ros_planar_move.so">
  <commandTopic>{command}</commandTopic><odometryTopic>{odometry}</odometryTopic>
  <odometryFrame>odom</odometryFrame><robotBaseFrame>base</robotBaseFrame></plugin></model></sdf>"""


def found(world: cw.World) -> list[dict[str, Any]]:
    return [dict(each.values) for each in coded(world, TOPICS_SHARED)]


def test_two_robots_without_namespaces_are_reported_once() -> None:
    with cw.World("empty") as world:
        world.spawn(CART, name="left")
        assert found(world) == []
        world.spawn(CART, name="right", y=2.0)
        (one,) = found(world)
        assert (one["model"], one["other"]) == ("right", "left")
        assert one["subscribed"] == ("/part2_cmr/cmd_vel",)
        assert {"/odom", "/imu/data", "/joint_states"} <= set(one["published"])
        assert not {"/tf", "/clock"} & set(one["published"])
        assert [each.severity for each in coded(world, TOPICS_SHARED)] == ["warning"]
        world.run(0.1)
        world.reset()
        # The same pair again.
        world.model("right").delete()
        world.spawn(CART, name="right", y=2.0)
        assert len(found(world)) == 1
        # Another robot with a name that was used before.
        world.spawn(CART, name="third", namespace="third", y=4.0)
        assert len(found(world)) == 1
        world.model("third").delete()
        world.spawn(CART, name="third", y=4.0)
        assert [(each["model"], each["other"]) for each in found(world)] == [
            ("right", "left"),
            ("third", "left"),
        ]


def test_namespaces_separate_robots() -> None:
    with cw.World("empty", strict=True, ignore=["CW6"]) as world:
        world.spawn(CART, name="left", namespace="left", frame_prefix="left")
        world.spawn(CART, name="right", namespace="right", frame_prefix="right", y=2.0)
        assert found(world) == []


def test_models_that_are_spawned_together_are_compared() -> None:
    with cw.World("empty") as world:
        with world.spawning():
            for number in range(3):
                world.spawn(CART, name=f"cart_{number}", y=2.0 * number)
        assert [(each["model"], each["other"]) for each in found(world)] == [
            ("cart_1", "cart_0"),
            ("cart_2", "cart_0"),
        ]


def test_models_of_a_world_are_compared() -> None:
    models = "".join(
        FOLLOWER.format(command="cmd_vel", odometry=f"odom_{name}")
        .replace('"follower"', f'"{name}"')
        .partition('<sdf version="1.6">')[2]
        .partition("</sdf>")[0]
        for name in ("one", "two")
    )
    with cw.World(f'<sdf version="1.6"><world name="pair">{models}</world></sdf>') as world:
        (each,) = found(world)
        assert (each["model"], each["other"]) == ("two", "one")
        assert (each["published"], each["subscribed"]) == ((), ("/cmd_vel",))


def test_joint_states_may_be_shared_by_robots_with_different_joints() -> None:
    with cw.World("empty") as world:
        world.spawn(ARM.format(joint="elbow"), name="one")
        world.spawn(ARM.format(joint="wrist"), name="two", y=2.0)
        assert found(world) == []
        world.spawn(ARM.format(joint="elbow"), name="three", y=4.0)
        (each,) = found(world)
        assert (each["other"], each["published"]) == ("one", ("/joint_states",))


def test_a_model_may_follow_another_one() -> None:
    graph = Graph()
    graph.advertise("/target", TWIST)
    description = SimpleNamespace(joints=(), origin=None)
    parts: Any = {
        "leader": SimpleNamespace(
            published={"/target", "/gone"}, subscribed=set(), description=description
        ),
        "follower": SimpleNamespace(
            published={"/gone"}, subscribed={"/target"}, description=description
        ),
    }
    assert list(shared_topics(parts, ["follower"], graph)) == []
    parts["other"] = parts["follower"]
    ((name, other, warning),) = shared_topics(parts, ["other"], graph)
    assert (name, other) == ("other", "follower")
    assert warning.values["subscribed"] == ("/target",)
    assert list(shared_topics(parts, ["follower"], graph)) == []


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [("scan", "scan", [("/scan",)]), ("scan", "front/scan", [])],
)
def test_two_lasers(first: str, second: str, expected: list[tuple[str, ...]]) -> None:
    with cw.World("empty") as world:
        world.spawn(LASER.format(topic=first), name="one")
        world.spawn(LASER.format(topic=second), name="two", y=2.0)
        assert [each["published"] for each in found(world)] == expected


def test_strict_refuses_the_second_robot() -> None:
    with cw.World("empty", strict=True, ignore=["CW510"]) as world:
        world.spawn(CART, name="left")
        with raises(TOPICS_SHARED, model="right", other="left"):
            world.spawn(CART, name="right", y=2.0)
        assert "right" not in world.models
    with cw.World("empty", strict=True, ignore=["CW510", "CW735"]) as world:
        world.spawn(CART, name="left")
        world.spawn(CART, name="right", y=2.0)
        assert found(world) == []


def test_topics_of_the_world_are_common_to_its_models() -> None:
    hull = (
        '<model name="{name}"><pose>0 {y} 1 0 0 0</pose><link name="hull"><inertial><mass>1</mass>'
        '</inertial></link><plugin name="water" filename="gz-sim-hydrodynamics-system">'
        "<link_name>hull</link_name></plugin></model>"
    )
    sea = (
        '<sdf version="1.9"><world name="sea"><gravity>0 0 0</gravity>'
        '<plugin name="pushes" filename="gz-sim-apply-link-wrench-system"/>'
        f"{hull.format(name='one', y=0)}{hull.format(name='two', y=5)}</world></sdf>"
    )
    with cw.World(sea) as world:
        topics = {each.name for each in world.session.graph.topics()}
        assert {"/ocean_current", "/world/sea/wrench"} <= topics
        assert found(world) == []
