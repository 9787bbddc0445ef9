"""Limits of a drive's commands: the formula, and successive commands."""

import math

import numpy as np
import pytest

from cartwheel.devices.drives.limiter import UNBOUNDED, Limiter, Limits, limited

ALL = Limits(
    velocity=(-0.5, 1.0), acceleration=(-1.0, 2.0), deceleration=(-4.0, 3.0), jerk=(-9.0, 9.0)
)


def test_without_limits_a_command_is_unchanged():
    assert limited(Limits(), 7.3, 0.1, 0.0, 0.01) == 7.3


def test_bounds_without_a_limit_change_nothing_but_the_last_bit():
    free = Limits(velocity=UNBOUNDED, acceleration=UNBOUNDED)
    assert limited(free, 0.3, 0.1, 0.0, 0.01) == 0.1 + (0.3 - 0.1)


@pytest.mark.parametrize(
    ("wanted", "last", "expected"),
    [
        (5.0, 1.0, 1.2),  # faster forward: 2 m/s² for 0.1 s
        (0.0, 1.0, 0.6),  # slower forward: -4 m/s²
        (0.0, -1.0, -0.6),  # slower backward: the same limit
        (-5.0, -1.0, -1.1),  # faster backward: -1 m/s²
        (-5.0, 1.0, 0.6),  # through zero: slower first
    ],
)
def test_a_speed_falls_and_grows_at_rates_of_its_own(wanted, last, expected):
    limits = Limits(acceleration=(-1.0, 2.0), deceleration=(-4.0, 3.0))
    assert limited(limits, wanted, last, last, 0.1) == pytest.approx(expected)


def test_one_acceleration_limits_every_change():
    limits = Limits(acceleration=(-1.0, 2.0))
    assert limited(limits, 0.0, -1.0, -1.0, 0.1) == pytest.approx(-0.8)
    assert limited(limits, 0.0, 1.0, 1.0, 0.1) == pytest.approx(0.9)


def test_successive_commands_remember_the_last_two():
    limiter = Limiter(Limits(jerk=(-3.0, 3.0)))
    dt = 0.1
    speeds = [limiter.step(100.0, dt) for _ in range(4)]
    assert speeds == pytest.approx([2 * 3.0 * dt * dt * n for n in (1, 3, 6, 10)])
    assert limiter.value == speeds[-1]
    limiter.reset()
    assert limiter.step(100.0, dt) == speeds[0]


def test_many_commands_have_the_bits_of_one():
    rng = np.random.default_rng(3)
    wanted, last, before = rng.normal(0, 1, (3, 200))
    wanted[:20] = last[20:40] = 0.0
    many = limited(ALL, wanted, last, before, 0.05)
    for i in range(200):
        one = limited(ALL, *(float(each[i]) for each in (wanted, last, before)), 0.05)
        assert many[i].tobytes() == np.float64(one).tobytes()
        assert math.isfinite(one)
