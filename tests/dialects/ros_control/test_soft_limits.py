"""Soft limits of a <safety_controller>, and limits that are ROS 1's parameters."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.errors import PluginError

HARD = 'lower="-2" upper="2" effort="50" velocity="1"'
SOFT = (
    '<safety_controller soft_lower_limit="-1" soft_upper_limit="0.8" k_position="5" '
    'k_velocity="100"/></joint>'
)


def spawn(bench, kind, interface, *, soft=SOFT, axis="0 0 1", **limits):
    """One joint, about the vertical, with a controller ``one`` of an interface."""
    body = beam("beam", "world", axis=axis, limit=HARD)
    if soft:
        body = body[: body.rindex("</joint>")] + soft
    urdf = robot(body + transmission("beam_joint", interface), ROS1)
    content = {"one": {"type": kind, "joint": "beam_joint"}}
    if limits:
        content["joint_limits"] = {"beam_joint": limits}
    made = bench(urdf, content)
    made.world.run(0.1)
    return made


def command(made, value):
    made.publish("/one/command", "std_msgs/msg/Float64", data=value)


def test_a_position_ends_at_the_soft_limit_and_slows_before_it(bench):
    made = spawn(bench, "position_controllers/JointPositionController", "Position")
    command(made, 1.5)
    made.world.run(0.5)
    # Far from it the joint's own velocity counts, 1 rad/s; nearer 5/s times the way: within
    # 0.2 rad it nears the limit as an exponential.
    assert made.position("beam_joint") == pytest.approx(0.5, abs=0.03)
    made.world.run(0.4)
    near = 0.8 - made.position("beam_joint")
    assert 0.02 < near < 0.1
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.8, abs=0.005)
    command(made, -1.5)
    made.world.run(4.0)
    assert made.position("beam_joint") == pytest.approx(-1.0, abs=0.005)


def test_a_velocity_ends_at_the_soft_limit(bench):
    made = spawn(bench, "velocity_controllers/JointVelocityController", "Velocity")
    command(made, 0.9)
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.45, abs=0.02)
    made.world.run(3.0)
    assert made.position("beam_joint") == pytest.approx(0.8, abs=0.01)


def test_an_effort_drives_no_faster_than_the_velocity_and_stops_too(bench):
    made = spawn(bench, "effort_controllers/JointEffortController", "Effort")
    command(made, 20.0)
    made.world.run(0.4)
    before = made.position("beam_joint")
    made.world.run(0.1)
    assert (made.position("beam_joint") - before) / 0.1 == pytest.approx(1.0, abs=0.05)
    made.world.run(4.0)
    assert made.position("beam_joint") == pytest.approx(0.8, abs=0.01)


def test_a_safety_controller_without_a_position_gain_holds_the_joint(bench):
    """As ros_control: no gain allows no velocity."""
    soft = '<safety_controller k_velocity="100"/></joint>'
    made = spawn(bench, "position_controllers/JointPositionController", "Position", soft=soft)
    command(made, 0.5)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.0, abs=0.01)


def test_parameters_go_before_the_description(bench):
    made = spawn(
        bench, "position_controllers/JointPositionController", "Position", soft="",
        has_velocity_limits=True, max_velocity=0.25,
        has_position_limits=True, min_position=-0.5, max_position=0.5,
    )  # fmt: skip
    command(made, 1.5)
    made.world.run(1.0)
    assert made.position("beam_joint") == pytest.approx(0.25, abs=0.02)
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=0.005)


def test_a_limit_that_is_no_number_is_reported(bench):
    with pytest.raises(PluginError) as caught:
        spawn(
            bench, "position_controllers/JointPositionController", "Position",
            has_velocity_limits=True, max_velocity="fast",
        )  # fmt: skip
    assert caught.value.values["parameter"].endswith("max_velocity")
