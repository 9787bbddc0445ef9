"""Drive plugins that receive the same commands, which drive a robot together."""

import pytest
from tests.corpus.carts import written

import cartwheel
from cartwheel.codes.robot import SKID_STEERING, WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot

BASE = (
    '<link name="base">'
    '<inertial><mass value="8"/><inertia ixx="0.2" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.5 0.25 0.06"/></geometry></collision></link>'
)
WHEEL = (
    '<link name="{name}">'
    '<inertial><mass value="0.4"/><inertia ixx="1e-3" iyy="1e-3" izz="2e-3" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>'
    '</link><joint name="{name}_joint" type="continuous"><parent link="base"/>'
    '<child link="{name}"/><origin xyz="{x} {y} -0.02" rpy="-1.5708 0 0"/>'
    '<axis xyz="0 0 1"/></joint>'
)
DRIVE = (
    '<gazebo><plugin name="{end}" filename="libgazebo_ros_diff_drive.so">'
    "<left_joint>{end}_left_joint</left_joint><right_joint>{end}_right_joint</right_joint>"
    "<wheel_separation>{apart}</wheel_separation><wheel_diameter>0.2</wheel_diameter>"
    "<max_wheel_torque>20</max_wheel_torque>{tags}</plugin></gazebo>"
)
ELSEWHERE = "<command_topic>rear</command_topic>"
REMAPPED = "<ros><remapping>cmd_vel:=rear</remapping></ros>"
SPACED = "<ros><namespace>rear</namespace></ros>"


def cart(apart=(0.4, 0.4), tags=("", "")):
    """A cart with a drive plugin for each of its two axles."""
    wheels = "".join(
        WHEEL.format(name=f"{end}_{side}", x=x, y=y)
        for end, x in (("front", 0.18), ("back", -0.18))
        for side, y in (("left", 0.2), ("right", -0.2))
    )
    drives = (
        "\n" + DRIVE.format(end=end, apart=each, tags=more)
        for end, each, more in zip(("front", "back"), apart, tags, strict=True)
    )
    return BASE + wheels + "".join(drives)


def found(path, code):
    return [each for each in cartwheel.check(path).findings if each.code is code]


def test_plugins_on_one_topic_skid_as_one_plugin_does(tmp_path):
    path = written(tmp_path, cart())
    sliding = found(path, SKID_STEERING)
    assert [each.values["joint"] for each in sliding] == ["front_left_joint"] * 2
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("turn", SKID_STEERING, "file")
    (drive,) = verdict.drives
    assert sliding[0].values["ratio"] == pytest.approx(1.0 + drive.error_turn, abs=0.07)


def test_a_wheel_separation_that_compensates_for_sliding_is_no_mismatch(tmp_path):
    fits = found(written(tmp_path, cart()), SKID_STEERING)[0].values["fits"]
    path = written(tmp_path, cart(apart=(fits, fits)))
    assert not found(path, SKID_STEERING)
    assert not found(path, WHEEL_SEPARATION_MISMATCH)
    assert try_robot(path, standing=1.0).good


@pytest.mark.parametrize("tags", [ELSEWHERE, REMAPPED, SPACED])
def test_plugins_on_different_topics_do_not_drive_together(tmp_path, tags):
    assert not found(written(tmp_path, cart(tags=("", tags))), SKID_STEERING)


@pytest.mark.parametrize("tags", [ELSEWHERE, REMAPPED, SPACED])
def test_the_same_topic_may_be_stated_in_any_way(tmp_path, tags):
    assert found(written(tmp_path, cart(tags=(tags, tags))), SKID_STEERING)


def test_plugins_with_different_separations_contradict_each_other(tmp_path):
    path = written(tmp_path, cart(apart=(0.4, 0.6)))
    assert not found(path, SKID_STEERING)
    assert found(path, WHEEL_SEPARATION_MISMATCH)
