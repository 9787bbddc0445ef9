"""Drive plugins that are left out, beside drives that receive other commands."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written

from cartwheel.codes.robot import DRIVE_JOINT_UNKNOWN, WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import PLUGIN_LEFT_OUT
from cartwheel.corpus import try_robot
from cartwheel.corpus.drive_topics import drives_on
from cartwheel.description import load_robot

LOST = plugin().replace("left_joint", "no_such_joint")


def test_a_plugin_that_is_left_out_does_not_explain_the_drive_of_a_controller(tmp_path):
    """The separation is that of wheels further apart, so the base turns too fast."""
    path = written(tmp_path, cart(), controlled(tmp_path, 0.3), LOST)
    faults = [(each.test, each.code) for each in try_robot(path, standing=1.0).faults]
    assert faults == [("plugin", PLUGIN_LEFT_OUT), ("turn", WHEEL_SEPARATION_MISMATCH)]


@pytest.mark.parametrize(
    ("tags", "own"),
    [
        ("", True),
        ("<commandTopic>cmd_vel</commandTopic>", True),
        ("<commandTopic>bot/drive</commandTopic>", False),
        ("<ros><remapping>cmd_vel:=drive</remapping></ros>", True),
    ],
)
def test_it_explains_only_the_drive_on_its_topic(tmp_path, tags, own):
    lost = LOST.replace("</legacyMode>", f"</legacyMode>{tags}")
    robot = load_robot(written(tmp_path, cart(), lost))
    name = robot.plugins[0].filename
    found = [
        PLUGIN_LEFT_OUT.diagnostic("", values={"plugin": name}),
        DRIVE_JOINT_UNKNOWN.diagnostic("", values={"tag": "leftJoint", "joint": "no_such_joint"}),
    ]
    for each in found:
        assert drives_on(each, "/cmd_vel", robot, ["base"]) == own
        assert drives_on(each, "/bot/cmd_vel", robot, ["base"]) == own
        assert drives_on(each, "/bot/drive", robot, ["base"]) == (not own or "drive" in tags)
        assert not drives_on(each, "/base/cmd_vel", robot, ["base"])
    other = DRIVE_JOINT_UNKNOWN.diagnostic("", values={"tag": "leftJoint", "joint": "other"})
    assert not drives_on(other, "/cmd_vel", robot, [])
