"""Joints whose limits exclude the position at which they start, and limbs that yield."""

import pytest
from tests.corpus.carts import cart, plugin, written

import cartwheel
from cartwheel.codes.robot import START_OUTSIDE_LIMITS, WHEELS_OFF_GROUND
from cartwheel.corpus import try_robot

LEG = (
    '<link name="leg"><inertial><origin xyz="0 0 -0.06"/><mass value="0.05"/>'
    '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<link name="foot"><collision><origin xyz="0 0 -0.15"/><geometry><sphere radius="0.02"/>'
    "</geometry></collision></link>"
    '<joint name="ankle" type="fixed"><parent link="leg"/><child link="foot"/></joint>'
    '<joint name="hip" type="revolute"><parent link="base"/><child link="leg"/>'
    '<origin xyz="0 {y} 0.03"/><axis xyz="0 1 0"/>'
    '<limit lower="{lower}" upper="{upper}" effort="5" velocity="10"/>{more}</joint>'
)
MANAGER = '<gazebo><plugin name="c" filename="gz_ros2_control-system"/></gazebo>'


def legs(lower, upper, more=""):
    """Two legs whose feet extend below the wheels of a cart while their joints are at 0."""
    left = LEG.format(y=0.13, lower=lower, upper=upper, more=more)
    right = LEG.format(y=-0.13, lower=lower, upper=upper, more=more)
    for name in ("leg", "foot", "hip", "ankle"):
        right = right.replace(f'"{name}"', f'"right_{name}"')
    return left + right


def codes(path):
    return {each.code for each in cartwheel.check(path).findings}


@pytest.mark.parametrize(
    ("lower", "upper", "way"),
    [(0.8, 1.5, 0.8), (-1.5, -0.8, 0.8), (-1, 1, None), (0.01, 1, None), (0, 0, None)],
)
def test_a_joint_that_starts_outside_its_limits_is_reported(tmp_path, lower, upper, way):
    path = written(tmp_path, cart(), legs(lower, upper), plugin())
    found = [e for e in cartwheel.check(path).findings if e.code is START_OUTSIDE_LIMITS]
    assert [each.values["joint"] for each in found] == (["hip", "right_hip"] if way else [])
    assert all(each.severity == "info" for each in found)


@pytest.mark.parametrize(
    ("start", "manager", "reported"),
    [(1.0, MANAGER, False), (2.0, MANAGER, True), (None, MANAGER, True), (1.0, "", True)],
)
def test_the_initial_value_counts_if_a_plugin_reads_it(tmp_path, start, manager, reported):
    value = "" if start is None else f'<param name="initial_value">{start}</param>'
    control = (
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
        '</plugin></hardware><joint name="hip"><command_interface name="position"/>'
        f'<state_interface name="position">{value}</state_interface></joint></ros2_control>'
    )
    leg = LEG.format(y=0, lower=0.8, upper=1.5, more="")
    path = written(tmp_path, cart(), leg, control, manager)
    assert (START_OUTSIDE_LIMITS in codes(path)) is reported


def test_a_robot_whose_legs_fold_into_their_limits_stands_on_its_wheels(tmp_path):
    path = written(tmp_path, cart(), legs(1.2, 1.5), plugin())
    assert WHEELS_OFF_GROUND not in codes(path)
    verdict = try_robot(path, standing=2.0)
    assert verdict.stand.state == "yes"
    assert verdict.good, verdict.faults


@pytest.mark.parametrize(
    ("kind", "more", "reported"),
    [
        ("revolute", "", False),
        ("revolute", '<dynamics friction="3"/>', True),
        ("fixed", "", True),
    ],
)
def test_a_limb_that_nothing_holds_does_not_lift_the_wheels(tmp_path, kind, more, reported):
    limbs = legs(-1, 1, more).replace('type="revolute"', f'type="{kind}"')
    path = written(tmp_path, cart(), limbs, plugin())
    assert (WHEELS_OFF_GROUND in codes(path)) is reported
