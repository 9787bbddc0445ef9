"""unitree_legged_control: commands that bring their gains along."""

import math

import pytest
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    INERTIA,
    MASS,
    ROS1,
    beam,
    robot,
    transmission,
)

WEIGHT = MASS * GRAVITY * ARM
TURNED = INERTIA + MASS * ARM**2
"""kg m², about the joint."""
TYPE = "unitree_legged_control/UnitreeJointController"
COMMAND = "unitree_legged_msgs/msg/MotorCmd"
SERVO, BRAKE = 10, 0
UPRIGHT = "0 0 1"


@pytest.fixture
def motor(bench):
    def make(**more):
        body = beam("beam", "world", **more) + transmission("beam_joint", "Effort")
        parameters = {"c": {"type": TYPE, "joint": "beam_joint", "pid": {"p": 9.0, "d": 1.0}}}
        return bench(robot(body, ROS1), parameters)

    return make


def test_a_position_sags_by_what_the_weight_asks_of_its_gain(motor):
    made = motor()
    made.publish("/c/command", COMMAND, mode=SERVO, q=0.5, Kp=400.0, Kd=40.0)
    box = made.box("/c/state")
    made.world.run(4.0)
    angle = made.position("beam_joint")
    held = -WEIGHT * math.cos(angle)
    assert 400.0 * (0.5 - angle) == pytest.approx(held, rel=0.01)
    state = box.drain()[-1]
    assert (state.q, state.dq) == pytest.approx((angle, 0.0), abs=1e-4)
    assert state.tauEst == pytest.approx(held, rel=0.01)
    assert made.warnings == []


def test_a_torque_accelerates(motor):
    made = motor(axis=UPRIGHT)
    made.publish("/c/command", COMMAND, mode=SERVO, tau=3.0)
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.5 * 3.0 / TURNED * 0.5**2, rel=0.03)


def test_a_torque_is_limited_to_the_joint_s(motor):
    limit = 'lower="-3" upper="3" effort="2" velocity="100"'
    made = motor(axis=UPRIGHT, limit=limit)
    made.publish("/c/command", COMMAND, mode=SERVO, tau=50.0)
    made.world.run(0.5)
    assert made.position("beam_joint") == pytest.approx(0.5 * 2.0 / TURNED * 0.5**2, rel=0.03)


def test_it_brakes_before_its_first_command_and_when_it_is_commanded(motor):
    """The weight sinks at the speed at which 20 N m s/rad bear it, once it has gathered it."""
    made = motor()
    made.world.run(0.2)
    late = TURNED / 20.0
    angle = made.position("beam_joint")
    assert angle == pytest.approx((0.2 - late) * WEIGHT / 20.0, rel=0.05)
    made.publish("/c/command", COMMAND, mode=SERVO, tau=-40.0)
    made.world.run(0.2)
    made.publish("/c/command", COMMAND, mode=BRAKE)
    made.world.run(0.3)
    before = made.position("beam_joint")
    made.world.run(0.1)
    sunk = made.position("beam_joint") - before
    assert sunk == pytest.approx(0.1 * WEIGHT * math.cos(before) / 20.0, rel=0.05)


def test_a_velocity_is_held_where_no_position_is_wanted(motor):
    made = motor(axis=UPRIGHT)
    made.publish("/c/command", COMMAND, mode=SERVO, q=2.146e9, Kp=500.0, dq=0.5, Kd=30.0)
    made.world.run(0.5)
    before = made.position("beam_joint")
    made.world.run(1.0)
    assert made.position("beam_joint") - before == pytest.approx(0.5, rel=0.01)


def test_no_velocity_leaves_the_position_undamped(motor):
    """It swings about the target, as far beyond it as it began before it."""
    made = motor(axis=UPRIGHT)
    made.publish("/c/command", COMMAND, mode=SERVO, q=0.5, Kp=10.0, dq=16000.0, Kd=30.0)
    half = math.pi * math.sqrt(TURNED / 10.0)
    made.world.run(half)
    assert made.position("beam_joint") == pytest.approx(1.0, abs=0.03)


def test_other_modes_change_nothing(motor):
    made = motor(axis=UPRIGHT)
    made.publish("/c/command", COMMAND, mode=SERVO, q=0.5, Kp=400.0, Kd=40.0)
    made.publish("/c/command", COMMAND, mode=3, q=-0.5, Kp=400.0, Kd=40.0)
    made.world.run(2.0)
    assert made.position("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_a_manual_position_is_a_command_with_the_gains_of_the_file(bench):
    body = beam("beam", "world", axis=UPRIGHT) + transmission("beam_joint", "Effort")
    parameters = {"c": {"type": TYPE, "joint": "beam_joint", "pid": {"p": 50.0, "d": 10.0}}}
    made = bench(robot(body, ROS1), parameters)
    box = made.box("/c/command")
    made.world.run(0.02)
    (manual,) = made.world.graph.joint_inputs.all()
    manual.put({"beam_joint": 0.4}, 0.0)
    made.world.run(4.0)
    assert made.position("beam_joint") == pytest.approx(0.4, abs=0.01)
    (command,) = box.drain()
    assert (command.mode, command.Kp, command.Kd) == (SERVO, 50.0, 10.0)
