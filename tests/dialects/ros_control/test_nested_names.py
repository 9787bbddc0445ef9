"""ROS 1's controllers whose names are paths below the namespace of their manager."""

import time

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

import cartwheel as cw
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.corpus import try_robot
from cartwheel.dialects.ros_control.launched.names import as_named, ros1_entries

KIND = "position_controllers/JointPositionController"
SIDES = ("left", "right")


def one(joint):
    return {"type": KIND, "joint": joint}


NESTED = {
    "states": {"type": "joint_state_controller/JointStateController", "publish_rate": 10},
    "front": {side: {"lift": one(f"front_{side}_joint")} for side in SIDES},
    "back": {side: {"lift": one(f"back_{side}_joint")} for side in SIDES},
}
LIFTS = [f"{end}/{side}/lift" for end in ("front", "back") for side in SIDES]


@pytest.mark.parametrize("namespace", ["", "/bot", "elsewhere"])
def test_the_name_of_a_controller_is_its_path_in_the_namespace_of_the_manager(namespace):
    entries = ros1_entries({"bot": NESTED}, "bot.yaml", namespace)
    assert [each.name for each in entries] == ["states", *LIFTS]
    assert {each.namespace for each in entries} == {"bot"}
    assert [each.name for each in ros1_entries(NESTED, "bot.yaml")] == ["states", *LIFTS]


def test_controllers_of_another_robot_do_not_replace_those_of_the_same_name():
    content = {"two": {"a": one("x"), "c": one("z")}, "one": {"a": one("y"), "b": one("y")}}
    first = {each.name: each.namespace for each in ros1_entries(content, "f", "one")}
    assert first == {"a": "one", "b": "one", "c": "two"}
    both = [each.name for each in ros1_entries(content, "f")]
    assert both == ["two/a", "two/c", "one/a", "one/b"]


def test_a_spawner_names_controllers_with_a_part_of_their_path():
    entries = ros1_entries({"bot": NESTED}, "bot.yaml")
    assert as_named(["front/left/lift"], entries) == ("front/left/lift",)
    assert as_named(["bot/states", "/bot/front/left/lift"], entries) == ("states", LIFTS[0])
    assert as_named(["left/lift"], entries) == ("front/left/lift", "back/left/lift")
    assert as_named(["none", "/a/b"], entries) == ("none", "b")


def test_all_controllers_with_nested_names_start_and_have_their_own_topics(tmp_path):
    names = [f"{end}_{side}" for end in ("front", "back") for side in SIDES]
    body = "".join(
        beam(name, "world", axis="0 0 1") + transmission(f"{name}_joint", "Position")
        for name in names
    )
    bot = tmp_path / "bot.urdf"
    bot.write_text(robot(body, ROS1.replace(">/<", ">/bot<")))
    (tmp_path / "package.xml").write_text("<package><name>bot</name></package>")
    (tmp_path / "bot.yaml").write_text(yaml.safe_dump({"bot": NESTED}))
    (tmp_path / "bot.launch").write_text(
        '<launch><param name="robot_description" textfile="$(find bot)/bot.urdf"/>'
        '<rosparam file="$(find bot)/bot.yaml" command="load"/>'
        '<node name="m" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
        '<node name="s" pkg="controller_manager" type="spawner" ns="/bot" '
        f'args="states {" ".join(LIFTS[:3])}"/></launch>'
    )
    verdict = try_robot(bot, standing=1.0)
    assert verdict.good, verdict.faults
    # The launch file does not start the last one.
    assert verdict.spawned == ("states", *LIFTS[:3])
    assert sorted(each.controller for each in verdict.reaches) == sorted(LIFTS)
    assert all(each.arrived for each in verdict.reaches)


def test_the_topics_of_nested_controllers_contain_their_path(tmp_path):
    body = beam("beam", "world", axis="0 0 1") + transmission("beam_joint", "Position")
    bot, file = tmp_path / "bot.urdf", tmp_path / "bot.yaml"
    bot.write_text(robot(body, ROS1))
    content = {"bot": {"arm": {"lift": one("beam_joint")}, "x": {"lift": one("no_joint")}}}
    file.write_text(yaml.safe_dump(content))
    with cw.World("empty", lenient=True) as world:
        world.spawn(bot, controllers=[file])
        world.run(0.1)
        assert "/arm/lift/command" in {each.name for each in world.graph.topics()}
        assert coded(world, CONTROLLER_NOT_STARTED, controller="x/lift")


def test_many_controllers_of_two_robots_do_not_take_long():
    """CPU time. A comparison of each controller with each other one takes minutes."""
    count = 30_000
    spaces = {space: {f"{space}{n}": {"type": "a/B"} for n in range(count)} for space in "ab"}
    begin = time.thread_time()
    entries = ros1_entries(spaces, "file", "a")
    assert len(entries) == 2 * count
    assert as_named([f"x/a/a{n}" for n in range(count)], entries) == tuple(spaces["a"])
    assert time.thread_time() - begin < 10.0
