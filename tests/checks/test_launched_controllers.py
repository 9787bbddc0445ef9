"""Controller files that only a launch file names."""

import pytest
from tests.corpus.carts import cart, controlled

from cartwheel.checks.checking import check
from cartwheel.checks.project.run import check as check_project
from cartwheel.codes.devices import CONTROLLER_UNDEFINED, CONTROLLERS_NOT_FOUND
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot
from cartwheel.description.launches import own

LAUNCH = """<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="robot_description"
value="$(command 'xacro $(find-pkg-share cart)/robot.urdf')"/></node>
<node pkg="controller_manager" exec="ros2_control_node">
<param from="$(find-pkg-share cart)/settings/base.yaml"/></node>
<node pkg="controller_manager" exec="spawner" args="base"/></launch>"""


def spawned(folder, *, named, launch=LAUNCH):
    """A cart of a package whose launch file starts its controller."""
    package = folder / "cart"
    (package / "settings").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>cart</name></package>")
    text = controlled(package / "settings", separation=0.4)
    tag = text[text.index("<parameters>") : text.index("</parameters>") + len("</parameters>")]
    path = package / "robot.urdf"
    # Of these plugins, only that of Gazebo Classic starts without the file.
    classic = text.replace(tag, "").replace("gz_ros2_control-system", "libgazebo_ros2_control.so")
    classic = classic.replace("gz_ros2_control/GazeboSimSystem", "gazebo_ros2_control/GazeboSystem")
    control = text if named else classic
    path.write_text(f'<robot name="cart">{cart()}{control}</robot>')
    (package / "cart.launch.xml").write_text(launch)
    return path


@pytest.mark.parametrize("named", [True, False])
def test_a_wrong_size_in_a_file_that_a_launch_file_loads_is_found(tmp_path, named):
    path = spawned(tmp_path, named=named)
    codes = [each.code for each in check(path).findings]
    assert WHEEL_SEPARATION_MISMATCH in codes
    (fault,) = try_robot(path, standing=1.0).faults
    assert fault.code is WHEEL_SEPARATION_MISMATCH


@pytest.mark.parametrize("named", [True, False])
def test_a_controller_that_no_file_defines_is_found(tmp_path, named):
    launch = LAUNCH.replace('args="base"', 'args="base arm"')
    path = spawned(tmp_path, named=named, launch=launch)
    found = [each for each in check(path).findings if each.code is CONTROLLER_UNDEFINED]
    assert [each.values["controller"] for each in found] == ["arm"]
    assert found[0].origin.file.endswith("cart.launch.xml")


def test_the_launch_files_near_the_robots_of_a_world_are_read_once(tmp_path, monkeypatch):
    read = []

    def near(folder, package_path=()):
        read.append(folder)
        return ()

    monkeypatch.setattr(own, "launches_near", near)
    (tmp_path / "package.xml").write_text("<package><name>hall</name></package>")
    control = '<plugin filename="gz_ros2_control-system" name="c"/>'
    models = "".join(
        f'<model name="m{number}"><link name="l"/>{control}</model>' for number in range(3)
    )
    path = tmp_path / "hall.world"
    path.write_text(f'<sdf version="1.6"><world name="hall">{models}</world></sdf>')
    check(path)
    assert len(read) == 1


PUBLISHER = """controller_manager:
  ros__parameters:
    states: {type: joint_state_broadcaster/JointStateBroadcaster}
"""


def apart(folder, *, names="base arm", marker=".git"):
    """A cart and its launch file in packages that are in different folders of a repository."""
    path = spawned(folder / "robots", named=False, launch="<launch/>")
    start = folder / "programs" / "start"
    (start / "settings").mkdir(parents=True)
    (start / "package.xml").write_text("<package><name>start</name></package>")
    launch = LAUNCH.replace("cart)/settings", "start)/settings").replace("base.yaml", "own.yaml")
    (start / "start.launch.xml").write_text(launch.replace('args="base"', f'args="{names}"'))
    base = path.parent / "settings" / "base.yaml"
    (start / "settings" / "own.yaml").write_text(
        base.read_text() if names != "states" else PUBLISHER
    )
    base.unlink()
    if marker:
        (folder / marker).mkdir()
    return path


@pytest.mark.parametrize(
    ("names", "code", "value"),
    [
        ("arm", CONTROLLER_UNDEFINED, ("controller", "arm")),
        ("base", WHEEL_SEPARATION_MISMATCH, ("stated", 0.4)),
        ("states", CONTROLLERS_NOT_FOUND, ("started", ("states",))),
    ],
)
def test_launch_files_of_the_whole_repository_are_read(tmp_path, names, code, value):
    path = apart(tmp_path, names=names)
    (found,) = [each for each in check(path).findings if each.code is code]
    assert found.values[value[0]] == value[1]
    assert found.severity == "warning"
    verdict = try_robot(path, standing=1.0)
    assert code in {each.code for each in (*verdict.faults, *verdict.observed)}


def test_without_a_repository_launch_files_in_the_given_folder_are_read(tmp_path):
    apart(tmp_path / "one", marker="")
    apart(tmp_path / "two", names="base", marker="")
    (tmp_path / "one" / "robots" / "cart").rename(tmp_path / "one" / "robots" / "cart1")

    def undefined(path):
        return [f for f in check_project(path).findings if f.code is CONTROLLER_UNDEFINED]

    assert len(undefined(tmp_path)) == 1
    assert undefined(tmp_path / "one" / "robots" / "cart1" / "robot.urdf") == []


def test_the_launch_files_of_a_repository_are_read_once_for_a_folder(tmp_path, monkeypatch):
    read = []

    def near(folder, package_path=()):
        read.append(folder)
        return ()

    monkeypatch.setattr(own, "launches_near", near)
    path = apart(tmp_path)
    (path.parent / "other.urdf").write_text(path.read_text())
    assert len(check_project(tmp_path).reports) == 2
    assert read == [path.parent, tmp_path]


def test_a_manager_without_controllers_is_only_noted(tmp_path):
    """The controllers may be in another repository."""
    path = apart(tmp_path, names="base")
    assert CONTROLLERS_NOT_FOUND not in [each.code for each in check(path).findings]
    (tmp_path / "programs" / "start" / "start.launch.xml").unlink()
    (found,) = [each for each in check(path).findings if each.code is CONTROLLERS_NOT_FOUND]
    assert (found.severity, found.values["started"]) == ("info", ())
    text = path.read_text()
    drive = (
        '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"><leftJoint>left_joint'
        "</leftJoint><rightJoint>right_joint</rightJoint></plugin></gazebo></robot>"
    )
    path.write_text(text.replace("</robot>", drive))
    assert CONTROLLERS_NOT_FOUND not in [each.code for each in check(path).findings]
