"""Effort limits of joints with position commands."""

import pytest
import yaml
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    INERTIA,
    MASS,
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
    transmission,
)

from cartwheel.codes import devices

WEIGHT = MASS * GRAVITY * ARM
"""N m, of one horizontal beam."""


@pytest.fixture
def held(bench):
    """Positions of a beam with an effort limit, every 50 ms for 2 s, and the warnings."""

    def make(effort):
        limit = f'lower="-3" upper="3" effort="{effort}" velocity="10"'
        body = beam("beam", "world", limit=limit) + transmission("beam_joint", "Position")
        group = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
        made = bench(robot(body, ROS1), {"c": group})
        made.publish("/c/command", "std_msgs/msg/Float64", data=-0.2)
        places = []
        for _ in range(40):
            made.world.run(0.05)
            places.append(made.position("beam_joint"))
        return places, made.warnings

    return make


def test_an_effort_limit_below_the_weight_is_reported_and_exceeded(held):
    places, warnings = held(1)
    assert places[-1] == pytest.approx(-0.2, abs=1e-3)
    (warning,) = warnings
    assert warning.code is devices.EFFORT_LIMIT_TOO_LOW
    assert warning.values["stated"] == 1
    assert warning.values["needed"] == pytest.approx(9.8, rel=0.01)


def test_an_effort_limit_below_the_friction_is_reported_and_exceeded(bench):
    """The friction of a joint that mimics it counts too: 3 N m, and twice 2 N m."""
    limit = 'lower="-3" upper="3" effort="5" velocity="10"'
    led = 'lower="-6" upper="6" effort="5" velocity="10"'
    body = "".join(
        (
            beam("beam", "world", axis="0 0 1", limit=limit),
            beam("led", "world", axis="0 0 1", limit=led, origin="0 2 1"),
            transmission("beam_joint", "Position"),
        )
    )
    body = body.replace(f"<limit {limit}/>", f'<limit {limit}/><dynamics friction="3"/>')
    mimic = '<dynamics friction="2"/><mimic joint="beam_joint" multiplier="2"/>'
    body = body.replace(f"<limit {led}/>", f"<limit {led}/>{mimic}")
    group = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
    made = bench(robot(body, ROS1), {"c": group})
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.2)
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.2, abs=0.01)
    (warning,) = [each for each in made.warnings if each.code is devices.EFFORT_LIMIT_TOO_LOW]
    assert warning.values["needed"] == pytest.approx(7.0, abs=0.01)


@pytest.mark.parametrize(("velocity", "needed"), [(10, 50.0), (0.2, 20.0)])
def test_an_effort_limit_below_the_damping_is_reported_and_exceeded(bench, velocity, needed):
    """100 N m s/rad at 0.5 rad/s, or at the velocity limit."""
    limit = f'lower="-3" upper="3" effort="2" velocity="{velocity}"'
    body = beam("beam", "world", axis="0 0 1", limit=limit)
    body = body.replace(f"<limit {limit}/>", f'<limit {limit}/><dynamics damping="100"/>')
    body += transmission("beam_joint", "Position")
    group = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
    made = bench(robot(body, ROS1), {"c": group})
    made.publish("/c/command", "std_msgs/msg/Float64", data=0.2)
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.2, abs=0.01)
    (warning,) = [each for each in made.warnings if each.code is devices.EFFORT_LIMIT_TOO_LOW]
    assert warning.values["needed"] == pytest.approx(needed, abs=0.01)


@pytest.mark.parametrize("classic", [True, False])
def test_an_effort_limit_below_the_inertia_is_reported_and_exceeded(bench, tmp_path, classic):
    """Ten beams in line on vertical axes, which gravity does not load; gz-sim has the limit."""
    file, names = tmp_path / "own.yaml", [f"b{number}" for number in range(10)]
    joints = [f"{name}_joint" for name in names]
    settings = {"type": "position_controllers/JointGroupPositionController", "joints": joints}
    file.write_text(yaml.safe_dump(ros2_parameters(200, c=settings)))
    limit = 'lower="-3" upper="3" effort="5" velocity="10"'
    body = "".join(
        beam(name, parent, axis="0 0 1", limit=limit, origin=f"{2 * ARM} 0 0")
        for name, parent in zip(names, ("world", *names), strict=False)
    )
    body += ros2_system(*(ros2_joint(joint) for joint in joints))
    control = ros2_plugin(file)
    if classic:
        body = body.replace("gz_ros2_control/GazeboSimSystem", "gazebo_ros2_control/GazeboSystem")
        control = control.replace("gz_ros2_control-system", "libgazebo_ros2_control.so")
    made = bench(robot(body, control))
    made.publish("/c/commands", "std_msgs/msg/Float64MultiArray", data=[0.2] * len(joints))
    made.world.run(2.0)
    errors = [abs(made.position(joint) - 0.2) for joint in joints]
    warnings = [each for each in made.warnings if each.code is devices.EFFORT_LIMIT_TOO_LOW]
    if not classic:
        assert warnings == []
        assert max(errors) > 0.1
        return
    assert max(errors) < 1e-3
    # The first joint accelerates all beams, each about all joints before it.
    along = [2 * ARM * number + ARM for number in range(10)]
    turned = sum(INERTIA * (n + 1) + MASS * along[n] * sum(along[n] - 2 * ARM * k
                 for k in range(n + 1)) for n in range(10))  # fmt: skip
    (first,) = [each for each in warnings if each.values["joint"] == joints[0]]
    assert first.values["needed"] == pytest.approx(turned)


def test_an_effort_limit_above_the_weight_holds_the_arm(held):
    places, warnings = held(1.02 * WEIGHT)
    assert warnings == []
    assert places[-1] == pytest.approx(-0.2, abs=1e-3)


@pytest.mark.parametrize("classic", [True, False])
def test_gazebo_classic_ignores_the_effort_limit_of_velocities(bench, tmp_path, classic):
    """gazebo_ros2_control sets the velocity of a joint; gz_ros2_control's motor has the limit."""
    file = tmp_path / "own.yaml"
    settings = {
        "type": "velocity_controllers/JointGroupVelocityController",
        "joints": ["beam_joint"],
    }
    file.write_text(yaml.safe_dump(ros2_parameters(200, c=settings)))
    limit = 'lower="-3" upper="3" effort="1" velocity="10"'
    body = beam("beam", "world", limit=limit)
    body += ros2_system(ros2_joint("beam_joint", "velocity"))
    control = ros2_plugin(file)
    if classic:
        control = control.replace("gz_ros2_control-system", "libgazebo_ros2_control.so")
    made = bench(robot(body, control))
    made.world.run(0.1)
    made.publish("/c/commands", "std_msgs/msg/Float64MultiArray", data=[-0.5])
    made.world.run(0.2)
    before = made.position("beam_joint")
    made.world.run(0.5)
    raised = [each for each in made.warnings if each.code is devices.EFFORT_LIMIT_TOO_LOW]
    if classic:
        # Upward, against a weight of 9.8 N m.
        assert made.position("beam_joint") - before == pytest.approx(-0.25, abs=0.01)
        assert raised[0].values["stated"] == 1
    else:
        assert made.position("beam_joint") > before
        assert raised == []


@pytest.mark.parametrize(("classic", "speed"), [(True, 0.5), (False, 0.2)])
def test_gazebo_classic_ignores_the_velocity_limit_of_velocities(bench, tmp_path, classic, speed):
    """gazebo_ros2_control sets the velocity of a joint; gz-sim's physics clips the command."""
    file = tmp_path / "own.yaml"
    settings = {
        "type": "velocity_controllers/JointGroupVelocityController",
        "joints": ["beam_joint"],
    }
    file.write_text(yaml.safe_dump(ros2_parameters(200, c=settings)))
    limit = 'lower="-3" upper="3" effort="100" velocity="0.2"'
    body = beam("beam", "world", axis="0 0 1", limit=limit)
    body += ros2_system(ros2_joint("beam_joint", "velocity"))
    control = ros2_plugin(file)
    if classic:
        control = control.replace("gz_ros2_control-system", "libgazebo_ros2_control.so")
    made = bench(robot(body, control))
    made.world.run(0.1)
    made.publish("/c/commands", "std_msgs/msg/Float64MultiArray", data=[0.5])
    made.world.run(0.2)
    before = made.position("beam_joint")
    made.world.run(0.5)
    assert made.position("beam_joint") - before == pytest.approx(0.5 * speed, rel=0.01)
    # A program's own limit applies in both.
    made.world.model("arm").joints["beam_joint"].velocity_limit = 0.1
    made.world.run(0.2)
    before = made.position("beam_joint")
    made.world.run(0.5)
    assert made.position("beam_joint") - before == pytest.approx(0.05, rel=0.01)
