"""Joints with PID controllers, without a simulation."""

import math

import pytest

from cartwheel.devices.joints.limits import JointLimits
from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.pid_joint import PidJoint, PidJointConfig, PidLoop, PidLoopConfig

GAINS = PidGains(p=10.0, d=1.0)


class Joint:
    """A joint that records its command."""

    def __init__(self, position=0.0, velocity=0.0, kind="revolute"):
        self.position, self.velocity, self.effort = position, velocity, 0.25
        self.type, self.limits, self.lightness = kind, JointLimits(lower=-1.0, upper=1.0), 0.0
        self.command = math.nan

    qposadr = dofadr = 0

    @property
    def state(self):
        return self

    @property
    def qpos(self):
        return [self.position]

    @property
    def qvel(self):
        return [self.velocity]

    def error(self, target):
        return target - self.position

    def set_effort(self, command):
        self.applied = command

    def tune(self, pid):
        self.tuned = pid


def test_it_starts_at_the_current_position():
    held = PidJoint(Joint(position=0.4), PidJointConfig(gains=GAINS, quantity="position"))
    held.start()
    assert held.target == 0.4


@pytest.mark.parametrize(("kind", "error"), [("revolute", 0.5), ("continuous", 2.5)])
def test_positions_are_limited_unless_the_joint_is_continuous(kind, error):
    joint = Joint(position=0.5, velocity=2.0, kind=kind)
    held = PidJoint(joint, PidJointConfig(gains=GAINS, quantity="position"))
    held.start()
    held.target = 3.0
    found, output = held.update(0.01)
    assert found == error
    # The target does not change after the first update, so only the joint's velocity is damped.
    assert output == pytest.approx(10 * error - 1.0 * 2.0)


def test_a_velocity_may_be_the_output():
    joint = Joint(velocity=0.5)
    config = PidJointConfig(gains=PidGains(p=2.0), quantity="velocity", commands_effort=False)
    held = PidJoint(joint, config)
    held.start()
    held.target = 1.5
    assert held.update(0.01) == (1.0, pytest.approx(2.0))
    assert joint.command == pytest.approx(2.0)


def loop(quantity, *references, damped=False, **more):
    config = {"feedforward_gain": 0.0, "wraparound": False, **more}
    joint = Joint(position=0.2, velocity=0.5)
    made = PidLoop(
        joint,
        joint,
        references,
        PidLoopConfig(gains=GAINS, quantity=quantity, damped=damped, **config),
    )
    return made, joint


@pytest.mark.parametrize(
    ("quantity", "measured"),
    [("position", (0.2, 0.5)), ("velocity", (0.5, None)), ("effort", (0.25, None))],
)
def test_a_loop_measures_its_quantity(quantity, measured):
    value, rate = loop(quantity, Joint())[0].measure()
    assert value == measured[0]
    assert math.isnan(rate) if measured[1] is None else rate == measured[1]


def test_without_a_reference_nothing_is_commanded():
    made, joint = loop("position", Joint())
    made.measured = made.measure()
    made.update(0.01, feedforward=True)
    assert math.isnan(joint.command)


def test_feedforward_is_added_if_it_is_enabled():
    outputs = []
    for feedforward in (False, True):
        made, joint = loop("velocity", Joint(), feedforward_gain=3.0)
        made.reference, made.measured = (1.0, math.nan), made.measure()
        made.update(0.01, feedforward=feedforward)
        outputs.append(joint.command)
    assert outputs[1] - outputs[0] == pytest.approx(3.0)


def test_errors_may_take_the_shorter_way():
    made, _ = loop("position", Joint(), wraparound=True)
    made.reference, made.measured = (0.2 + 1.5 * math.pi, math.nan), made.measure()
    assert made.error == pytest.approx(-0.5 * math.pi)
