"""Joints that a drive plugin moves, and that ros2_control lists as well."""

import pytest
from tests.coded import coded
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.codes import running

DRIVE = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
  <wheel_separation>0.3</wheel_separation><wheel_diameter>0.2</wheel_diameter>
  <max_wheel_torque>50</max_wheel_torque></plugin>"""
WHEELS = ("left", "right")
GROUP = {
    "type": "velocity_controllers/JointGroupVelocityController",
    "joints": ["left_joint", "right_joint"],
}
STATES = {"type": "joint_state_broadcaster/JointStateBroadcaster"}


def shared(bench, *commands, order=1, managers=1, drive=DRIVE, classic=False, **controllers):
    body = "".join(beam(each, "world", axis="0 0 1", kind="continuous") for each in WHEELS)
    body += system(*(ros2_joint(f"{each}_joint", *commands) for each in WHEELS))
    manager = ros2_plugin()
    if classic:
        manager = manager.replace("gz_ros2_control-system", "libgazebo_ros2_control.so")
    plugins = "".join((manager * managers, drive)[::order])
    return bench(robot(body, plugins), ros2_parameters(states=STATES, **controllers))


def rate(made):
    made.world.run(1.0)
    before = made.position("left_joint")
    made.world.run(0.5)
    return (made.position("left_joint") - before) / 0.5


@pytest.mark.parametrize("order", [1, -1], ids=["controllers first", "drive first"])
@pytest.mark.parametrize(
    "commands", [("velocity",), ("position", "velocity"), ("effort",)], ids=str
)
def test_the_drive_moves_a_joint_that_no_controller_commands(bench, order, commands):
    """As in Gazebo, where the motor of the drive acts in each step."""
    made = shared(bench, *commands, order=order)
    assert not coded(made.warnings, running.JOINT_DRIVEN_TWICE)
    made.publish("/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": 0.2})
    assert rate(made) == pytest.approx(2.0, rel=1e-3)


def test_a_controller_and_a_drive_on_one_joint_are_reported(bench):
    made = shared(bench, "velocity", group=GROUP)
    made.world.run(0.1)
    found = coded(made.warnings, running.JOINT_DRIVEN_TWICE)
    assert {each.values["joint"] for each in found} == {"left_joint", "right_joint"}


def test_without_a_drive_a_joint_is_held(bench):
    made = shared(bench, "velocity", drive="")
    joint = made.model.joints["left_joint"]
    made.world.run(0.1)
    joint.effort = 0.1
    assert abs(rate(made)) < 1e-6


def test_two_managers_of_one_joint_are_reported_and_hold_it(bench):
    made = shared(bench, "velocity", drive="", managers=2)
    assert coded(made.warnings, running.JOINT_DRIVEN_TWICE, joint="left_joint")
    made.world.run(0.1)
    made.model.joints["left_joint"].effort = 0.1
    assert abs(rate(made)) < 1e-6


def test_the_command_of_the_last_of_two_drives_stays(bench):
    """Longer than the time after which all rotors are set to their commands again.

    In Gazebo, each drive commands its wheels at each update, so the last one wins.
    """
    again = DRIVE.replace('name="drive"', 'name="again"').replace(
        "<left_joint>", "<command_topic>/again</command_topic><left_joint>"
    )
    made = shared(bench, "effort", drive=DRIVE + again)
    assert coded(made.warnings, running.JOINT_DRIVEN_TWICE, joint="left_joint")
    made.publish("/again", "geometry_msgs/msg/Twist", linear={"x": 0.1})
    made.world.run(0.5)
    made.publish("/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": 0.2})
    assert rate(made) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("commands", [("velocity",), ("position", "velocity")], ids=str)
@pytest.mark.parametrize(
    ("order", "classic", "turns"),
    [
        # In gz-sim, both set the same command, so the last one in the file wins.
        (1, False, "drive"),
        (-1, False, "controller"),
        # gazebo_ros2_control sets a velocity, which the motor of the drive changes in each step.
        (1, True, "drive"),
        (-1, True, "drive"),
    ],
)
def test_of_a_controller_and_a_drive_one_has_no_effect(bench, commands, order, classic, turns):
    made = shared(bench, *commands, order=order, classic=classic, group=GROUP)
    made.world.run(0.1)
    assert coded(made.warnings, running.JOINT_DRIVEN_TWICE, joint="left_joint")

    def drive(speed):
        made.publish("/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": speed})

    def control(speed):
        made.publish("/group/commands", "std_msgs/msg/Float64MultiArray", data=[speed, speed])

    effective, ignored = (drive, control) if turns == "drive" else (control, drive)
    ignored(0.3)
    assert abs(rate(made)) < 1e-6
    effective(0.2)
    assert rate(made) == pytest.approx(2.0 if turns == "drive" else 0.2, rel=1e-3)
    ignored(0.1)
    assert rate(made) == pytest.approx(2.0 if turns == "drive" else 0.2, rel=1e-3)


def test_a_drive_turns_its_wheels_again_when_their_controller_stops(bench):
    made = shared(bench, "velocity", order=-1, group=GROUP)
    made.world.run(0.1)
    made.publish("/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": 0.2})
    assert abs(rate(made)) < 1e-6
    made.call(
        "/controller_manager/switch_controller", deactivate_controllers=["group"], strictness=2
    )
    made.world.run(0.1)
    made.publish("/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": 0.2})
    assert rate(made) == pytest.approx(2.0, rel=1e-3)
