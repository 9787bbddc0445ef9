"""Robots of several repositories that are side by side in one folder."""

from pathlib import Path

import pytest

from cartwheel.checks.checking import check
from cartwheel.cli.commands.corpus import corpus
from cartwheel.corpus import try_robot
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.launches import LaunchSearch, LaunchUse, own, own_launches

ARM = (
    '<robot name="arm"><link name="world"/><link name="base"><inertial><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<link name="upper"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="stand" type="fixed"><parent link="world"/><child link="base"/></joint>'
    '<joint name="lid_hinge" type="revolute"><parent link="base"/><child link="upper"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>'
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="lid_hinge"><hardwareInterface>hardware_interface/PositionJointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
    '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo></robot>'
)
CONTROLLER = "move:\n  type: position_controllers/JointPositionController\n  joint: lid_hinge\n"
LAUNCH = (
    '<launch><param name="robot_description" command="xacro $(find arm_description)/arm.urdf"/>'
    '<rosparam file="$(find arm_sim)/settings/move.yaml" command="load"/>'
    '<node name="s" pkg="controller_manager" type="spawner" args="move"/></launch>'
)


def package(folder: Path, name: str, files: dict[str, str]) -> None:
    for path, text in {"package.xml": f"<package><name>{name}</name></package>", **files}.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)


@pytest.fixture
def folder(tmp_path):
    """A repository with an arm, and one of another author with a controller for such an arm."""
    package(tmp_path / "one", "arm_description", {"arm.urdf": ARM})
    package(tmp_path / "two", "arm_sim", {"config/move.yaml": CONTROLLER})
    return tmp_path


@pytest.mark.parametrize("marker", [".git", ".github", ".gitignore"])
def test_controllers_of_another_repository_are_not_used(folder, marker):
    arm = folder / "one" / "arm.urdf"
    assert try_robot(arm, standing=1.0).controllers == ("move",)
    (folder / "one" / marker).mkdir()
    verdict = try_robot(arm, standing=1.0)
    assert not verdict.controllers
    assert [fault.test for fault in verdict.faults] == ["controller"]
    assert verdict.faults[0].code.name == "controllers-not-found"
    assert str(folder / "two" / "config/move.yaml") not in check(arm).files


def test_controllers_of_the_same_repository_are_used(folder):
    (folder / ".git").mkdir()
    (folder / "one" / ".gitignore").touch()
    verdict = try_robot(folder / "one" / "arm.urdf", standing=1.0)
    assert verdict.controllers == ("move",)


def test_nothing_outside_of_the_given_folder_is_used(folder, capsys):
    corpus([folder / "one"], [], json=True, standing=1.0)
    assert '"controllers": []' in capsys.readouterr().out
    corpus([folder], [], json=True, standing=1.0)
    assert '"move"' in capsys.readouterr().out


def test_launch_files_of_another_repository_are_not_used(folder):
    (folder / "two" / "config/move.yaml").unlink()
    files = {"launch/arm.launch": LAUNCH, "settings/move.yaml": CONTROLLER}
    package(folder / "two", "arm_sim", files)
    arm = folder / "one" / "arm.urdf"
    assert try_robot(arm, standing=1.0, folder=folder).controllers == ("move",)
    (folder / "two" / ".git").mkdir()
    verdict = try_robot(arm, standing=1.0, folder=folder)
    assert verdict.launch is None
    assert not verdict.controllers


SPAWN = '<node name="g" pkg="gazebo_ros" type="spawn_model" args="-urdf -model arm"/></launch>'


def test_the_simulation_of_a_robot_may_be_in_another_repository_of_the_given_folder(folder):
    """The description and its simulation are often two repositories of one workspace."""
    (folder / "two" / "config/move.yaml").unlink()
    launch = LAUNCH.replace("</launch>", SPAWN)
    files = {"launch/arm.launch": launch, "settings/move.yaml": CONTROLLER}
    package(folder / "two", "arm_sim", files)
    for each in ("one", "two"):
        (folder / each / ".git").mkdir()
    arm = folder / "one" / "arm.urdf"
    verdict = try_robot(arm, standing=1.0, folder=folder)
    assert verdict.launch is not None
    assert verdict.launch.file == folder / "two/launch/arm.launch"
    assert verdict.controllers == ("move",)
    assert not verdict.faults
    assert not try_robot(arm, standing=1.0, folder=folder / "one").controllers
    assert not try_robot(arm, standing=1.0).controllers
    checked = check(arm, launches=LaunchSearch(given=folder).of)
    assert str(folder / "two" / "settings/move.yaml") in checked.files
    assert not [each for each in checked.findings if each.code.name == "controllers-not-found"]

    # The author's own launch file comes first.
    own = launch.replace("arm_sim", "arm_description").replace("settings/", "")
    package(folder / "one", "arm_description", {"start.launch": own, "move.yaml": CONTROLLER})
    verdict = try_robot(arm, standing=1.0, folder=folder)
    assert verdict.launch is not None
    assert verdict.launch.file == folder / "one/start.launch"
    (folder / "one/start.launch").unlink()
    (folder / "one/move.yaml").unlink()

    # With a second package of this name, it may be that of another author.
    package(folder / "three", "arm_description", {})
    verdict = try_robot(arm, standing=1.0, folder=folder)
    assert verdict.launch is None
    assert not verdict.controllers


def test_a_launch_file_that_names_no_robot_is_used_near_it_only(folder):
    """Without hidden files, each folder in the given one may be a repository."""
    (folder / "two" / "config/move.yaml").unlink()
    start = LAUNCH.replace(LAUNCH[LAUNCH.index("<param") : LAUNCH.index("<rosparam")], "")
    files = {"launch/arm.launch": start, "settings/move.yaml": CONTROLLER}
    package(folder / "two" / "sims" / "arm", "arm_sim", files)
    (folder / "two" / "package.xml").unlink()
    (folder / "robots").mkdir()
    arm = (folder / "one").rename(folder / "robots" / "one") / "arm.urdf"
    assert not try_robot(arm, standing=1.0, folder=folder).controllers
    (folder / "two" / "sims").rename(folder / "robots" / "sims")
    assert try_robot(arm, standing=1.0, folder=folder).controllers == ("move",)


def test_the_root_of_a_repository_is_found(tmp_path):
    file = tmp_path / "ws" / "repo" / "package" / "urdf" / "robot.urdf"
    file.parent.mkdir(parents=True)
    assert repository_of(file) is None
    (file.parents[1] / ".gitignore").touch()
    assert repository_of(file) == file.parents[1]
    (file.parents[2] / ".gitignore").touch()
    assert repository_of(file) == file.parents[2]
    (file.parents[3] / ".git").mkdir()
    assert repository_of(file) == file.parents[3]
    assert repository_of(file, file.parents[2]) == file.parents[2]
    (file.parents[2] / ".git").touch()
    assert repository_of(file) == file.parents[2]
    (file.parents[3] / ".gitmodules").touch()
    assert repository_of(file) == file.parents[3]


def test_the_repository_of_launch_files_in_one_folder_is_looked_up_once(folder, monkeypatch):
    looked = []
    original = own.repository_of

    def counted(file, within=None):
        looked.append(file.parent)
        return original(file, within)

    monkeypatch.setattr(own, "repository_of", counted)
    uses = [
        LaunchUse(file=folder / "two" / f"{number}.launch", description=None, arguments={})
        for number in range(20)
    ]
    assert own_launches(folder / "one" / "arm.urdf", uses).launches == uses
    assert looked.count(folder / "two") == looked.count(folder / "one") == 1
