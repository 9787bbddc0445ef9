"""Limits of efforts, velocities and positions that a program sets while motors run."""

import math

import pytest
import yaml
from tests.coded import raises
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

from cartwheel.codes.world import PROPERTY_ABSENT, UNKNOWN_MODEL, VALUE_INVALID
from cartwheel.errors import UnknownNameError

WEIGHT = MASS * GRAVITY * ARM
"""N m, of the horizontal beam. Positive angles are below."""


@pytest.fixture
def arm(make, tmp_path):
    """Spawns a beam with a controller of ros_control; returns the model and its joint."""

    def spawn(interface, *, effort=100.0, velocity=10.0, upper=3.0, world=None):
        kind = {"Position": "Position", "Velocity": "Velocity", "Effort": "Effort"}[interface]
        own = {
            "type": f"{interface.lower()}_controllers/Joint{kind}Controller",
            "joint": "beam_joint",
        }
        file = tmp_path / "own.yaml"
        file.write_text(yaml.safe_dump({"c": own}))
        limit = f'lower="-3" upper="{upper}" effort="{effort}" velocity="{velocity}"'
        text = robot(
            beam("beam", "world", limit=limit) + transmission("beam_joint", interface), ROS1
        )
        model = (world or make.world(ground=None)).spawn(text, controllers=file)
        return model, model.joints["beam_joint"]

    return spawn


def world_of(model):
    return model._world


@pytest.mark.parametrize("stated", [100.0, 1.0], ids=["strong", "raised"])
def test_a_motor_is_weaker_than_its_file_and_strong_again(arm, stated):
    """Below the weight, it falls; above, it holds. A file's limit of 1 N m is raised."""
    model, joint = arm("Position", effort=stated)
    world = world_of(model)
    assert joint.effort_limit == pytest.approx(stated if stated > WEIGHT else 2 * WEIGHT, rel=0.01)
    model.publish("c/command", data=-0.2)
    world.run(1.0)
    assert joint.position == pytest.approx(-0.2, abs=1e-3)
    joint.effort_limit = 0.5 * WEIGHT
    assert joint.effort_limit == 0.5 * WEIGHT
    world.run(0.2)
    assert joint.effort == pytest.approx(-0.5 * WEIGHT, rel=1e-3)
    world.run(3.0)
    assert joint.position > 0.5
    for limit in (1.5 * WEIGHT, None):
        joint.effort_limit = limit
        assert joint.effort_limit == limit
        world.run(3.0)
        assert joint.position == pytest.approx(-0.2, abs=1e-3)


def test_a_limit_above_that_of_the_file_counts(arm):
    """Half the weight does not hold the beam, and twice the weight accelerates it upward."""
    model, joint = arm("Effort", effort=0.5 * WEIGHT)
    world = world_of(model)
    model.publish("c/command", data=-2 * WEIGHT)
    world.run(0.1)
    assert joint.velocity > 0
    joint.effort_limit = 10 * WEIGHT
    world.run(0.01)
    joint.position = 0.0
    world.run(0.02)
    inertia = MASS * ARM**2 + 0.1
    assert joint.velocity == pytest.approx(-WEIGHT / inertia * 0.02, rel=0.02)
    assert joint.effort == pytest.approx(-2 * WEIGHT)


@pytest.mark.parametrize("interface", ["Position", "Velocity"])
def test_a_velocity_limit_slows_commands(arm, interface):
    model, joint = arm(interface)
    world = world_of(model)
    assert joint.velocity_limit == 10.0
    joint.velocity_limit = 0.5
    assert joint.velocity_limit == 0.5
    model.publish("c/command", data=1.5)
    world.run(1.0)
    assert joint.velocity == pytest.approx(0.5, abs=0.01)
    joint.velocity_limit = None
    assert joint.velocity_limit is None
    world.run(0.2)
    if interface == "Velocity":
        assert joint.velocity == pytest.approx(1.5, abs=0.01)
    else:
        assert joint.position == pytest.approx(1.5, abs=0.02)


def test_position_limits_reach_the_controllers(arm):
    model, joint = arm("Position", upper=0.5)
    world = world_of(model)
    model.publish("c/command", data=1.0)
    world.run(1.0)
    assert joint.position == pytest.approx(0.5, abs=1e-3)
    joint.limits = (-3.0, 2.0)
    world.run(1.0)
    assert joint.position == pytest.approx(1.0, abs=1e-3)
    joint.limits = (-3.0, 0.7)
    world.run(1.0)
    assert joint.position == pytest.approx(0.7, abs=1e-3)


@pytest.mark.parametrize("command", ["position", "velocity"])
def test_joints_of_ros2_control(make, tmp_path, command):
    kind = {
        "position": "position_controllers/JointGroupPositionController",
        "velocity": "velocity_controllers/JointGroupVelocityController",
    }[command]
    file = tmp_path / "own.yaml"
    own = {"type": kind, "joints": ["beam_joint"]}
    file.write_text(yaml.safe_dump(ros2_parameters(200, c=own)))
    text = robot(
        beam("beam", "world") + ros2_system(ros2_joint("beam_joint", command)), ros2_plugin(file)
    )
    world = make.world(ground=None)
    model = world.spawn(text)
    joint = model.joints["beam_joint"]
    world.run(0.1)
    joint.effort_limit, joint.velocity_limit = 1.5 * WEIGHT, 0.5
    model.publish("c/commands", data=[-1.0])
    world.run(1.0)
    assert joint.velocity == pytest.approx(-0.5, abs=0.01)
    joint.effort_limit = 0.1 * WEIGHT
    world.run(0.5)
    assert joint.velocity > 0


def test_limits_are_kept_saved_and_restored(arm, make):
    model, joint = arm("Position")
    world = world_of(model)
    model.publish("c/command", data=-0.2)
    world.run(1.0)
    strong = world.save()
    joint.effort_limit, joint.velocity_limit = 0.5 * WEIGHT, 0.25
    weak = world.save()
    world.spawn(make.box("box", (0.2,) * 3), x=5.0)
    world.reset()
    assert (joint.effort_limit, joint.velocity_limit) == (0.5 * WEIGHT, 0.25)
    world.run(3.0)
    assert joint.position > 0.5
    ends = []
    for state, held in ((strong, True), (weak, False), (strong, True), (weak, False)):
        world.restore(state)
        assert (joint.effort_limit, joint.velocity_limit) == (
            (100.0, 10.0) if held else (0.5 * WEIGHT, 0.25)
        )
        world.run(1.0)
        assert (joint.position < -0.19) is held
        ends.append((joint.position, joint.velocity))
    assert ends[:2] == ends[2:]


def test_a_weak_drive_does_not_move(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.05)
    assert cart.joints["wheel_left_joint"].effort_limit == 20.0
    for name in cart.joints.names:
        cart.joints[name].effort_limit = 1e-3
    world.run(0.5)
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(1.0)
    assert abs(cart.velocity.linear[0]) < 0.01
    for name in cart.joints.names:
        cart.joints[name].effort_limit = 20.0
    world.run(1.0)
    assert cart.velocity.linear[0] == pytest.approx(0.5, abs=0.01)


def test_a_motor_that_has_failed(arm, make, rosbots):
    """The joint turns freely: a beam falls, and a wheel rolls."""
    model, joint = arm("Position")
    world = world_of(model)
    world.run(0.1)
    joint.effort_limit = 0.0
    assert joint.effort_limit == 0.0
    world.run(0.1)
    # Its angular acceleration is m g l / (m l² + I).
    assert joint.velocity == pytest.approx(0.1 * WEIGHT / (MASS * ARM**2 + INERTIA), rel=0.02)
    other = make.world()
    cart = other.spawn(rosbots, z=0.05)
    other.run(0.2)
    cart.joints["wheel_left_joint"].effort_limit = 0
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.3)
    other.run(3.0)
    assert cart.pose.yaw > 0.2
    cart.joints["wheel_left_joint"].effort_limit = 20.0
    other.run(1.0)
    assert abs(cart.velocity.angular[2]) < 0.05


def test_limits_that_a_joint_cannot_have(arm, make, rosbots):
    model, joint = arm("Position")
    for name in ("effort_limit", "velocity_limit"):
        for value in (-1.0, math.nan, math.inf, "much"):
            with raises(VALUE_INVALID, name=name):
                setattr(joint, name, value)
    with raises(VALUE_INVALID, name="velocity_limit"):
        joint.velocity_limit = 0.0
    assert (joint.effort_limit, joint.velocity_limit) == (100.0, 10.0)
    cart = world_of(model).spawn(rosbots, name="cart", y=3.0)
    wheel = cart.joints["wheel_left_joint"]
    with raises(PROPERTY_ABSENT, name="wheel_left_joint"):
        wheel.velocity_limit = 1.0
    cart.delete()
    with raises(UNKNOWN_MODEL, UnknownNameError, name="cart"):
        wheel.effort_limit = 1.0
