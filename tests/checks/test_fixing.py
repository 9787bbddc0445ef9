"""Fixes are written only where they are beyond doubt, and change nothing else."""

from __future__ import annotations

import pytest
from tests.checks.conftest import ROBOT

from cartwheel.checks import check
from cartwheel.checks.project import fixing


@pytest.fixture
def fixed(tmp_path):
    """The text after its fixes, and how many there were."""

    def make(text, name="robot.urdf"):
        path = tmp_path / name
        path.write_bytes(text.encode())
        made = fixing.fixes(check(path).findings, fixing.project_of(path))
        for each in made:
            each.write()
        return path.read_bytes().decode(), sum(len(each.findings) for each in made)

    return make


def spoilt(old, new):
    assert old in ROBOT
    return ROBOT.replace(old, new, 1)


CASES = {
    "limits": ('lower="-1" upper="1" effort="5"', 'lower="-90"  upper=\'45\' effort="5"',
        'lower="-1.5708"  upper=\'0.785398\' effort="5"'),
    "angles": ('rpy="0 0 0"', 'rpy="0 0 90"', 'rpy="0 0 1.5708"'),
    "inertia": ('iyy="0.085" izz="0.125"', 'iyy="0.085" izz="0.325"', None),
    "separation": ("<wheelSeparation>0.4<", "<wheelSeparation> 0.45 <", "<wheelSeparation> 0.4 <"),
    "diameter": ("<wheelDiameter>0.16<", "<wheelDiameter>0.08<", "<wheelDiameter>0.16<"),
    "parameter": ("<wheelDiameter>0.16</wheelDiameter>", "<wheelDiametr>0.16</wheelDiametr >",
        "<wheelDiameter>0.16</wheelDiameter >"),
    "tag": ("<mu1>1.0</mu1>", "<minDepht>0.01</minDepht>", "<minDepth>0.01</minDepth>"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_fault_is_fixed_and_nothing_else_changes(fixed, case, newline):
    right, wrong, wanted = case
    text = spoilt(right, wrong).replace("\n", newline)
    after, count = fixed(text)
    assert count == 1
    if wanted is not None:
        assert after == text.replace(wrong, wanted, 1)
    assert after != text and after.count(newline) == text.count(newline)
    assert fixed(after) == (after, 0)


@pytest.mark.parametrize(
    "limit",
    [
        '<limit lower="${-90}" upper="90" effort="5" velocity="2"/>',
        '<limit lower="-90" upper="90" effort="$(arg e)" velocity="2"/>',
    ],
)
def test_an_element_with_an_expression_stays(fixed, limit):
    text = spoilt('<limit lower="-1" upper="1" effort="5" velocity="2"/>', limit)
    text = text.replace(
        '<robot name="tester">',
        '<robot name="tester" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="e" default="5"/>',
    )
    assert fixed(text, "robot.xacro") == (text, 0)


def test_an_element_of_a_macro_stays(fixed):
    limit = '<limit lower="-90" upper="90" effort="5" velocity="2"/>'
    text = spoilt('<limit lower="-1" upper="1" effort="5" velocity="2"/>', "<xacro:span/>")
    text = text.replace(
        '<robot name="tester">',
        '<robot name="tester" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f'<xacro:macro name="span" params="">{limit}</xacro:macro>',
    )
    assert fixed(text, "robot.xacro") == (text, 0)


def test_files_outside_the_project_stay(tmp_path):
    outside = tmp_path / "outside.xacro"
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
    link = '<link name="l"><visual><origin rpy="0 0 90"/><geometry><box size="1 1 1"/></geometry>'
    outside.write_text(f"{head}{link}</visual></link></robot>")
    path = tmp_path / "package" / "robot.xacro"
    path.parent.mkdir()
    path.write_text(f'{head}<xacro:include filename="../outside.xacro"/></robot>')
    findings = [each for each in check(path).findings if each.code.name == "angle-in-degrees"]
    assert len(findings) == 1
    assert fixing.fixes(findings, fixing.project_of(path)) == []
    assert len(fixing.fixes(findings, tmp_path)) == 1


def test_of_two_elements_on_one_line_none_is_fixed(fixed):
    text = spoilt(
        "<wheelSeparation>0.4</wheelSeparation>",
        "<wheelSeparation>0.45</wheelSeparation><wheelSeparation>0.45</wheelSeparation>",
    )
    assert fixed(text)[0] == text


def test_the_diff_names_the_file_and_the_lines(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(spoilt('rpy="0 0 0"', 'rpy="0 0 90"'))
    (fix,) = fixing.fixes(check(path).findings, tmp_path)
    lines = fix.diff.splitlines()
    assert lines[0].startswith("--- a/") and lines[0].endswith("robot.urdf")
    assert [line for line in lines[3:] if line[0] in "+-"] == [
        '-      <origin xyz="0 0 0.1" rpy="0 0 90"/>',
        '+      <origin xyz="0 0 0.1" rpy="0 0 1.5708"/>',
    ]


def test_a_size_in_yaml_is_fixed(tmp_path):
    path, yaml = tmp_path / "robot.urdf", tmp_path / "base.yaml"
    path.write_text(ROBOT)
    text = (
        "base:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_wheel_joint\n"
        "  right_wheel: right_wheel_joint\n  wheel_separation: 0.45  # measured\n"
    )
    yaml.write_text(text)
    (fix,) = fixing.fixes(check(path, controllers=[yaml]).findings, tmp_path)
    assert fix.after.decode() == text.replace("0.45", "0.4")
