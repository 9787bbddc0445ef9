"""The arithmetic of sensor errors, without a simulation."""

import math

import numpy as np
import pytest

from cartwheel.devices.noise import gauss_markov_step, quantize, stationary_deviation


def test_a_gauss_markov_process_keeps_its_variance():
    """kept² sigma² + added² = sigma², for any step length."""
    deviation, frequency = np.array([0.5, 2.0, 3.0]), np.array([0.01, 1.0, 50.0])
    for period_ns in (1_000_000, 20_000_000, 10**9):
        kept, added = gauss_markov_step(deviation, frequency, period_ns)
        assert kept == pytest.approx(np.exp(-frequency * period_ns / 1e9))
        assert (kept * deviation) ** 2 + added**2 == pytest.approx(deviation**2)


def test_a_constant_drift_does_not_change():
    kept, added = gauss_markov_step(np.array([0.7]), np.array([0.0]), 5_000_000)
    assert kept.tolist() == [1.0]
    assert added.tolist() == [0.0]


def test_a_random_walk_approaches_its_stationary_deviation():
    """Ornstein-Uhlenbeck: dx = -x/T dt + sigma dW has the variance sigma² T / 2."""
    density, time = np.array([0.1, 0.1]), np.array([8.0, 0.0])
    assert stationary_deviation(density, time).tolist() == [pytest.approx(0.1 * math.sqrt(4)), 0.0]
    # For steps that are short compared with the correlation time, the process is a random walk
    # whose deviation grows by sigma sqrt(dt). The relative error is dt / 2T.
    _, added = gauss_markov_step(stationary_deviation(density[:1], time[:1]), 1 / time[:1], 10**6)
    assert added[0] == pytest.approx(0.1 * math.sqrt(1e-3), rel=1e-3 / (2 * 8.0))


def test_values_are_rounded_to_multiples():
    rounded = quantize(np.array([0.0, 0.26, 0.24, -0.26]), 0.1)
    assert rounded == pytest.approx([0.0, 0.3, 0.2, -0.3])
    steps = np.array([1.0, 0.5])
    assert quantize(np.array([1.6, 1.6]), steps).tolist() == [2.0, 1.5]
