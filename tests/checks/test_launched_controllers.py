"""Controller files that only a launch file names."""

import pytest
from tests.corpus.carts import cart, controlled

from cartwheel.checks import controller_search
from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_UNDEFINED
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot

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
    control = text if named else text.replace(tag, "")
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

    monkeypatch.setattr(controller_search, "launches_near", near)
    (tmp_path / "package.xml").write_text("<package><name>hall</name></package>")
    control = '<plugin filename="gz_ros2_control-system" name="c"/>'
    models = "".join(
        f'<model name="m{number}"><link name="l"/>{control}</model>' for number in range(3)
    )
    path = tmp_path / "hall.world"
    path.write_text(f'<sdf version="1.6"><world name="hall">{models}</world></sdf>')
    check(path)
    assert len(read) == 1
