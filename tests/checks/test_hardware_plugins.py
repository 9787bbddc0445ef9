"""Hardware of ``<ros2_control>`` for Gazebo, and the plugins that run it."""

import pytest
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_system,
    transmission,
)

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


SPAWN = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'


@pytest.mark.parametrize(
    ("plugin", "gazebo", "controllers", "reported"),
    [
        ("", SPAWN, "arm_controller", True),
        ("", "", "arm_controller", False),
        ("", SPAWN, "joint_state_controller", False),
        (ROS1, SPAWN, "arm_controller", False),
        (ROS1.replace("libgazebo_ros_control", "libmy_control"), SPAWN, "arm_controller", False),
    ],
)
def test_transmissions_need_the_plugin_that_runs_controllers(
    tmp_path, plugin, gazebo, controllers, reported
):
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "arm.urdf").write_text(
        robot(beam("beam", "world") + transmission("beam_joint", "Effort"), plugin)
    )
    (tmp_path / "arm.launch").write_text(
        f'<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>{gazebo}'
        f'<node name="c" pkg="controller_manager" type="spawner" args="{controllers}"/></launch>'
    )
    verdict = try_robot(tmp_path / "arm.urdf", standing=1.0)
    found = [
        (each.test, each.source) for each in verdict.faults if each.code is HARDWARE_WITHOUT_PLUGIN
    ]
    assert found == [("controller", "file")] * reported
    assert not reported or verdict.outcome == "file"
