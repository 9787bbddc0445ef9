"""Arguments of controllers' files that a launch file would know."""

from cartwheel.description import load_text
from cartwheel.dialects.ros_control.launch_arguments import launch_arguments

LINK = (
    '<link name="{0}"/><joint name="{0}_joint" type="fixed"><parent link="base"/>'
    '<child link="{0}"/></joint>'
)


def robot(*links, declared="", **given):
    body = "".join(LINK.format(name) for name in links)
    text = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>'
        f"{declared}{body}</robot>"
    )
    return load_text(text, arguments=given)


def pair(word="arg"):
    return {"drive": {"left": f"$({word} p)left_joint", "right": [f"$({word} p)right_joint"]}}


def test_they_are_the_robot_s_own():
    declared = '<xacro:arg name="p" default="x/"/>'
    assert launch_arguments(pair(), robot("left", "right", declared=declared)) == {"p": "x/"}
    given = robot("left", "right", declared=declared, p="y/")
    assert launch_arguments(pair(), given) == {"p": "y/"}


def test_one_that_the_xacro_lacks_is_the_prefix_that_makes_joints_of_its_words():
    assert launch_arguments(pair(), robot("one/left", "one/right")) == {"p": "one/"}
    assert launch_arguments(pair("var"), robot("left", "right")) == {"p": ""}


def test_words_that_agree_on_no_prefix_imply_nothing():
    assert launch_arguments(pair(), robot("a_left", "b_right")) == {}
    assert launch_arguments(pair(), robot("up", "down")) == {}


def test_the_prefix_of_a_frame_is_empty():
    frame = {"drive": {"base_frame_id": "$(arg f)base", "sensors": {"imu_frame": ["$(arg f)imu"]}}}
    assert launch_arguments(frame, robot("left")) == {"f": ""}
    declared = '<xacro:arg name="f" default="x/"/>'
    assert launch_arguments(frame, robot("left", declared=declared)) == {"f": "x/"}
    # A value that is not a prefix, and a word that is not the name of a frame, are unknown.
    assert launch_arguments({"drive": {"base_frame_id": "$(arg f)"}}, robot("left")) == {}
    assert launch_arguments({"drive": {**frame["drive"], "r": "$(arg f)1"}}, robot("left")) == {}
