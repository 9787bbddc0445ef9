"""PID controllers, compared with their definition."""

import numpy as np
import pytest

from cartwheel.devices.joints.pid import (
    Pid,
    PidGains,
    integral_term,
    integrate,
    plain_effort,
    position_effort,
    rate_of,
    velocity_effort,
)


def test_each_term():
    pid = Pid(PidGains(p=2.0, i=3.0, d=4.0, i_min=-10, i_max=10))
    command = pid.position(0.5, 0.1, target=1.0)
    # At first the target has not changed. The derivative of the position is the damping.
    assert command.effort == pytest.approx(2 * 0.5 + 3 * 0.5 * 0.1)
    assert command.damping == 4.0
    command = pid.position(0.4, 0.1, target=1.2)
    assert command.effort == pytest.approx(2 * 0.4 + 3 * (0.5 + 0.4) * 0.1 + 4 * 0.2 / 0.1)


def test_the_integral_term_is_limited_but_not_the_integral():
    pid = Pid(PidGains(p=0.0, i=10.0, i_min=-1, i_max=2))
    for _ in range(100):
        command = pid.position(1.0, 0.1, target=0.0)
    assert command.effort == 2.0
    # The integral grew meanwhile, so it takes as long to decrease.
    for _ in range(50):
        command = pid.position(-1.0, 0.1, target=0.0)
    assert command.effort == 2.0


def test_anti_windup_limits_the_integral_itself():
    pid = Pid(PidGains(p=0.0, i=10.0, i_min=-1, i_max=2, stored="limited error"))
    for _ in range(100):
        command = pid.position(1.0, 0.1, target=0.0)
    assert command.effort == 2.0
    command = pid.position(-1.0, 0.1, target=0.0)
    assert command.effort == pytest.approx(2.0 - 10 * 0.1)


def test_the_proportional_gain_of_a_velocity_is_damping():
    command = Pid(PidGains(p=3.0)).velocity(2.0, 0.5, 0.01)
    assert command.at(0.5) == pytest.approx(3.0 * (2.0 - 0.5))


def test_the_derivative_gain_of_a_velocity_acts_on_the_target():
    pid = Pid(PidGains(p=0.0, d=2.0))
    pid.velocity(1.0, 0.0, 0.01)
    # On the joint's velocity, it would act as an inertia, one step late.
    assert pid.velocity(1.0, 5.0, 0.01).effort == 0.0
    assert pid.velocity(1.5, 5.0, 0.01).effort == pytest.approx(2.0 * 0.5 / 0.01)
    # A joint with an inertia of 3 reaches 2/5 of the change: 2 (Δ - v) = 3 v.
    effort = pid.velocity(2.0, 5.0, 0.01, lightness=1 / 3).effort
    assert effort * 0.01 / 3 == pytest.approx(2.0 / 5.0 * 0.5)


@pytest.mark.parametrize(("inertia", "damping"), [(1.0, 0.2), (1e-3, 0.2 + 10 * 0.01)])
def test_a_joint_that_oscillates_fast_is_damped(inertia, damping):
    """(omega T)² is 0.001 and 1; with 1, there are six control periods in an oscillation."""
    pid = Pid(PidGains(p=10.0, d=0.2))
    command = pid.position(0.3, 0.01, target=0.3, rate=0.0, lightness=1 / inertia)
    assert command.effort == pytest.approx(3.0)
    assert command.damping == pytest.approx(damping)


def test_a_limited_integral_term_decreases_at_once():
    gains = PidGains(p=0.0, i=10.0, i_min=-1.0, i_max=2.0, stored="limited term")
    integral = 0.0
    for _ in range(100):
        integral = integrate(gains, integral, 1.0, 0.1)
    assert integral_term(gains, integral) == 2.0
    assert integrate(gains, integral, -1.0, 0.1) == pytest.approx(2.0 - 10 * 0.1)


def test_without_an_integral_gain_the_limits_of_the_term_have_no_effect():
    gains = PidGains(p=1.0, i_min=1.0, i_max=2.0, stored="limited term")
    assert integrate(gains, 0.0, 5.0, 0.1) == 0.0


def test_a_plain_effort_has_an_offset_and_limits():
    gains = PidGains(p=2.0, offset=0.5, u_min=-3.0, u_max=4.0, stored="limited term")
    assert plain_effort(gains, 1.0, 0.25) == 2.0 + 0.25 + 0.5
    assert plain_effort(gains, 10.0, 0.0) == 4.0
    assert plain_effort(gains, -10.0, 0.0) == -3.0


def test_a_target_has_no_rate_without_time():
    assert rate_of(1.0, 0.5, 0.0) == 0.0
    assert rate_of(1.0, 0.5, 0.25) == 2.0


@pytest.mark.parametrize("stored", ["error", "limited error", "limited term"])
def test_arrays_have_the_same_bits_as_floats(stored):
    generator = np.random.default_rng(3)
    errors, velocities, integrals = generator.normal(size=(3, 50))
    lightness = generator.uniform(0.0, 2000.0, size=50)
    gains = PidGains(
        p=3.7, i=1.3, d=0.9, i_min=-0.4, i_max=0.7, u_min=-2.0, u_max=3.0, stored=stored
    )

    def efforts(error, velocity, integral, light):
        integral = integrate(gains, integral, error, 0.013)
        moved = position_effort(
            gains, error, integral, rate=velocity, seconds=0.013, lightness=light
        )
        turned = velocity_effort(gains, velocity, integral, error)
        return (
            integral,
            moved.at(velocity),
            turned.at(velocity),
            plain_effort(gains, error, integral),
        )

    together = efforts(errors, velocities, integrals, lightness)
    for index in range(50):
        alone = efforts(
            float(errors[index]),
            float(velocities[index]),
            float(integrals[index]),
            float(lightness[index]),
        )
        assert [float(each[index]) for each in together] == list(alone)


@pytest.mark.parametrize("stored", ["error", "limited error", "limited term"])
def test_a_controller_has_the_same_bits_as_the_functions(stored):
    generator = np.random.default_rng(5)
    gains = PidGains(p=3.7, i=1.3, d=0.9, i_min=-0.4, i_max=0.7, stored=stored)
    pid, integral, before = Pid(gains), 0.0, None
    limited = stiff = 0
    for _ in range(200):
        error, target = generator.normal(scale=20.0, size=2).tolist()
        seconds, lightness = generator.uniform(0.0, [0.02, 4000.0]).tolist()
        rate = 0.0 if before is None else rate_of(target, before, seconds)
        integral, before = integrate(gains, integral, error, seconds), target
        expected = position_effort(
            gains, error, integral, rate=rate, seconds=seconds, lightness=lightness
        )
        assert pid.position(error, seconds, target, lightness=lightness) == expected
        limited += not -0.399 < integral_term(gains, integral) < 0.699
        stiff += expected.damping != gains.d
    # All branches.
    assert 0 < limited < 200
    assert 0 < stiff < 200
