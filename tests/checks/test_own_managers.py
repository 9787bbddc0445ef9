"""Launch files that start a program of the repository with a controller manager of its own."""

import pytest
import yaml
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_UNDEFINED, HARDWARE_WITHOUT_PLUGIN
from cartwheel.corpus import try_robot

SPAWN = '<node name="m" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
MANAGER = """#include <controller_manager/controller_manager.h>
int main() { controller_manager::ControllerManager manager(&hardware, node); }
"""
MOVE = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}


@pytest.fixture
def arm(tmp_path):
    """Writes a robot, a driver and a launch file that starts both in a namespace.

    `program` is the source of the driver, and `package` that in the launch file.
    """

    def write(plugin, program, *, space="", package="arm"):
        (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
        body = beam("beam", "world", axis="0 0 1") + transmission("beam_joint", "Position")
        (tmp_path / "arm.urdf").write_text(robot(body, plugin))
        (tmp_path / "src").mkdir()
        (tmp_path / "src/driver.cpp").write_text(program)
        content = {"move": MOVE} if not space else {space: {"move": MOVE}}
        (tmp_path / "arm.yaml").write_text(yaml.safe_dump(content))
        (tmp_path / "arm.launch").write_text(
            f'<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>{SPAWN}'
            '<rosparam file="$(find arm)/arm.yaml"/>'
            f'<node name="d" pkg="{package}" type="driver" ns="{space}"/>'
            f'<node name="s" pkg="controller_manager" type="spawner" args="move" ns="{space}"/>'
            "</launch>"
        )
        return tmp_path / "arm.urdf"

    return write


@pytest.mark.parametrize(
    ("program", "package", "outcome", "severity"),
    [
        (MANAGER, "arm", "unknown", "info"),
        ("int main() {}", "arm", "file", "warning"),
        (MANAGER, "another", "file", "warning"),
    ],
)
def test_what_such_a_program_moves_is_unknown(arm, program, package, outcome, severity):
    file = arm("", program, package=package)
    found = [each for each in check(file).findings if each.code is HARDWARE_WITHOUT_PLUGIN]
    assert [each.severity for each in found] == [severity]
    verdict = try_robot(file, standing=0.5)
    assert [each.code for each in verdict.faults] == [HARDWARE_WITHOUT_PLUGIN]
    assert verdict.outcome == outcome


@pytest.mark.parametrize(("program", "reported"), [(MANAGER, False), ("int main() {}", True)])
def test_spawners_may_wait_for_its_manager(arm, program, reported):
    plugin = ROS1.replace(">/<", ">/arm<")
    file = arm(plugin, program, space="real")
    codes = [each.code for each in check(file).findings]
    assert (CONTROLLER_UNDEFINED in codes) == reported
