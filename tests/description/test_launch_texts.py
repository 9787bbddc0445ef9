"""Texts of files that launch files in Python change, as by ReplaceString and RewrittenYaml."""

import os
from pathlib import Path

import pytest

from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches import read_launch
from cartwheel.description.rewritten import original, rewritten
from cartwheel.dialects.ros_control.files import read_yaml

LAUNCH = """
def generate_launch_description():
    share = get_package_share_directory("bot")
    space = LaunchConfiguration("namespace")
    source = share + "/control.yaml"
    unknown = os.getpid()
    changed = {changed}
    return LaunchDescription([
        DeclareLaunchArgument("namespace", default_value="one"),
        Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[{{
            "robot_description": Command(["xacro ", share + "/bot.xacro", " file:=", changed])}}]),
        Node(package="controller_manager", executable="ros2_control_node", parameters=[changed]),
        Node(package="ros_gz_bridge", executable="parameter_bridge",
            parameters=[{{"config_file": {bridge}}}]),
    ])
"""
CONTROL = """<ns>/controller_manager:
  ros__parameters:
    update_rate: 100  # Hz
    base: {type: diff_drive_controller/DiffDriveController}
<ns>/base:
  ros__parameters:
    linear: {speed: 1.0, name: a}
    frame: $(var namespace)/base
"""


def started(folder: Path, changed: str, bridge: str = "source", **arguments: str):
    """What a launch file starts that changes the text of a file with controllers."""
    (folder / "launch").mkdir()
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "bot.xacro").write_text('<robot name="bot"><link name="base"/></robot>')
    (folder / "control.yaml").write_text(CONTROL)
    file = folder / "launch" / "bot.launch.py"
    file.write_text(LAUNCH.format(changed=changed, bridge=bridge))
    return read_launch(file, arguments)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ('ReplaceString(source_file=source, replacements={"<ns>": space})', ("one", 1.0, "a")),
        (
            'ReplaceString(source, {"<ns>": (space, "/x"), "speed: 1": "speed: 2"})',
            ("one/x", 2, "a"),
        ),
        (
            'ReplaceString(source_file=source, replacements={"<ns>/": space}, '
            'condition=IfCondition("false"))',
            ("<ns>", 1.0, "a"),
        ),
        (
            'RewrittenYaml(source_file=source, param_rewrites={"speed": "3", "name": "b"}, '
            "convert_types=True)",
            ("<ns>", 3, "b"),
        ),
        ('RewrittenYaml(source, {"ros__parameters.linear.speed": "3"})', ("<ns>", 1.0, "a")),
        (
            'RewrittenYaml(source, {"<ns>/base.ros__parameters.linear.speed": "3"})',
            ("<ns>", "3", "a"),
        ),
        ('RewrittenYaml(source, {}, root_key=space, convert_types=True)', ("one/<ns>", 1.0, "a")),
        (
            "RewrittenYaml(source_file=ReplaceString(source, {'<ns>': 'in'}), root_key=space, "
            "param_rewrites={'speed': '4'}, convert_types=True)",
            ("one/in", 4, "a"),
        ),
        ("source", ("<ns>", 1.0, "a")),
    ],
)  # fmt: skip
def test_controllers_are_read_from_the_changed_text(tmp_path, changed, expected):
    start = started(tmp_path, changed)
    (model,) = start.models
    (file,) = model.use.controllers
    content = read_yaml(file)
    space, speed, name = expected
    linear = content[f"{space}/base"]["ros__parameters"]["linear"]
    assert linear == {"speed": speed, "name": name}
    assert list(content) == [f"{space}/controller_manager", f"{space}/base"]
    # As in ROS, an argument of the description may be the path of the file.
    assert model.use.arguments == {"file": str(file)}
    assert original(file) == tmp_path / "control.yaml"
    assert (tmp_path / "control.yaml").read_text() == CONTROL
    assert not start.diagnostics


def test_a_parameter_file_has_the_values_of_launch_arguments(tmp_path):
    changed = "ParameterFile({}ReplaceString(source, {{'<ns>': ''}}), allow_substs={})"
    for number, allowed in enumerate(("True", "False")):
        folder = tmp_path / str(number)
        folder.mkdir()
        start = started(folder, changed.format("", allowed), namespace="two")
        (file,) = start.models[0].use.controllers
        found = read_yaml(file)["/base"]["ros__parameters"]["frame"]
        assert found == ("two/base" if number == 0 else "$(var namespace)/base")


def test_an_unknown_text_is_kept_and_reported(tmp_path):
    start = started(tmp_path, 'ReplaceString(source, {"<ns>": unknown, "speed": "s"})')
    (file,) = start.models[0].use.controllers
    assert "<ns>/base" in read_yaml(file)
    (said,) = [each for each in start.diagnostics if each.values.get("what") == "text"]
    assert said.code is LAUNCH_VALUE_UNKNOWN
    assert said.values["name"] == "control.yaml"


def test_an_unknown_text_of_another_file_is_not_reported(tmp_path):
    bridge = 'share + "/control.yaml" if ReplaceString(source, {"<ns>": unknown}) else source'
    assert not started(tmp_path, "source", bridge).diagnostics


def test_the_bridge_has_the_changed_text(tmp_path):
    start = started(tmp_path, "source", 'ReplaceString(source, {"<ns>/": ""})')
    (file,) = start.bridges
    assert list(read_yaml(file)) == ["controller_manager", "base"]


def test_messages_name_the_original(tmp_path):
    source = tmp_path / "a.yaml"
    source.write_text("a: 1\n")
    copy = rewritten(source, "a: 2\n")
    assert copy.read_text() == "a: 2\n"
    assert shown_path(copy) == str(source)
    assert rewritten(source, "a: 1\n") == source
    assert rewritten(copy, "a: 3\n") != copy
    assert original(rewritten(copy, "a: 3\n")) == source
    assert rewritten(source, "a" * 2_000_000) == source


def test_a_folder_of_a_repository_with_the_name_of_one_for_copies(tmp_path):
    """Reading a named pipe would not end."""
    folder = tmp_path / "cartwheel-launched-x" / "0"
    folder.mkdir(parents=True)
    file = folder / "robot.urdf"
    file.write_text("<robot/>")
    os.mkfifo(folder / ".source")
    assert original(file) == file
    (folder / ".source").unlink()
    (folder / ".source").write_text("/etc/hostname")
    assert original(file) == file
    copy = rewritten(file, "<robot></robot>")
    assert copy != file
    assert original(copy) == file
