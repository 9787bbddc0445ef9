"""Joints with which ROS or Gazebo does not load a robot, or that Gazebo drops."""

import re

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.checks import check
from cartwheel.codes.devices import PLUGIN_UNKNOWN
from cartwheel.codes.robot import (
    INERTIA_MISSING,
    LIMIT_INCOMPLETE,
    LIMIT_MISSING,
    MASS_NOT_POSITIVE,
)
from cartwheel.codes.tags import TAG_MISSING, VALUE_INVALID
from cartwheel.corpus import try_robot
from cartwheel.description import load_text

MASS = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LINK = '<link name="{name}">{mass}</link>'
JOINT = (
    '<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
    '<axis xyz="0 0 1"/>{limit}</joint>'
)
LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
SERVO = (
    '<gazebo><plugin name="s" filename="gz-sim-joint-position-controller-system">'
    "<joint_name>{name}_joint</joint_name></plugin></gazebo>"
)


def arm(folder, limit=LIMIT, kind="revolute", upper=MASS, servo="hand"):
    """A base that is fixed to the world, an upper arm, and a hand."""
    parts = [LINK.format(name="world", mass=""), LINK.format(name="base", mass=MASS)]
    parts.append(JOINT.format(name="base", kind="fixed", parent="world", limit=""))
    parts.append(LINK.format(name="upper", mass=upper))
    parts.append(JOINT.format(name="upper", kind=kind, parent="base", limit=limit))
    parts.append(LINK.format(name="hand", mass=MASS))
    parts.append(JOINT.format(name="hand", kind="revolute", parent="upper", limit=LIMIT))
    if servo:
        parts.append(SERVO.format(name=servo))
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="robot">{"".join(parts)}</robot>')
    return path


def faults(verdict):
    return [(each.test, each.code, each.source) for each in verdict.faults]


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize("servo", ["hand", ""])
def test_ros_loads_no_robot_with_a_joint_without_limit(tmp_path, kind, servo):
    verdict = try_robot(arm(tmp_path, limit="", kind=kind, servo=servo), standing=1.0)
    assert faults(verdict) == [("load", LIMIT_MISSING, "file")]
    assert not verdict.moves


@pytest.mark.parametrize(
    ("limit", "code"),
    [
        ('<limit lower="-1" upper="1" effort="10"/>', LIMIT_INCOMPLETE),
        ('<limit lower="-1" upper="1" effort="inf" velocity="1"/>', VALUE_INVALID),
        (f"{LIMIT}<dynamics/>", TAG_MISSING),
    ],
)
def test_ros_loads_no_robot_that_its_parser_refuses(tmp_path, limit, code):
    verdict = try_robot(arm(tmp_path, limit=limit), standing=1.0)
    assert faults(verdict) == [("load", code, "file")]
    assert verdict.outcome == "file"


@pytest.mark.parametrize("kind", ["continuous", "fixed", "floating"])
def test_other_joints_need_no_limit(tmp_path, kind):
    verdict = try_robot(arm(tmp_path, limit="", kind=kind, servo=""), standing=1.0)
    assert LIMIT_MISSING not in {each.code for each in verdict.faults}


@pytest.mark.parametrize("servo", ["hand", "upper"])
def test_gazebo_drops_a_driven_joint_with_the_link_that_carries_it(tmp_path, servo):
    verdict = try_robot(arm(tmp_path, upper="", servo=servo), standing=1.0)
    (fault,) = [each for each in verdict.faults if each.test == "load"]
    assert (fault.subject, fault.code) == (f"{servo}_joint", INERTIA_MISSING)
    assert verdict.outcome == "file"
    assert verdict.should_move
    assert not verdict.moves


UNKNOWN = (
    '<gazebo><plugin name="x" filename="libmy_own_drive.so"><joint>{name}_joint</joint></plugin>'
    "</gazebo>"
)


@pytest.mark.parametrize(("mass", "reason"), [("", INERTIA_MISSING), (MASS, PLUGIN_UNKNOWN)])
def test_no_plugin_moves_a_joint_that_gazebo_drops(tmp_path, mass, reason):
    """That the plugin is not supported does not matter then."""
    path = arm(tmp_path, upper=mass, servo="")
    path.write_text(path.read_text().replace("</robot>", UNKNOWN.format(name="hand") + "</robot>"))
    assert [each.code for each in try_robot(path, standing=1.0).faults] == [reason]


def test_a_link_without_mass_that_nothing_drives_is_no_fault(tmp_path):
    assert not try_robot(arm(tmp_path, upper="", servo=""), standing=1.0).faults


def test_gazebo_drops_driven_wheels_without_mass(tmp_path):
    body, wheels = cart().split('<link name="left">')
    light = re.sub("<inertial>.*?</inertial>", "", '<link name="left">' + wheels)
    verdict = try_robot(written(tmp_path, body + light, plugin()), standing=1.0)
    assert ("load", INERTIA_MISSING, "file") in faults(verdict)


@pytest.mark.parametrize(
    ("base", "lid", "upper", "fault"),
    [
        (MASS, "", MASS, False),
        # Gazebo merges the lid into the base.
        ("", MASS, MASS, False),
        ("", "", MASS, True),
        ("", "", "", True),
        (MASS.replace('"1"', '"0"'), "", MASS, True),
    ],
)
def test_gazebo_loads_nothing_on_a_base_without_mass_that_is_fixed_to_the_world(
    tmp_path, base, lid, upper, fault
):
    path = arm(tmp_path, upper=upper, servo="")
    text = path.read_text().replace(
        f'<link name="base">{MASS}</link>',
        f'<link name="base">{base}</link><link name="lid">{lid}</link><joint name="l" type="fixed">'
        '<parent link="base"/><child link="lid"/></joint>',
    )
    states = '<gazebo><plugin name="s" filename="libgazebo_ros_joint_state_publisher.so"/></gazebo>'
    path.write_text(text.replace("</robot>", f"{states}</robot>"))
    verdict = try_robot(path, standing=1.0)
    assert faults(verdict) == ([("load", INERTIA_MISSING, "file")] if fault else [])
    codes = {INERTIA_MISSING, MASS_NOT_POSITIVE}
    found = [each.values["link"] for each in check(path).findings if each.code in codes]
    assert ("base" in found) == fault


def test_a_fixed_joint_that_gazebo_keeps_merges_no_mass(tmp_path):
    kept = '<gazebo reference="l"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
    parts = (
        LINK.format(name="world", mass=""),
        LINK.format(name="base", mass=""),
        JOINT.format(name="base", kind="fixed", parent="world", limit=""),
        LINK.format(name="lid", mass=MASS),
        '<joint name="l" type="fixed"><parent link="base"/><child link="lid"/></joint>',
    )
    for more, expected in (("", []), (kept, [("base",)])):
        robot = load_text(f'<robot name="r">{"".join(parts)}{more}</robot>')
        said = [each for each in robot.diagnostics if each.code is INERTIA_MISSING]
        assert [each.values["links"] for each in said] == expected
