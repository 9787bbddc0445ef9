"""PID controllers with limited and filtered targets."""

import math

import pytest

from cartwheel.devices.air.filtered_pid import FilteredPid, FilteredPidConfig


def pid(leads=False, **settings):
    none = {"p": 0.0, "i": 0.0, "d": 0.0, "time_constant": 0.0, "limit": -1.0}
    return FilteredPid(FilteredPidConfig(**none | settings), leads=leads)


def test_the_gains_act_on_error_integral_and_rate():
    assert pid(p=2.0).update(3.0, 1.0, 0.0, 0.1) == pytest.approx(4.0)
    assert pid(d=2.0).update(0.0, 0.0, 1.5, 0.1) == pytest.approx(-3.0)
    integrating = pid(i=2.0)
    for _ in range(10):
        output = integrating.update(1.0, 0.0, 0.0, 0.1)
    assert output == pytest.approx(2.0)
    integrating.reset()
    assert integrating.update(0.0, 0.0, 0.0, 0.1) == 0.0


def test_the_target_is_limited():
    assert pid(p=1.0, limit=0.5).update(3.0, 0.0, 0.0, 0.1) == pytest.approx(0.5)
    assert pid(p=1.0, limit=0.5).update(-3.0, 0.0, 0.0, 0.1) == pytest.approx(-0.5)
    assert pid(p=1.0, limit=0.0).update(3.0, 0.0, 0.0, 0.1) == pytest.approx(3.0)


def test_the_target_is_filtered():
    filtered = pid(p=1.0, time_constant=0.5)
    for _ in range(5000):
        output = filtered.update(1.0, 0.0, 0.0, 1e-4)
    # After one time constant, a first-order filter has reached 1 - 1/e; the step adds 1e-4.
    assert output == pytest.approx(1 - math.exp(-1), abs=2e-4)


def test_a_leading_controller_follows_the_change_of_its_target():
    assert pid(d=1.0).update(1.0, 0.0, 0.0, 0.1) == pytest.approx(0.0)
    assert pid(d=1.0, leads=True).update(1.0, 0.0, 0.0, 0.1) == pytest.approx(10.0)


def test_an_acceleration_contains_itself():
    # a = p e - d a
    assert pid(p=6.0, d=2.0).acceleration(1.0, 0.0, 0.1) == pytest.approx(2.0)
