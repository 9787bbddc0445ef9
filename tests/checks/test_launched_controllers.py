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


OTHER = """controller_manager:
  ros__parameters:
    base: {type: diff_drive_controller/DiffDriveController}
    wide: {type: diff_drive_controller/DiffDriveController}
"""
DRIVE = """{name}:
  ros__parameters:
    left_wheel_names: [left_joint]
    right_wheel_names: [right_joint]
    wheel_separation: {separation}
    wheel_radius: 0.05
"""


@pytest.mark.parametrize(
    ("starts", "program", "found"),
    [
        ("base", "", False),
        ("wide", "", True),
        ("$(env NAME)", "", True),
        ("base", "ros2 run controller_manager spawner wide", True),
        ("base", "drives the wide robot", False),
    ],
)
def test_only_controllers_that_something_starts_are_checked(tmp_path, starts, program, found):
    """A name that is unknown may be that of any of them."""
    launch = LAUNCH.replace('args="base"', f'args="{starts}"')
    path = spawned(tmp_path, named=True, launch=launch)
    drives = (DRIVE.format(name=n, separation=x) for n, x in (("base", 0.2), ("wide", 0.4)))
    (path.parent / "settings" / "base.yaml").write_text(OTHER + "".join(drives))
    (path.parent / "README.md").write_text(program)
    codes = [each.code for each in check(path).findings]
    assert (WHEEL_SEPARATION_MISMATCH in codes) is found


@pytest.mark.parametrize(
    ("named", "starts"), [(True, ""), (True, "joint_state_broadcaster"), (False, "")]
)
@pytest.mark.parametrize("case", [(True, "", True), (False, "", False), (True, "base", False)])
def test_controllers_that_nothing_starts_do_not_move_a_robot(tmp_path, named, starts, case):
    gazebo, instruction, found = case
    spawner = '<node pkg="controller_manager" exec="spawner" args="base"/>'
    started = "ros_gz_sim)/launch/gz_sim" if named else "gazebo_ros)/launch/gazebo"
    world = f'<include file="$(find-pkg-share {started}.launch.py"/>'
    launch = LAUNCH.replace(spawner, spawner.replace("base", starts) if starts else "")
    launch = launch.replace("</launch>", world + "</launch>") if gazebo else launch
    path = spawned(tmp_path, named=named, launch=launch)
    settings = path.parent / "settings" / "base.yaml"
    publisher = (
        "\n    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}"
    )
    text = settings.read_text().replace("0.4", "0.2")
    settings.write_text(text.replace("    base:", f"{publisher[1:]}\n    base:"))
    (path.parent / "README.md").write_text(f"Start the controller_manager, and {instruction}")
    reported = [each for each in check(path).findings if each.code is CONTROLLERS_NOT_FOUND]
    reasons = [each.code for each in try_robot(path, standing=1.0).faults]
    if gazebo:
        assert [each.values.get("controllers") for each in reported] == [("base",)] * found
    assert (CONTROLLERS_NOT_FOUND in reasons) is found
