"""Launch files that are left out because reading them takes too long."""

import json
from pathlib import Path

import pytest

from cartwheel.checks import check
from cartwheel.cli.commands.corpus import corpus
from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.launches import alternatives, effort, read_launch, reading, search

ARM = (
    '<robot name="arm"><link name="world"/><link name="base"><inertial><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="hinge" type="revolute"><parent link="world"/><child link="base"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>'
    '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo></robot>'
)
LAUNCH = (
    '<launch><param name="robot_description" command="xacro $(find arm)/urdf/{}.urdf"/></launch>'
)
COSTLY = "x = " + "1 + " * 60_000 + "1\n"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two robots and a launch file for one of them."""
    monkeypatch.setattr(effort, "_STEPS", 200_000)
    folder = tmp_path / "arm"
    for name in ("launch", "urdf", ".git"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    for name in ("one", "two"):
        (folder / "urdf" / f"{name}.urdf").write_text(ARM)
    (folder / "launch" / "one.launch").write_text(LAUNCH.format("one"))
    return folder


def reported(folder: Path) -> list[tuple[str, str]]:
    """The files and the messages of CW164, for the robots in a folder or file."""
    found = check(folder).findings
    return [
        (Path(each.origin.file).name, each.message)
        for each in found
        if each.code is LAUNCH_VALUE_UNKNOWN
    ]


def test_nothing_is_reported_if_everything_is_read(package):
    assert reported(package) == []


@pytest.mark.parametrize("path", [".", "urdf/one.urdf"])
def test_a_launch_file_that_takes_too_long_is_reported_once(package, path):
    (package / "launch" / "many.launch.py").write_text(COSTLY)
    ((file, _),) = reported(package / path)
    assert file == "many.launch.py"


def test_the_launch_files_that_are_not_reached_are_reported_with_their_folder(package, monkeypatch):
    monkeypatch.setattr(search, "_MOST", 1)
    (package / "launch" / "two.launch").write_text(LAUNCH.format("two"))
    ((file, message),) = reported(package)
    assert file == "arm"
    assert 'only those up to "launch/one.launch" are read' in message


def test_too_many_folders_are_reported(package, monkeypatch):
    monkeypatch.setattr(effort, "_STEPS", 10)
    ((file, message),) = reported(package)
    assert file == "arm"
    assert "none of them" in message


def test_too_many_includes_are_reported(package, monkeypatch):
    for module in (alternatives, reading):
        monkeypatch.setattr(module, "INCLUDES", 1)
    text = '<launch><include file="$(find arm)/launch/one.launch"/></launch>'
    (package / "launch" / "all.launch").write_text(text)
    ((file, _),) = reported(package)
    assert file == "all.launch"


def test_the_corpus_lists_what_is_left_out_once(package, capsys):
    (package / "launch" / "many.launch.py").write_text(COSTLY)
    corpus([package], [], json=False, standing=0.1)
    lines = [each for each in capsys.readouterr().out.splitlines() if "CW164" in each]
    assert len(lines) == 1
    assert "many.launch.py" in lines[0]
    corpus([package / "urdf" / "one.urdf"], [], json=True, standing=0.1)
    (robot,) = json.loads(capsys.readouterr().out)["robots"]
    assert any("many.launch.py" in each for each in robot["diagnostics"])


def test_a_launch_file_that_is_run_reports_includes_that_it_leaves_out(package, monkeypatch):
    include = '<include file="$(find arm)/launch/one.launch"/>'
    path = package / "launch" / "all.launch"
    path.write_text(f"<launch>{include}</launch>")
    assert not read_launch(path, {}).diagnostics
    path.write_text(f"<launch>{include * 61}</launch>")
    (each,) = read_launch(path, {}).diagnostics
    assert each.code is LAUNCH_VALUE_UNKNOWN
