"""``cartwheel check``: status, text and JSON."""

from __future__ import annotations

import json

import pytest

from cartwheel.checks.checking import REPORTED
from cartwheel.checks.rules import RULES
from cartwheel.codes.command import UNKNOWN_CODE
from cartwheel.errors import UNCLASSIFIED

GOOD = """<?xml version="1.0"?>
<robot name="bar">
  <link name="bar">
    <inertial>
      <mass value="12"/>
      <inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision>
      <geometry><box size="1 1 1"/></geometry>
    </collision>
  </link>
</robot>
"""
WARNING = GOOD.replace('ixx="2" iyy="2" izz="2"', 'ixx="90" iyy="90" izz="90"')
ERROR = GOOD.replace('izz="2"', 'izz="-2"')
NOTE = GOOD.replace("<collision>", '<collision colour="blue">')
KEYS = {
    "code": str, "name": str, "rule": str, "values": dict, "severity": str,
    "message": str, "file": str, "line": int, "column": int,
    "stack": list, "instead": str, "place": str, "hint": str, "also": list,
}  # fmt: skip


SYSTEM = GOOD.replace(
    "</robot>", '<gazebo><plugin filename="{}-sensors-system" name="s"/></gazebo></robot>'
)


@pytest.fixture
def checked(program, tmp_path):
    def run(text, *options, status):
        path = tmp_path / "bar.urdf"
        path.write_text(text)
        return program("check", path, *options, status=status).stdout

    return run


def test_a_clean_description_ends_with_0_and_says_so(checked):
    assert checked(GOOD, status=0).strip().endswith("bar.urdf: no problems found")


@pytest.mark.parametrize("text", [WARNING, ERROR])
def test_findings_end_with_1(checked, text):
    checked(text, status=1)


def test_notes_end_with_1_only_where_strict(checked):
    assert "1 note" in checked(NOTE, status=0)
    checked(NOTE, "--strict", status=1)


def test_what_cannot_be_read_ends_with_2(checked, program, tmp_path):
    checked("<robot", status=2)
    checked('<launch><node pkg="a" type="b" name="c"/></launch>', status=2)
    program("check", tmp_path / "nothing.urdf", status=2)
    program("check", status=2)


def test_a_finding_shows_its_line_a_caret_and_the_text_to_write(checked):
    lines = checked(ERROR, status=1).splitlines()
    assert ":6: error: " in lines[0]
    assert lines[0].endswith(" inertia-impossible]")
    assert lines[1] == '    6 | <inertia ixx="2" iyy="2" izz="-2" ixy="0" ixz="0" iyz="0"/>'
    assert lines[2] == " " * 8 + "^" + "~" * (len(lines[1]) - 9)
    assert lines[3] == '  fix: <inertia ixx="2" ixy="0" ixz="0" iyy="2" iyz="0" izz="2"/>'
    assert lines[-1].endswith("bar.urdf: 1 error")
    assert "\033" not in "".join(lines), "a file shows no colours"


def test_a_caret_points_at_what_is_wrong(checked):
    text = GOOD.replace(
        "</robot>",
        '<joint name="j" type="revolute">\n<parent link="bar"/>\n<child link="tip"/>\n'
        '<axis xyz="0 0 0"/>\n<limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
        '<link name="tip">'
        '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        "</inertial></link></robot>",
    )
    lines = checked(text, status=1).splitlines()
    index = next(i for i, line in enumerate(lines) if " axis-zero]" in line)
    source, caret = lines[index + 1], lines[index + 2]
    begin, end = caret.index("^"), len(caret)
    assert source[begin:end] == 'xyz="0 0 0"'


def test_json_keeps_to_its_schema(checked):
    report = json.loads(checked(ERROR, "--json", status=1))
    assert set(report) == {
        "schema",
        "file",
        "name",
        "complete",
        "descriptions",
        "summary",
        "findings",
    }
    assert report["schema"] == 2
    assert report["name"] == "bar"
    assert report["complete"] is True
    assert report["summary"] == {
        "error": 1,
        "warning": 0,
        "info": 0,
        "ignored": 0,
        "suppressed": 0,
        "accepted": 0,
    }
    (finding,) = report["findings"]
    assert {key: type(value) for key, value in finding.items()} == KEYS
    assert finding["code"] == "CW220"
    assert finding["rule"] == finding["name"] == "inertia-impossible"
    assert finding["severity"] == "error"
    assert (finding["line"], finding["column"]) == (6, 7)
    assert finding["place"] == "element"
    assert finding["file"].endswith("bar.urdf")


def test_json_of_a_clean_description_has_no_findings(checked):
    assert json.loads(checked(GOOD, "--json", status=0))["findings"] == []


def test_json_states_what_ended_the_check(checked):
    report = json.loads(checked(GOOD.replace("  </link>\n", ""), "--json", status=2))
    assert report["complete"] is False
    assert [(one["rule"], one["severity"], one["line"]) for one in report["findings"]] == [
        ("xml-malformed", "error", 11)
    ]


def test_what_ends_the_check_shows_its_line(checked):
    lines = checked(GOOD.replace("  </link>\n", ""), status=2).splitlines()
    assert ":11: error: " in lines[0]
    assert lines[1] == "   11 | </robot>"


def test_the_same_of_several_lines_is_shown_once(checked):
    part = '<collision>\n      <geometry><box size="1 1 1"/></geometry>\n    </collision>'
    three = "\n".join([part] * 3).replace("<geometry>", '<geometry name="a">')
    text = GOOD.replace(part, three)
    assert text.count('name="a"') == 3
    shown = checked(text, status=0)
    assert shown.count(" tag-ignored]") == 1
    assert "and 2 more, on lines 12, 15" in shown
    assert "3 notes" in shown
    assert len(json.loads(checked(text, "--json", status=0))["findings"]) == 3


def test_a_rule_can_be_ignored_and_a_wrong_name_is_reported(checked, program, tmp_path):
    out = checked(ERROR, "--ignore", "inertia-impossible", status=0)
    assert "1 ignored" in out
    done = program("check", tmp_path / "bar.urdf", "--ignore", "inertia-imposible", status=2)
    assert f"[{UNKNOWN_CODE}]" in done.stderr


@pytest.mark.wording
def test_the_rule_that_was_meant_is_named(program, tmp_path):
    (tmp_path / "bar.urdf").write_text(GOOD)
    done = program("check", tmp_path / "bar.urdf", "--ignore", "inertia-imposible", status=2)
    assert 'Did you mean "inertia-impossible"?' in done.stderr


def test_all_codes_of_descriptions_are_listed(program):
    listed = [line.split()[:3] for line in program("check", "--list").stdout.splitlines()]
    assert listed == [[code.number, code.name, code.severity] for code in REPORTED]
    coded = {rule.code for rule in RULES if rule.code.number != UNCLASSIFIED.number}
    assert coded <= set(REPORTED)


def test_arguments_of_a_xacro_are_taken(program, tmp_path):
    path = tmp_path / "bar.xacro"
    path.write_text(
        ERROR.replace('name="bar">\n', 'name="bar" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
        '<xacro:arg name="izz" default="9"/>', 1).replace('izz="-2" ', 'izz="$(arg izz)" ')
    )  # fmt: skip
    program("check", path, status=1)
    program("check", path, "izz:=2", status=0)


def test_parameters_are_held_against_the_plugins(checked):
    plugin = (
        '<gazebo><plugin name="p" filename="libgazebo_ros_imu.so">\n<bodyName>bar</bodyName>\n'
        "<topicNam>imu</topicNam></plugin></gazebo></robot>"
    )
    out = checked(GOOD.replace("</robot>", plugin), status=1)
    assert " plugin-parameter-unknown]" in out
    assert "fix: <topicName>imu</topicName>" in out


def test_the_shipped_robot_has_nothing_to_note(program):
    assert "no problems found" in program("check", "rosbots.xacro", "--strict").stdout


def test_a_file_of_controllers_that_is_named_is_checked_too(checked, tmp_path):
    path = tmp_path / "bar.yaml"
    path.write_text("swing:\n  type: position_controllers/JointPositionControler\n  joint: hinge\n")
    found = json.loads(checked(GOOD, "--json", "--controllers", path, status=1))["findings"]
    (kind,) = (each for each in found if each["rule"] == "controller-type-unknown")
    assert (kind["file"], kind["line"], kind["place"]) == (str(path), 2, "line")
    assert kind["instead"] == "type: position_controllers/JointPositionController"


@pytest.mark.parametrize("system", ["gz-sim", "libignition-gazebo6"])
def test_systems_that_need_no_plugin_here_are_no_note(checked, system):
    assert checked(SYSTEM.format(system), status=0).endswith("bar.urdf: no problems found\n")
    assert " plugin-unknown]" in checked(SYSTEM.format("other"), status=0)
