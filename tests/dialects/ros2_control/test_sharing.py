"""Joints that two controllers command by different interfaces, as in ROS 2."""

import pytest
from tests.coded import coded
from tests.dialects.ros2_control.test_manager import STATES, switch
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.codes import running

FLOATS = "std_msgs/msg/Float64MultiArray"
CLASSIC, GZ = "libgazebo_ros2_control.so", "gz_ros2_control-system"


@pytest.fixture
def shared(bench):
    """Controllers of the position and the velocity of one joint, of which the first one runs."""

    def make(plugin, first="position"):
        groups = {
            name: {
                "type": f"{name}_controllers/JointGroup{name.capitalize()}Controller",
                "joints": ["beam_joint"],
            }
            for name in ("position", "velocity")
        }
        body = beam("beam", "world", axis="0 0 1", kind="continuous")
        body += system(ros2_joint("beam_joint", "position", "velocity"))
        text = robot(body, ros2_plugin())
        if plugin == CLASSIC:
            text = text.replace(GZ, CLASSIC)
            text = text.replace("gz_ros2_control/GazeboSim", "gazebo_ros2_control/Gazebo")
        made = bench(text, ros2_parameters(states=STATES, **groups))
        made.world.run(0.1)
        if first == "velocity":
            assert switch(made, ["velocity"], ["position"]).ok
        return made

    return make


def rate(made):
    before = made.position("beam_joint")
    made.world.run(0.2)
    return (made.position("beam_joint") - before) / 0.2


@pytest.mark.parametrize(("plugin", "followed"), [(CLASSIC, "position"), (GZ, "velocity")])
@pytest.mark.parametrize("second", ["position", "velocity"])
def test_a_joint_follows_one_of_two_commands(shared, plugin, followed, second):
    made = shared(plugin, "velocity" if second == "position" else "position")
    assert switch(made, [second]).ok
    (reported,) = coded(made.warnings, running.JOINT_SHARED)
    ignored = "position" if followed == "velocity" else "velocity"
    assert reported.values == {"joint": "beam_joint", "controller": ignored, "followed": followed}
    made.publish("/velocity/commands", FLOATS, data=[0.5])
    made.publish("/position/commands", FLOATS, data=[0.3])
    made.world.run(1.0)
    if followed == "velocity":
        assert rate(made) == pytest.approx(0.5, rel=1e-3)
    else:
        assert made.position("beam_joint") == pytest.approx(0.3, abs=1e-4)
    # Without it, the joint follows the other one.
    assert switch(made, (), [followed]).ok
    made.publish("/velocity/commands", FLOATS, data=[0.4])
    made.publish("/position/commands", FLOATS, data=[0.2])
    made.world.run(3.0)
    if ignored == "velocity":
        assert rate(made) == pytest.approx(0.4, rel=1e-3)
    else:
        assert made.position("beam_joint") == pytest.approx(0.2, abs=1e-4)


def test_after_a_reset_the_joint_follows_the_same_command(shared):
    made = shared(CLASSIC, "velocity")
    assert switch(made, ["position"]).ok
    made.world.reset()
    made.world.run(0.1)
    made.publish("/velocity/commands", FLOATS, data=[0.5])
    made.publish("/position/commands", FLOATS, data=[0.3])
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.3, abs=1e-4)


def test_controllers_in_a_file_do_not_share_joints_unless_a_launch_file_starts_both(shared):
    """A file often contains alternatives."""
    made = shared(CLASSIC)
    (refused,) = coded(made.warnings, running.CONTROLLER_NOT_STARTED)
    assert refused.values["controller"] == "velocity"
    assert not coded(made.warnings, running.JOINT_SHARED)


def test_a_trajectory_controller_of_both_interfaces_shares_none(bench):
    arm = {
        "type": "joint_trajectory_controller/JointTrajectoryController",
        "joints": ["beam_joint"],
        "command_interfaces": ["position", "velocity"],
    }
    group = {"type": "velocity_controllers/JointGroupVelocityController", "joints": ["beam_joint"]}
    body = beam("beam", "world") + system(ros2_joint("beam_joint", "position", "velocity"))
    made = bench(robot(body, ros2_plugin()), ros2_parameters(arm=arm, group=group))
    made.world.run(0.1)
    assert not switch(made, ["group"]).ok
