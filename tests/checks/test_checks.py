"""Settings, selections, suppressions, baselines and workspaces of checks."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
from tests.checks.seeded import ROBOT

import cartwheel
from cartwheel.checks import check
from cartwheel.checks.project.baseline import write
from cartwheel.checks.project.workspace import descriptions
from cartwheel.codes import codes_matching, command, devices, robot
from cartwheel.description.elements import xml
from cartwheel.errors import CartwheelError, UnknownNameError

LINK = """  <link name="{name}">
    <inertial>
      <mass value="12"/>
      <inertia ixx="{ixx}" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision>
      <geometry><box size="1 1 1"/></geometry>
    </collision>
  </link>
"""
HEAD = '<robot name="bar" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
GOOD = HEAD + LINK.format(name="bar", ixx=2) + "</robot>\n"
BAD = HEAD + LINK.format(name="bar", ixx=-2) + "</robot>\n"
INERTIA = '<inertia ixx="-2"'


@pytest.fixture
def file(tmp_path):
    def make(text, name="bar.urdf"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return make


def codes(result):
    return [finding.code for finding in result.findings]


def test_python_has_the_findings_of_plugins(file):
    plugin = (
        '<gazebo><plugin name="p" filename="libgazebo_ros_imu.so">\n<bodyName>bar</bodyName>\n'
        "<topicNam>imu</topicNam></plugin></gazebo></robot>"
    )
    result = cartwheel.check(file(GOOD.replace("</robot>", plugin)))
    (finding,) = result.findings
    assert finding.code is devices.PLUGIN_PARAMETER_UNKNOWN
    assert finding.instead == "<topicName>imu</topicName>"
    assert (result.count("warning"), result.complete) == (1, True)


@pytest.mark.parametrize(("tag", "of_sensor"), [("imu", True), ("imux", False)])
def test_an_element_of_a_sensor_in_a_plugin_is_explained(file, tag, of_sensor):
    plugin = (
        f'<gazebo><plugin name="p" filename="libgazebo_ros_imu.so"><{tag}><noise/></{tag}>'
        "<bodyName>bar</bodyName></plugin></gazebo></robot>"
    )
    (finding,) = cartwheel.check(file(GOOD.replace("</robot>", plugin))).findings
    assert finding.code is devices.PLUGIN_PARAMETER_UNKNOWN
    assert finding.values["of_sensor"] is of_sensor
    assert bool(finding.hint) is of_sensor


@pytest.mark.parametrize(
    ("plugin", "default"),
    [
        ("libgazebo_ros_diff_drive.so", ("leftJoint", "left_joint")),
        ("libgazebo_ros_skid_steer_drive.so", ("rightRearJoint", "right_rear_joint")),
        ("libgazebo_ros_ackermann_drive.so", ("left_steering_joint", "left_steering_joint")),
        ("gz-sim-diff-drive-system", ("left_joint", "left_joint")),
    ],
)
def test_a_plugin_that_names_no_joints_needs_those_of_its_defaults(file, plugin, default):
    tag = f'<gazebo><plugin name="p" filename="{plugin}"/></gazebo></robot>'
    result = cartwheel.check(file(GOOD.replace("</robot>", tag)))
    missing = [each for each in result.findings if each.code is devices.PLUGIN_PARAMETER_MISSING]
    joints = {each.values["parameter"]: each.values["joint"] for each in missing}
    assert default in joints.items()
    assert "steering_wheel_joint" not in joints, "the plugin works without it"
    ends = '<parent link="bar"/><child link="{0}"/>'
    wheel = LINK.format(name="{0}", ixx=2) + f'<joint name="{{0}}" type="continuous">{ends}</joint>'
    wheels = "".join(wheel.format(joint) for joint in joints.values())
    there = file(GOOD.replace("</robot>", wheels + tag))
    assert devices.PLUGIN_PARAMETER_MISSING not in codes(cartwheel.check(there))


def test_a_misspelt_joint_tag_is_not_missing_as_well(file):
    text = ROBOT.replace("leftJoint", "leftJiont")
    assert codes(cartwheel.check(file(text))) == [devices.PLUGIN_PARAMETER_UNKNOWN]


def test_codes_are_matched_by_number_name_former_name_and_prefix():
    one = {robot.WHEEL_SEPARATION_MISMATCH}
    for word in ("CW204", "cw204", "wheel-separation-mismatch", "wheel-separation"):
        assert codes_matching(word) == one
    assert {code.number[:3] for code in codes_matching("CW2")} == {"CW2"}
    with pytest.raises(UnknownNameError):
        codes_matching("wheel-seperation")
    with pytest.raises(UnknownNameError):
        codes_matching("CW2044")


@pytest.mark.parametrize(
    ("options", "count", "ignored"),
    [
        ({}, 1, 0),
        ({"select": ["CW2"]}, 1, 0),
        ({"select": ["CW4", "mass-in-grams"]}, 0, 1),
        ({"ignore": ["CW22"]}, 0, 1),
        ({"select": ["CW2"], "ignore": ["inertia-impossible"]}, 0, 1),
    ],
)
def test_codes_are_selected_and_ignored(file, options, count, ignored):
    result = check(file(BAD), **options)
    assert (len(result.findings), result.ignored) == (count, ignored)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("pyproject.toml", '[tool.cartwheel.check]\nignore = ["CW220"]\nstrict = true\n'),
        ("cartwheel.toml", '[check]\nselect = ["CW4"]\nstrict = true\n'),
    ],
)
def test_settings_of_the_project_count(file, name, text):
    file(text, name)
    path = file(BAD, "urdf/bar.urdf")
    result = check(path)
    assert (codes(result), result.ignored, result.strict) == ([], 1, True)
    assert codes(check(path, settings=False)) == [robot.INERTIA_IMPOSSIBLE]
    # Options come before the settings, but what they ignore stays ignored.
    assert len(check(path, select=["CW220"]).findings) == (name == "cartwheel.toml")


def test_a_pyproject_without_our_table_is_passed_over(file):
    file('[tool.cartwheel.check]\nignore = ["CW220"]\n', "pyproject.toml")
    file("[tool.other]\n", "package/pyproject.toml")
    assert codes(check(file(BAD, "package/bar.urdf"))) == []


@pytest.mark.parametrize(
    "text",
    ['ignored = ["CW220"]', 'ignore = "CW220"', "strict = 1", "baseline = 1", "ignore = [1"],
)
def test_wrong_settings_are_errors(file, text):
    settings = file(f"[check]\n{text}\n", "cartwheel.toml")
    with pytest.raises(CartwheelError) as caught:
        check(file(BAD))
    assert caught.value.code is command.SETTINGS_INVALID
    assert caught.value.origin.file == str(settings)


@pytest.mark.parametrize(
    "text",
    [
        BAD.replace(INERTIA, f"<!-- cartwheel: ignore CW220 -->\n      {INERTIA}"),
        BAD.replace(INERTIA, f"<!-- cartwheel: ignore CW221, CW220 (a test) -->\n\n{INERTIA}"),
        BAD.replace('iyz="0"/>', 'iyz="0"/> <!-- cartwheel: ignore inertia-impossible -->'),
    ],
)
def test_a_comment_suppresses_a_code_at_its_place(file, text):
    result = check(file(text))
    assert result.suppressed == 1
    assert robot.INERTIA_IMPOSSIBLE not in codes(result)


def test_a_comment_elsewhere_and_of_another_code_suppress_nothing_and_are_noted(file):
    text = BAD.replace(INERTIA, f"<!-- cartwheel: ignore CW222 -->\n{INERTIA}")
    text = text.replace("<collision>", "<collision> <!-- cartwheel: ignore CW220, CW2209 -->")
    result = check(file(text))
    notes = [each for each in result.findings if each.code is command.SUPPRESSION_UNUSED]
    assert [each.values["code"] for each in notes] == ["CW222", "CW220", "CW2209"]
    assert {each.severity for each in notes} == {"info"}
    assert robot.INERTIA_IMPOSSIBLE in codes(result) and result.suppressed == 0


def test_a_comment_in_yaml_suppresses_too(file):
    kind = "position_controllers/JointPositionControler"
    yaml = file(f"swing:\n  type: {kind}\n  joint: hinge\n", "bar.yaml")
    path = file(GOOD)
    assert devices.CONTROLLER_TYPE_UNKNOWN in codes(check(path, controllers=[yaml]))
    file(f"swing:\n  # cartwheel: ignore CW423\n  type: {kind}\n  joint: hinge\n", "bar.yaml")
    result = check(path, controllers=[yaml])
    assert devices.CONTROLLER_TYPE_UNKNOWN not in codes(result) and result.suppressed == 1


def test_a_baseline_accepts_what_was_there_and_no_more(file, tmp_path):
    path, accepted = file(BAD), tmp_path / "baseline.json"
    assert write(accepted, check(path).findings) == 1
    result = check(path, baseline=accepted)
    assert (codes(result), result.accepted) == ([], 1)
    # Lines and numbers may change; another link is another finding.
    moved = BAD.replace(HEAD, HEAD + "\n\n").replace('ixx="-2"', 'ixx="-3"')
    assert codes(check(file(moved), baseline=accepted)) == []
    other = BAD.replace("</robot>", LINK.format(name="other", ixx=-1) + "</robot>")
    other = other.replace("</robot>", '<joint name="j" type="fixed"><parent link="bar"/>'
        '<child link="other"/></joint></robot>')  # fmt: skip
    (finding,) = check(file(other), baseline=accepted).findings
    assert finding.values["link"] == "other"


@pytest.mark.parametrize("text", ["", "{}", '{"schema": 9, "findings": []}', "[" * 100_000])
def test_a_file_that_is_no_baseline_is_an_error(file, tmp_path, text):
    accepted = tmp_path / "baseline.json"
    accepted.write_text(text)
    with pytest.raises(CartwheelError) as caught:
        check(file(GOOD), baseline=accepted)
    assert caught.value.code is command.BASELINE_INVALID


@pytest.fixture
def workspace(file, tmp_path):
    file("<package><name>arm</name></package>", "src/arm/package.xml")
    file(HEAD + LINK.format(name="bar", ixx=-2) + "</robot>", "src/arm/urdf/part.xacro")
    file(HEAD + '<xacro:macro name="m" params=""/></robot>', "src/arm/urdf/library.xacro")
    include = '<xacro:include filename="{}"/>\n</robot>'
    file(HEAD + include.format("part.xacro"), "src/arm/urdf/one.urdf.xacro")
    file(HEAD + include.format("$(find arm)/urdf/part.xacro"), "src/arm/urdf/two.urdf.xacro")
    file(BAD, "build/arm/copy.urdf")
    file(BAD, "src/old/COLCON_IGNORE")
    file(BAD, "src/old/old.urdf")
    file("<launch/>", "src/arm/launch/x.launch")
    return tmp_path


def test_a_folder_is_its_top_level_descriptions(workspace):
    names = [path.name for path in descriptions(workspace)]
    assert names == ["one.urdf.xacro", "two.urdf.xacro"]


def test_what_two_robots_include_is_reported_once(workspace):
    result = check(workspace, package_path=[workspace / "src"])
    assert [report.name for report in result.reports] == ["bar", "bar"]
    (finding,) = result.findings
    assert finding.origin.file.endswith("part.xacro")


def test_a_file_of_many_robots_is_not_parsed_for_each_rule(workspace, file, monkeypatch):
    for index in range(5):
        text = (workspace / "src/arm/urdf/one.urdf.xacro").read_text()
        file(text, f"src/arm/urdf/more_{index}.urdf.xacro")
    parsed = Counter()
    parse = xml.parse

    def counted(text, name="<string>"):
        parsed[Path(name).name] += 1
        return parse(text, name)

    monkeypatch.setattr(xml, "parse", counted)
    robots = len(check(workspace, package_path=[workspace / "src"]).reports)
    assert robots > 5
    # Once to choose the robots, once for the package, and once for each robot that includes it.
    assert parsed["part.xacro"] <= 2 + robots


def test_a_comment_that_one_of_two_robots_needs_is_used(workspace):
    part = workspace / "src/arm/urdf/part.xacro"
    part.write_text(part.read_text().replace(INERTIA, f"<!-- cartwheel: ignore CW220 -->{INERTIA}"))
    result = check(workspace, package_path=[workspace / "src"])
    assert (codes(result), result.suppressed) == ([], 1)


def test_a_file_of_a_folder_that_cannot_be_read_is_a_finding(workspace, file):
    file("<robot", "src/arm/urdf/broken.urdf")
    result = check(workspace, package_path=[workspace / "src"])
    assert not result.complete
    assert "broken.urdf" in {finding.origin.file.rpartition("/")[2] for finding in result.findings}


def test_the_baseline_is_plain_json(file, tmp_path):
    accepted = tmp_path / "baseline.json"
    write(accepted, check(file(BAD)).findings)
    (entry,) = json.loads(accepted.read_text())["findings"]
    assert entry == {"file": "bar.urdf", "code": "CW220", "names": [["link", "bar"]], "count": 1}


def test_a_long_line_of_comments_is_read_at_once(file):
    # In time that grows with its square this took minutes.
    result = check(file(f"{BAD}\n{'<!-- cartwheel: ignore CW999 -->' * 30_000}\n"))
    assert command.SUPPRESSION_UNUSED in {each.code for each in result.findings}
