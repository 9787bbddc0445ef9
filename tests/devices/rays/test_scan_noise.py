"""The noise of scans: its mean, its spread, its limits and its seed."""

import math

import numpy as np
import pytest
from tests.devices.rays.scanners import NOISE, model, scan, scans, sensor, wall


def noisy(make, *, seed=0, mean=0.0, stddev=0.02, most=10.0, seconds=2.0):
    text = sensor(
        samples=1000,
        low=-0.001,
        high=0.001,
        most=most,
        noise=NOISE.format(mean=mean, stddev=stddev),
    )
    world = make.world(wall(make, 2.0), make.sdf(model(text)), seed=seed)
    return np.array([m.ranges for m in scans(world, seconds)])


def test_noise_has_the_mean_and_the_spread_that_are_asked_for(make):
    readings = noisy(make, mean=0.05, stddev=0.02)
    count = readings.size
    assert count == 21_000
    # Five standard errors of the mean and of the standard deviation.
    assert readings.mean() == pytest.approx(2.05, abs=5 * 0.02 / math.sqrt(count))
    assert readings.std() == pytest.approx(0.02, abs=5 * 0.02 / math.sqrt(2 * count))
    # No ray and no moment repeats another's.
    assert len(np.unique(readings)) > 0.9 * count


def test_noise_stays_within_what_can_be_measured(make):
    readings = noisy(make, stddev=0.5, most=2.2)
    assert readings.max() == np.float32(2.2)
    assert readings.min() >= 0.1


def test_quantised_ranges_are_multiples_of_the_precision(make):
    noise = "<noise><type>gaussian_quantized</type><mean>0</mean><stddev>0.1</stddev>"
    noise += "<precision>0.25</precision></noise>"
    text = sensor(samples=500, low=-0.001, high=0.001, noise=noise)
    ranges = scan(make.world(wall(make, 2.0), make.sdf(model(text)))).ranges
    assert set(ranges.tolist()) == {1.75, 2.0, 2.25}


def test_a_bias_is_drawn_once(make):
    noise = "<noise><type>gaussian</type><mean>0</mean><stddev>0</stddev>"
    noise += "<bias_mean>0.1</bias_mean><bias_stddev>0</bias_stddev></noise>"
    signs = set()
    for seed in range(8):
        text = sensor(samples=1, noise=noise)
        reported = scans(make.world(wall(make, 2.0), make.sdf(model(text)), seed=seed), 1.0)
        (value,) = {float(message.ranges[0]) for message in reported}
        assert abs(value - 2.0) == pytest.approx(0.1, abs=1e-6)
        signs.add(value > 2.0)
    # As in Gazebo it may have either sign.
    assert signs == {True, False}


def test_what_is_not_there_has_no_noise(make):
    assert np.all(np.isposinf(noisy(make, most=1.5)))


def test_the_seed_decides_the_noise(make):
    first, again, other = noisy(make, seed=1), noisy(make, seed=1), noisy(make, seed=2)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
