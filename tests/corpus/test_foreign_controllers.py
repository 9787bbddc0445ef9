"""Controllers of ROS 1 that a launch file starts, but whose parameters no file contains."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.codes.devices import CONTROLLER_UNDEFINED
from cartwheel.corpus import try_robot

YAML = """lift:
  type: position_controllers/JointPositionController
  joint: beam_joint
"""
LAUNCH = """<launch>
<param name="robot_description" textfile="$(find arm)/arm.urdf"/>
<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>
{load}
<node name="c" pkg="controller_manager" type="spawner" args="{started}"/>
</launch>"""
LOAD = '<rosparam file="$(find {package})/config/{file}.yaml"/>'
OWN = LOAD.format(package="arm", file="arm")
ABSENT = LOAD.format(package="arm", file="arms")
FOREIGN = LOAD.format(package="other_arm", file="arms")


@pytest.mark.parametrize(
    ("load", "started", "sources"),
    [
        (OWN, "lift", []),
        (OWN, "lift turn", ["file"]),
        (OWN, "lift joint_state_controller", []),
        # The file near it contains another controller, which nothing starts.
        (ABSENT, "turn", ["file"]),
        # The package may contain it.
        (FOREIGN, "turn", ["unknown"]),
        (OWN + FOREIGN, "lift turn", ["unknown"]),
    ],
)
def test_a_controller_without_parameters_is_a_fault_although_others_move_the_robot(
    tmp_path, load, started, sources
):
    (tmp_path / ".gitignore").write_text("")
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "arm.yaml").write_text(YAML)
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    path = tmp_path / "arm.urdf"
    path.write_text(robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1))
    (tmp_path / "arm.launch").write_text(LAUNCH.format(load=load, started=started))
    verdict = try_robot(path, standing=0.5)
    assert verdict.reaches
    found = [each for each in verdict.faults if each.code is CONTROLLER_UNDEFINED]
    assert [(each.subject, each.source) for each in found] == [("turn", each) for each in sources]
    assert verdict.outcome == (sources[0] if sources else "good")


def test_controllers_of_another_robot_of_the_launch_file_are_no_fault(tmp_path):
    """Their parameters may be in another repository."""
    other = """<group ns="other">
<param name="robot_description" command="xacro $(find other_arm)/arm.urdf"/>
<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>
<node name="c" pkg="controller_manager" type="spawner" args="turn"/>
</group></launch>"""
    (tmp_path / ".gitignore").write_text("")
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "arm.yaml").write_text(YAML)
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    path = tmp_path / "arm.urdf"
    path.write_text(robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1))
    launch = LAUNCH.format(load=OWN, started="lift").replace("</launch>", other)
    (tmp_path / "arm.launch").write_text(launch)
    assert [f.reason for f in try_robot(path, standing=0.5).faults] == []
