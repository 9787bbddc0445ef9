"""Charge, voltage and current of batteries."""

import math

import numpy as np
import pytest

from cartwheel.devices.power.battery import BatteryConfig, BatteryState, next_state


def battery(**changes):
    values = {
        "name": "main", "state_topic": "state", "initial_voltage": 12.0, "full_voltage": 12.0,
        "voltage_change": -2.0, "capacity": 1.0, "charge": 1.0, "resistance": 0.1,
        "smoothing": 1e-6, "power": 24.0, "draining": True, "charging_time": 0.5,
    }  # fmt: skip
    return BatteryConfig(**{**values, **changes})


FULL = BatteryState(1.0, 12.0, 0.0)


def test_a_load_draws_its_power_and_lowers_the_voltage():
    charge, voltage, current = next_state(battery(), FULL, 36.0, draining=True, charging=False)
    assert current == pytest.approx(2.0)
    assert charge == pytest.approx(1.0 - 2.0 * 0.01)
    assert voltage == pytest.approx(12.0 - 2.0 * 0.02 - 0.1 * 2.0)


def test_the_current_follows_with_its_time_constant():
    state = next_state(battery(smoothing=3.0), FULL, 3.0, draining=True, charging=False)
    assert state.current == pytest.approx(2.0 * (1 - math.exp(-1)))


def test_charging_stops_at_nine_tenths_of_the_capacity():
    low, high = BatteryState(0.5, 11.0, 0.0), BatteryState(0.95, 11.0, 0.0)
    assert next_state(battery(), low, 36.0, draining=False, charging=True).charge > 0.5
    assert next_state(battery(), high, 36.0, draining=False, charging=True).charge == 0.95


def test_an_empty_battery_has_no_current_until_it_is_charged():
    empty = BatteryState(0.0, 10.0, 1.5)
    assert next_state(battery(), empty, 1.0, draining=True, charging=False).current == 0.0
    assert next_state(battery(), empty, 1.0, draining=True, charging=True).current < 0.0


def test_many_batteries_have_the_bits_of_one():
    rng = np.random.default_rng(4)
    charges, voltages, currents = (
        rng.uniform(0, 1, 50),
        rng.uniform(9, 12, 50),
        rng.normal(0, 1, 50),
    )
    charges[:5] = 0.0
    config = battery(smoothing=0.5)
    for draining, charging in ((True, False), (False, True), (True, True)):
        options = {"draining": draining, "charging": charging}
        many = next_state(config, BatteryState(charges, voltages, currents), 0.02, **options)
        for i in range(50):
            one = BatteryState(*(float(each[i]) for each in (charges, voltages, currents)))
            assert tuple(each[i] for each in many) == next_state(config, one, 0.02, **options)
