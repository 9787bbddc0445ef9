"""Random numbers of noise: equal for the same seed, time and purpose, and otherwise unrelated."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cartwheel.simulation.random_numbers import RandomNumbers


def drawn(owner="cart", purpose="imu", seed=0, time_ns=0, count=1000):
    return RandomNumbers(owner).at(purpose, seed=seed, time_ns=time_ns).normal(size=count)


def test_they_depend_on_nothing_else():
    numbers = RandomNumbers("cart")
    for time_ns in (5, 3, 5):
        numbers.at("other", seed=0, time_ns=9).normal(size=7)
        read = numbers.at("imu", seed=0, time_ns=time_ns).normal(size=1000)
        assert np.array_equal(read, drawn(time_ns=time_ns))
    numbers.at("imu", seed=1, time_ns=5)
    assert np.array_equal(numbers.at("imu", seed=0, time_ns=5).normal(size=1000), drawn(time_ns=5))


@pytest.mark.parametrize("seed", [0, 2**64, 2**200 + 1])
def test_they_differ_and_are_uncorrelated(seed):
    several = [
        drawn(seed=seed),
        drawn(seed=seed + 1),
        drawn(seed=seed, owner="cart2"),
        drawn(seed=seed, purpose="imu2"),
        drawn(seed=seed, time_ns=1),
        drawn(seed=seed, time_ns=2**63),
        RandomNumbers("cart").stream("imu", seed=seed, time_ns=0).normal(size=1000),
    ]
    for values in several:
        # The standard error of the mean is 1 / sqrt(1000) = 0.03.
        assert abs(values.mean()) < 0.15 and abs(values.std() - 1) < 0.12
    for one, other in itertools.combinations(several, 2):
        assert abs(np.corrcoef(one, other)[0, 1]) < 0.15


def test_a_stream_continues_on_its_own():
    numbers = RandomNumbers("cart")
    whole = numbers.stream("drift", seed=3, time_ns=7).normal(size=10)
    stream = numbers.stream("drift", seed=3, time_ns=7)
    parts = []
    for _ in range(10):
        parts.append(stream.normal())
        numbers.at("drift", seed=3, time_ns=8).normal()
    assert np.array_equal(parts, whole)
