"""Velocity motors stop at the limits of their joints, however strong they are."""

import math

import pytest

from cartwheel.simulation import Simulation

STRONGEST = 1e6
"""N m; of a motor without a stated limit."""
WHEEL = """<model name="m"><link name="base"/><joint name="bolt" type="fixed"><parent>world</parent>
  <child>base</child></joint><link name="wheel"><inertial><mass>1</mass><inertia><ixx>0.01</ixx>
  <iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link><joint name="turn" type="revolute">
  <parent>base</parent><child>wheel</child><axis><xyz>0 0 1</xyz>{}</axis></joint></model>"""


class Wheel:
    """A wheel whose motors are made by `request`, a function of a part."""

    def __init__(self, make, request, lower=None, upper=None):
        self.handles = []

        def attach(part):
            self.handles += request(part)
            return []

        world = make.world(ground=None).session.simulation.world
        self.simulation = Simulation(world, attach=attach)
        limits = "" if lower is None else f"<lower>{lower}</lower><upper>{upper}</upper>"
        self.simulation.spawn(make.sdf(WHEEL.format(f"<limit>{limits}</limit>")))

    def run(self, seconds):
        self.simulation.advance(self.simulation.time_ns + round(seconds * 1e9))

    @property
    def angle(self):
        return self.simulation.joint_position("m", "turn")


def motor(part, strength=STRONGEST):
    return part.velocity_motor("turn", max_effort=strength)


def servo(part):
    return part.servo("turn", max_effort=STRONGEST)


@pytest.mark.parametrize("strength", [0.5, 50.0, STRONGEST])
@pytest.mark.parametrize("velocity", [2.0, -2.0])
def test_a_motor_stops_at_the_limit_and_returns_at_once(make, velocity, strength):
    wheel = Wheel(make, lambda part: [motor(part, strength)], -0.5, 0.5)
    wheel.handles[0].command(velocity)
    wheel.run(0.2)
    assert wheel.angle == pytest.approx(0.2 * velocity, abs=0.05)
    wheel.run(1.0)
    assert wheel.angle == pytest.approx(math.copysign(0.5, velocity), abs=1e-4)
    wheel.handles[0].command(-velocity)
    wheel.run(0.1)
    assert abs(wheel.angle) == pytest.approx(0.5 - 0.1 * abs(velocity), abs=0.05)


def test_between_its_limits_a_motor_has_the_same_bits_as_without_limits(make):
    """From the first step after a command."""
    angles = []
    for ends in ((), (-0.5, 0.5)):
        wheel = Wheel(make, lambda part: [motor(part)], *ends)
        wheel.run(0.1)
        assert wheel.angle == 0.0
        wheel.handles[0].command(2.0)
        wheel.run(0.005)
        angles.append([wheel.angle])
        wheel.run(0.15)
        angles[-1].append(wheel.angle)
    assert angles[0] == angles[1]
    assert 0.0 < angles[0][0] < 0.29 < angles[0][1]


def test_a_wheel_with_equal_limits_is_locked(make):
    wheel = Wheel(make, lambda part: [motor(part)], 0.0, 0.0)
    wheel.handles[0].command(5.0)
    wheel.run(1.0)
    assert wheel.angle == pytest.approx(0.0, abs=1e-4)


def test_of_two_motors_the_last_command_counts(make):
    wheel = Wheel(make, lambda part: [motor(part), motor(part)], -0.5, 0.5)
    first, second = wheel.handles
    first.command(1.0)
    wheel.run(0.2)
    second.command(-1.0)
    wheel.run(0.3)
    assert wheel.angle == pytest.approx(-0.1, abs=0.02)
    first.command(1.0)
    wheel.run(2.0)
    assert wheel.angle == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("order", [1, -1])
def test_a_servo_has_the_motor_while_it_holds_a_position(make, order):
    requests = (motor, servo)[::order]
    wheel = Wheel(make, lambda part: [make(part) for make in requests], -0.5, 0.5)
    drive, arm = wheel.handles[::order]
    drive.command(1.0)
    arm.command_position(-0.3)
    wheel.run(1.0)
    assert wheel.angle == pytest.approx(-0.3, abs=1e-3)
    arm.release()
    wheel.run(0.3)
    assert wheel.angle == pytest.approx(0.0, abs=0.02)
    wheel.run(1.0)
    assert wheel.angle == pytest.approx(0.5, abs=1e-4)


def test_a_motor_at_rest_does_not_interrupt_the_physics(make, monkeypatch):
    wheel = Wheel(make, lambda part: [motor(part)], -0.5, 0.5)
    wheel.run(0.5)
    engine = wheel.simulation.engine
    advance, pieces = engine.advance, []

    def counted(count, forwarded):
        pieces.append(count)
        advance(count, forwarded)

    monkeypatch.setattr(engine, "advance", counted)
    wheel.run(0.5)
    assert max(pieces) == 20
    wheel.handles[0].command(0.5)
    wheel.run(0.5)
    assert max(pieces[-50:]) == 1
