"""Servos of joints: efforts, velocities and positions, whatever they bear."""

import math

import pytest

from cartwheel.simulation import Simulation
from cartwheel.simulation.dynamics.joint_servo import POSITION_BANDWIDTH

MASS, ARM, INERTIA, GRAVITY = 2.0, 0.5, 0.1, 9.8
TURNED = INERTIA + MASS * ARM**2
WEIGHT = MASS * GRAVITY * ARM
STRONGEST = 1e6
"""N m; of a motor without a stated limit."""
BEAM = f"""<model name="arm"><link name="base"/><joint name="bolt" type="fixed">
  <parent>world</parent>
  <child>base</child></joint><link name="beam"><inertial><pose>{ARM} 0 0 0 0 0</pose>
  <mass>{MASS}</mass><inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{INERTIA}</izz></inertia>
  </inertial></link><joint name="turn" type="revolute"><parent>base</parent><child>beam</child>
  <axis><xyz>0 1 0</xyz></axis></joint></model>"""


class Beam:
    """A beam of known weight on a servo."""

    def __init__(self, make, strength=200.0, step=None, limits=""):
        self.handles = []

        def attach(part):
            self.handles.append(part.servo("turn", max_effort=strength))
            return []

        world = make.world(step=step, ground=None).session.simulation.world
        self.simulation = Simulation(world, attach=attach)
        model = BEAM.replace("</xyz></axis>", f"</xyz>{limits}</axis>")
        self.simulation.spawn(make.sdf(model))
        (self.servo,) = self.handles

    def run(self, seconds):
        self.simulation.advance(self.simulation.time_ns + round(seconds * 1e9))

    @property
    def angle(self):
        return self.simulation.joint_position("arm", "turn")

    @property
    def speed(self):
        return float(self.simulation.data.qvel[self.simulation.engine.joint_id("arm", "turn")])


@pytest.mark.parametrize("step", [0.001, 0.005])
def test_it_goes_to_a_position_and_bears_the_weight_there(make, step):
    beam = Beam(make, step=step)
    beam.servo.command_position(-0.6)
    beam.run(1.0)
    assert beam.angle == pytest.approx(-0.6, abs=1e-4)


@pytest.mark.parametrize("strength", [1e-300, 0.01, 3.0, 200.0, math.inf])
def test_the_speed_toward_a_target_has_the_bits_of_the_formula(make, strength):
    servo = Beam(make, strength=strength).servo
    near = servo._braking / POSITION_BANDWIDTH**2
    places = [near * (1.0 + ulps * 2.0**-52) for ulps in range(-4, 5)]
    places += [near * factor for factor in (1 - 2e-9, 1 - 5e-10, 1 + 1e-9, 0.5, 3.0, 1e6)]
    places += [0.0, 5e-324, 1e-300, 1.0, 1e3]

    def speed_to(target, rate, fastest):
        speed = POSITION_BANDWIDTH * abs(target)
        braked = math.sqrt(servo._braking * abs(target))
        wanted = rate + math.copysign(braked if braked < speed else speed, target)
        return min(max(wanted, -fastest), fastest)

    for size in places:
        for error in (size, -size):
            for rate, fastest in ((0.0, math.inf), (-0.0, math.inf), (0.3, 0.25), (-0.3, 0.0)):
                servo.command_position(error, rate, fastest)
                assert servo._turning.hex() == speed_to(error, rate, fastest).hex()
                servo.follow()
                later = error + rate * servo._step
                assert servo._turning.hex() == speed_to(later, rate, fastest).hex()


def test_far_away_it_brakes_in_time(make):
    """With hardly more strength than the weight asks it comes there without swinging past."""
    beam = Beam(make, strength=2.5 * WEIGHT)
    beam.servo.command_position(1.5)
    highest = 0.0
    for _ in range(400):
        beam.run(0.01)
        highest = max(highest, beam.angle)
    assert beam.angle == pytest.approx(1.5, abs=1e-3)
    assert highest < 1.55


def test_its_strength_is_its_limit(make):
    """Weaker than the weight it falls, less fast by its share."""
    beam = Beam(make, strength=0.5 * WEIGHT)
    beam.servo.command_position(0.0)
    beam.run(0.15)
    assert beam.angle == pytest.approx(0.5 * 0.5 * WEIGHT / TURNED * 0.15**2, rel=0.1)


def test_a_position_that_moves_on_is_followed(make):
    beam = Beam(make)
    beam.servo.command_position(0.0, velocity=0.4)
    beam.run(1.0)
    assert beam.angle == pytest.approx(0.4, abs=0.005)


def test_a_velocity_is_held(make):
    beam = Beam(make)
    beam.servo.command_velocity(-0.5)
    beam.run(2.0)
    assert beam.angle == pytest.approx(-1.0, abs=0.01)


@pytest.mark.parametrize("velocity", [0.5, -0.5])
def test_no_velocity_drives_a_joint_through_its_limit(make, velocity):
    """However strong the motor, as in Gazebo, where the limit comes before the motor."""
    limits = "<limit><lower>-0.3</lower><upper>0.3</upper></limit>"
    beam = Beam(make, strength=STRONGEST, limits=limits)
    beam.servo.command_velocity(velocity)
    beam.run(0.4)
    assert beam.angle == pytest.approx(0.4 * velocity, abs=0.01)
    beam.run(1.6)
    assert beam.angle == pytest.approx(math.copysign(0.3, velocity), abs=1e-3)
    assert beam.speed == pytest.approx(0.0, abs=1e-3)
    beam.servo.command_velocity(-velocity)
    beam.run(0.4)
    assert beam.angle == pytest.approx(math.copysign(0.1, velocity), abs=0.01)


def test_a_gentle_position_takes_no_more_effort_than_it_may(make):
    beam = Beam(make)
    beam.servo.command_position(0.0, max_effort=0.25 * WEIGHT)
    beam.run(0.15)
    assert beam.angle == pytest.approx(0.5 * 0.75 * WEIGHT / TURNED * 0.15**2, rel=0.1)


def test_an_effort_balances_the_weight(make):
    beam = Beam(make)
    beam.servo.command_effort(-WEIGHT)
    beam.run(0.2)
    assert beam.angle == pytest.approx(0.0, abs=1e-3)


def test_damping_is_stable_however_strong_it_is(make):
    """1e4 N m s/rad on 0.6 kg m² is a time constant of 60 µs, and a step has 5 ms."""
    beam = Beam(make, strength=1e6, step=0.005)
    beam.servo.command_effort(0.0, damping=1e4)
    beam.run(1.0)
    assert beam.speed == pytest.approx(WEIGHT / 1e4, rel=0.01)


def test_released_it_falls_freely(make):
    beam = Beam(make)
    beam.servo.command_position(0.0)
    beam.run(0.5)
    beam.servo.release()
    beam.run(0.15)
    assert beam.angle == pytest.approx(0.5 * WEIGHT / TURNED * 0.15**2, rel=0.1)
    assert math.isfinite(beam.angle)
