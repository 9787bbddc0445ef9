"""Commands of leg motors as targets, without a simulation."""

import math
from types import SimpleNamespace

import pytest

from cartwheel.devices.joints.leg_motor import LegMotorTarget, leg_motor_target
from cartwheel.devices.joints.limits import JointLimits

LIMITS = JointLimits(lower=-1.0, upper=2.0, velocity=5.0, effort=10.0)


def command(mode=0x0A, **values):
    numbers = {"q": 0.5, "dq": 1.0, "tau": 3.0, "Kp": 20.0, "Kd": 2.0, **values}
    return SimpleNamespace(mode=mode, **numbers)


def test_a_command_sets_gains_and_targets():
    target = leg_motor_target(command(), LIMITS)
    assert (target.position, target.velocity, target.torque) == (0.5, 1.0, 3.0)
    assert (target.gains.p, target.gains.d) == (20.0, 2.0)


def test_targets_are_limited():
    target = leg_motor_target(command(q=9.0, dq=-9.0, tau=99.0), LIMITS)
    assert (target.position, target.velocity, target.torque) == (2.0, -5.0, 10.0)


def test_markers_disable_gains():
    target = leg_motor_target(command(q=2.146e9, dq=16000.0), LIMITS)
    assert (target.gains.p, target.gains.d) == (0.0, 0.0)


def test_the_brake_mode_only_damps():
    assert leg_motor_target(command(mode=0), LIMITS) == LegMotorTarget()
    assert LegMotorTarget().gains.d > 0


@pytest.mark.parametrize("message", [command(mode=3), command(tau=math.nan), command(Kp=math.inf)])
def test_other_modes_and_invalid_numbers_are_ignored(message):
    assert leg_motor_target(message, LIMITS) is None
