"""Hardware of ``<ros2_control>`` for Gazebo, and the plugins that run it."""

import pytest
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_system

import cartwheel
from cartwheel.codes.devices import HARDWARE_WITHOUT_PLUGIN
from cartwheel.corpus import try_robot

MANAGER = '<plugin filename="{file}" name="c"/>'


def arm(plugin, *, hardware="gz_ros2_control/GazeboSimSystem"):
    system = ros2_system(ros2_joint("beam_joint"))
    start, end = system.index("<plugin>") + len("<plugin>"), system.index("</plugin>")
    return robot(beam("beam", "world") + system[:start] + hardware + system[end:], plugin)


@pytest.mark.parametrize(
    ("text", "plugin"),
    [
        (arm(""), "gz_ros2_control-system"),
        (arm("", hardware="gazebo_ros2_control/GazeboSystem"), "libgazebo_ros2_control.so"),
        (arm("", hardware="mock_components/GenericSystem"), None),
        (arm(MANAGER.format(file="gz_ros2_control-system")), None),
        (arm(MANAGER.format(file="libmy_control.so")), None),
    ],
)
def test_hardware_for_gazebo_needs_its_plugin(tmp_path, text, plugin):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    found = [e for e in cartwheel.check(path).findings if e.code is HARDWARE_WITHOUT_PLUGIN]
    assert [each.values["plugin"] for each in found] == [plugin] * (plugin is not None)


def test_without_it_the_robot_should_move_and_does_not(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(arm(""))
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("controller", HARDWARE_WITHOUT_PLUGIN, "file")
    assert verdict.should_move
    assert not verdict.moves
