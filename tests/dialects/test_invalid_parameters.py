"""Plugins with parameters that are invalid, or that contain more than a number."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.checks.checking import check
from cartwheel.codes.devices import PLUGIN_PARAMETER_INVALID, PLUGIN_PARAMETER_NOT_SINGLE
from cartwheel.codes.running import PLUGIN_LEFT_OUT
from cartwheel.codes.tags import TEXT_AFTER_NUMBER
from cartwheel.errors import PluginError

_ROBOT = """<robot name="cart"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 2"/><geometry><sphere radius="2"/></geometry></collision></link><gazebo>
<plugin name="truth" filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName>
<topicName>truth</topicName>{tag}</plugin>
<plugin name="other" filename="libgazebo_ros_p3d.so">
<bodyName>base</bodyName><topicName>other</topicName><updateRate>20</updateRate></plugin>
</gazebo></robot>"""


def _file(folder: Path, tag: str) -> Path:
    file = folder / "cart.urdf"
    file.write_text(_ROBOT.format(tag=tag))
    return file


def _published(world: cw.World, topic: str, seconds: float) -> int:
    mailbox = world.mailbox(topic, size=100)
    world.run(seconds)
    return len(mailbox.drain())


@pytest.mark.parametrize(
    "tag",
    [
        "<updateRate>fast</updateRate>",
        "<updateRate>2e</updateRate>",
        "<updateRate>0x10</updateRate>",
        "<updateRate>-5</updateRate>",
        "<gaussianNoise>-0.1</gaussianNoise>",
        "<rpyOffsets>0 0</rpyOffsets>",
    ],
)
def test_the_plugin_is_left_out_and_the_robot_loads(tag, tmp_path: Path):
    file = _file(tmp_path, tag)
    with cw.World("empty", lenient=True) as world:
        world.spawn(file)
        (found,) = [each for each in world.diagnostics if each.severity == "error"]
        assert found.code is PLUGIN_LEFT_OUT
        assert found.values["plugin"] == "libgazebo_ros_p3d.so"
        assert found.values["cause"] == PLUGIN_PARAMETER_INVALID.number
        assert str(found.origin).endswith("cart.urdf:5")
        assert _published(world, "/other", 1.0) == 21
        assert "/truth" not in {topic.name for topic in world.graph.topics()}
    with cw.World("empty") as world, raises(PLUGIN_PARAMETER_INVALID, PluginError):
        world.spawn(file)
    (found,) = check(file).findings
    assert found.code is PLUGIN_PARAMETER_INVALID
    assert found.severity == "error"
    assert str(found.origin).endswith("cart.urdf:5")


@pytest.mark.parametrize(
    ("text", "code", "used"),
    [
        ("30*2", TEXT_AFTER_NUMBER, "30"),
        ("30Hz", TEXT_AFTER_NUMBER, "30"),
        ("30,5", TEXT_AFTER_NUMBER, "30"),
        ("3e1 per second", TEXT_AFTER_NUMBER, "3e1"),
        ("30.0.1", TEXT_AFTER_NUMBER, "30.0"),
        ("30 20", PLUGIN_PARAMETER_NOT_SINGLE, "30"),
    ],
)
def test_text_after_a_number_is_ignored_as_in_gazebo(text, code, used, tmp_path: Path):
    file = _file(tmp_path, f"<updateRate>{text}</updateRate>")
    with cw.World("empty") as world:
        world.spawn(file)
        (found,) = [each for each in world.diagnostics if each.severity == "warning"]
        assert found.code is code
        assert used in (found.values.get("used"), found.values.get("value"))
        assert str(found.origin).endswith("cart.urdf:5")
        assert _published(world, "/truth", 1.0) == 31
    (found,) = check(file).findings
    assert (found.code, found.severity) == (code, "warning")
    assert str(found.origin).endswith("cart.urdf:5")


def test_decimals_of_a_whole_number_are_ignored(make):
    world = make.world(
        make.sdf(
            '<model name="hand"><link name="base"/><plugin name="g" '
            'filename="libgazebo_grasp_fix.so"><max_grip_count>7.9</max_grip_count></plugin>'
            "</model>"
        )
    )
    (found,) = coded(world, TEXT_AFTER_NUMBER)
    assert found.values["used"] == "7"


def test_text_after_a_vector_is_ignored(tmp_path: Path):
    file = _file(tmp_path, "<xyzOffsets>1 2 3m</xyzOffsets>")
    with cw.World("empty") as world:
        world.spawn(file)
        (found,) = coded(world, TEXT_AFTER_NUMBER)
        assert found.values["used"] == "1 2 3"
        mailbox = world.mailbox("/truth")
        world.run(0.1)
        position = mailbox.drain()[-1].pose.pose.position
        assert (position.x, position.y) == pytest.approx((1, 2))


_CART = """<robot name="cart"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
{wheels}<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
<odometrySource>ENCODER</odometrySource></plugin></gazebo></robot>"""
_WHEEL = """<link name="{side}"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{side}_joint" type="continuous"><parent link="base"/><child link="{side}"/>
<axis xyz="0 1 0"/></joint>"""


def test_an_unknown_word_is_replaced_by_the_default_as_in_gazebo(tmp_path: Path):
    """The utilities of gazebo_plugins warn, and keep the default: the position in the world."""
    file = tmp_path / "cart.urdf"
    wheels = "".join(_WHEEL.format(side=side) for side in ("left", "right"))
    file.write_text(_CART.format(wheels=wheels))
    with cw.World("empty") as world:
        model = world.spawn(file)
        (found,) = coded(world.diagnostics, PLUGIN_PARAMETER_INVALID)
        assert (found.severity, found.values["used"]) == ("warning", "world")
        assert 'Did you mean "encoder"?' in str(found.hint)
        model.pose = replace(model.pose, position=(5.0, 0.0, 0.0))
        odometry = world.mailbox("/odom", size=100)
        world.run(0.1)
        (*_, last) = odometry.drain()
        assert last.pose.pose.position.x == pytest.approx(5.0, abs=0.01)
