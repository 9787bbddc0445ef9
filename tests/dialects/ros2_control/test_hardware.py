"""Which of the hardware in several <ros2_control> elements counts for a joint."""

import pytest

from cartwheel.description import load_text
from cartwheel.dialects.ros_control.interfaces import SYSTEMS, ros2_control

ROBOT = """<robot name="arm"><link name="base"/><link name="upper"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/></joint>
{systems}<gazebo><plugin name="control" filename="{plugin}"/></gazebo></robot>"""
SYSTEM = """<ros2_control name="{name}" type="system"><hardware><plugin>{hardware}</plugin>
</hardware><joint name="shoulder"><command_interface name="{command}"/></joint></ros2_control>"""
CLASSIC, GZ, IGN = SYSTEMS


@pytest.mark.parametrize(
    ("plugin", "used", "other"),
    [
        ("libgazebo_ros2_control.so", CLASSIC, GZ),
        ("gz_ros2_control-system", GZ, CLASSIC),
        ("libign_ros2_control-system.so", IGN, CLASSIC),
    ],
)
@pytest.mark.parametrize("order", [1, -1])
def test_the_hardware_that_the_plugin_can_load_counts(plugin, used, other, order):
    systems = [
        SYSTEM.format(name="one", hardware=used, command="position"),
        SYSTEM.format(name="other", hardware=other, command="effort"),
    ][::order]
    robot = load_text(ROBOT.format(systems="".join(systems), plugin=plugin), file="r.urdf")
    (joint,), _, _ = ros2_control(robot)
    assert joint.commands == ("position",)


def test_the_hardware_of_another_gazebo_is_used_if_there_is_no_other():
    system = SYSTEM.format(name="one", hardware=CLASSIC, command="effort")
    robot = load_text(ROBOT.format(systems=system, plugin="gz_ros2_control-system"), file="r.urdf")
    (joint,), _, _ = ros2_control(robot)
    assert joint.commands == ("effort",)
