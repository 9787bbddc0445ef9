"""Which of the hardware in several <ros2_control> elements counts for a joint."""

import pytest

from cartwheel.description import load_text
from cartwheel.dialects.ros_control.interfaces import SYSTEMS, ros2_control

ROBOT = """<robot name="arm"><link name="base"/><link name="upper"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
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


@pytest.mark.parametrize("between", ["", "</ros2_control><ros2_control name='b' type='system'>"])
def test_a_joint_that_is_listed_twice_has_the_interfaces_of_both(between):
    """As in ros2_control, which exports each interface of each entry."""
    joint = (
        '<joint name="shoulder"><command_interface name="{}"/>{}'
        '<state_interface name="{}"/></joint>'
    )
    hardware = f"<hardware><plugin>{GZ}</plugin></hardware>"
    gain = '<param name="pos_kp">3</param>'
    start = (
        '<state_interface name="position"><param name="initial_value">0.3</param></state_interface>'
    )
    first = joint.format("velocity", gain + start, "velocity")
    second = joint.format("position", "", "velocity")
    text = (
        f"<ros2_control name='a' type='system'>{hardware}{first}"
        f"{between}{hardware if between else ''}{second}</ros2_control>"
    )
    robot = load_text(ROBOT.format(systems=text, plugin="gz_ros2_control-system"), file="r.urdf")
    (found,), _, _ = ros2_control(robot)
    assert found.commands == ("velocity", "position")
    assert found.states == ("position", "velocity")
    assert found.initial_position == 0.3
    assert found.gains == {"pos_kp": 3.0}
