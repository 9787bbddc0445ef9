"""Mimic joints whose limits exclude the positions of their leaders."""

import pytest

import cartwheel
from cartwheel.codes.robot import MIMIC_OUT_OF_LIMITS

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def joint(name, limits, mimic="", kind="revolute"):
    limit = f'<limit {limits} effort="1" velocity="1"/>' if limits else ""
    return (
        f'<link name="{name}_link">{BODY}</link><joint name="{name}" type="{kind}">'
        f'<parent link="base"/><child link="{name}_link"/><axis xyz="0 1 0"/>{limit}{mimic}</joint>'
    )


def found(tmp_path, *joints):
    path = tmp_path / "robot.urdf"
    base = f'<link name="base">{BODY}</link>'
    path.write_text(f'<robot name="robot">{base}{"".join(joints)}</robot>')
    return [each for each in cartwheel.check(path).findings if each.code is MIMIC_OUT_OF_LIMITS]


def mimic(multiplier, offset=0, leader="lead"):
    return f'<mimic joint="{leader}" multiplier="{multiplier}" offset="{offset}"/>'


@pytest.mark.parametrize(
    ("limits", "multiplier", "offset", "targets"),
    [
        ('lower="0" upper="0.8"', -1, 0, (-0.8, 0.0)),
        ('lower="-0.8" upper="0"', -1, 0, None),
        ('lower="0" upper="0.8"', -1, 0.8, None),
        ('lower="0" upper="0.8"', 1.5, 0, (0.0, 1.2)),
        # 1.5 % more than the range
        ('lower="0" upper="0.788"', 1, 0, None),
        # Placeholders: the leader limits the joint.
        ('lower="0" upper="0"', 1, 0, None),
        ('lower="0.5" upper="1"', 0, 0.4, (0.4, 0.4)),
    ],
)
def test_targets_outside_the_limits_are_reported(tmp_path, limits, multiplier, offset, targets):
    lead = joint("lead", 'lower="0" upper="0.8"')
    reported = found(tmp_path, lead, joint("follow", limits, mimic(multiplier, offset)))
    assert len(reported) == (targets is not None)
    if targets is not None:
        values = reported[0].values
        assert (values["joint"], values["leader"]) == ("follow", "lead")
        assert (values["lowest"], values["highest"]) == pytest.approx(targets)


def test_a_leader_without_limits_is_as_limited_as_its_own_leader(tmp_path):
    first = joint("lead", 'lower="0" upper="0.8"')
    middle = joint("middle", "", mimic(2), kind="continuous")
    fits = joint("last", 'lower="0" upper="0.8"', mimic(0.5, leader="middle"))
    assert not found(tmp_path, first, middle, fits)
    (reported,) = found(tmp_path, first, middle, fits.replace('multiplier="0.5"', 'multiplier="1"'))
    assert reported.values["highest"] == pytest.approx(1.6)
    endless = joint("lead", "", kind="continuous")
    (reported,) = found(tmp_path, endless, joint("follow", 'lower="0" upper="1"', mimic(1)))
    assert reported.values["highest"] is None


def test_limits_that_stand_in_for_none_are_not_reported(tmp_path):
    endless = joint("lead", "", kind="continuous")
    assert not found(tmp_path, endless, joint("follow", 'lower="-1e9" upper="1e9"', mimic(1)))
    assert found(tmp_path, endless, joint("follow", 'lower="-9" upper="1e9"', mimic(1)))


def test_a_gear_is_not_reported(tmp_path):
    """Both of its joints stop where one of them does."""
    turns = "<limit><lower>{0}</lower><upper>{1}</upper></limit>"
    hinge = (
        '<link name="{0}"/><joint name="{0}_joint" type="revolute"><parent>case</parent>'
        "<child>{0}</child><axis><xyz>0 0 1</xyz>{1}</axis></joint>"
    )
    box = (
        '<joint name="box" type="gearbox"><parent>large</parent><child>small</child>'
        "<gearbox_ratio>3</gearbox_ratio>"
        "<gearbox_reference_body>case</gearbox_reference_body>"
        "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>"
    )
    path = tmp_path / "gears.sdf"
    path.write_text(
        '<sdf version="1.9"><model name="gears"><link name="case"/>'
        + hinge.format("large", turns.format(-1, 1))
        + hinge.format("small", turns.format(-0.3, 0.3))
        + box
        + "</model></sdf>"
    )
    findings = cartwheel.check(path).findings
    assert not [each for each in findings if each.code is MIMIC_OUT_OF_LIMITS]
