"""Rules learn from the dialects' tables what the tags of a plugin mean."""

import pytest

from cartwheel.checks import plugin_tags

DIFF_DRIVE = "libgazebo_ros_diff_drive.so"
WHEELS = ("left_wheel", "right_wheel")
UNKNOWN = "libsomething_of_ours.so"


def test_a_tag_has_the_role_that_its_plugin_declares():
    assert plugin_tags.tags_with(DIFF_DRIVE, *WHEELS) == {
        "leftJoint", "left_joint", "rightJoint", "right_joint",
    }  # fmt: skip
    assert plugin_tags.tags_with(DIFF_DRIVE, "frame") == {"robotBaseFrame", "robot_base_frame"}
    assert plugin_tags.links_in("libgazebo_ros_imu.so") == {"bodyName", "body_name", "frame_name"}


def test_a_value_in_hertz_is_a_rate():
    assert plugin_tags.tags_with(DIFF_DRIVE, "rate") == {"updateRate", "update_rate"}


def test_tags_of_an_unknown_plugin_mean_what_they_mean_elsewhere():
    assert {"bodyName", "linkName"} <= plugin_tags.links_in(UNKNOWN)
    assert "frame_name" in plugin_tags.tags_with(UNKNOWN, "frame")
    assert "frame_name" not in plugin_tags.links_in(UNKNOWN)
    assert "leftJoint" not in plugin_tags.joints_in(UNKNOWN)


def test_no_size_of_an_unknown_plugin_is_assumed():
    assert plugin_tags.roles(UNKNOWN) == ()
    roles = plugin_tags.roles("libour_diff_drive.so")
    assert {each.role for each in roles} == set(WHEELS)


def test_an_unknown_joint_of_a_mimic_plugin_is_reported(bench, spoil):
    mimic = (
        '<gazebo><plugin name="m" filename="libroboticsgroup_gazebo_mimic_joint_plugin.so">'
        "<joint>arm_joint</joint><mimicJoint>arm_jiont</mimicJoint></plugin></gazebo></robot>"
    )
    (finding,) = bench.find(spoil(("</robot>", mimic)), "plugin-joint-unknown")
    assert finding.values == {"tag": "mimicJoint", "joint": "arm_jiont"}


@pytest.mark.parametrize(("torque", "count"), [("0", 1), ("2", 0)])
def test_a_torque_of_zero_is_reported_by_the_spelling_that_gazebo_reads(
    torque, count, bench, spoil
):
    text = spoil(("<wheelTorque>2</wheelTorque>", f"<wheelTorque>{torque}</wheelTorque>"))
    assert len(bench.find(text, "effort-zero")) == count
    text = spoil(("<wheelTorque>2</wheelTorque>", f"<torque>{torque}</torque>"))
    assert not bench.find(text, "effort-zero")
    assert len(bench.find(text, "plugin-parameter-obsolete")) == 1


@pytest.mark.parametrize(("torque", "count"), [("5", 0), ("5.0", 0), ("4", 1)])
def test_an_ignored_torque_that_is_the_default_changes_nothing(torque, count, bench, spoil):
    text = spoil(("<wheelTorque>2</wheelTorque>", f"<torque>{torque}</torque>"))
    assert len(bench.find(text, "plugin-parameter-obsolete")) == count
