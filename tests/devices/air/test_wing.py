"""Forces and moments of an aeroplane's stability derivatives."""

import math

import numpy as np
import pytest

from cartwheel.devices.air.wing import (
    DRAG,
    LIFT,
    PITCH,
    ROLL,
    SIDE,
    YAW,
    WingConfig,
    air_loads,
    coefficients,
    stalled_share,
)

AREA, RATIO, CHORD, RHO = 0.8, 5.0, 0.4, 1.2
SPAN = math.sqrt(AREA * RATIO)
NOTHING = np.zeros(6)


def wing(**changed):
    given = {
        "link": "body", "area": AREA, "aspect_ratio": RATIO, "chord": CHORD, "efficiency": 0.9,
        "air_density": RHO, "centre": (0.0, 0.0, 0.0), "forward": (1.0, 0.0, 0.0),
        "upward": (0.0, 0.0, 1.0), "stall_angle": 2.0, "lift": 0.2, "drag": 0.02,
        "by_attack": np.zeros(6), "by_sideslip": np.zeros(6), "by_rates": np.zeros((6, 3)),
        **changed,
    }  # fmt: skip
    return WingConfig(**given)


def six(**values):
    found = np.zeros(6)
    for name, value in values.items():
        found[{"lift": LIFT, "drag": DRAG, "side": SIDE, "roll": ROLL, "pitch": PITCH,
               "yaw": YAW}[name]] = value  # fmt: skip
    return found


def pressure(speed):
    return 0.5 * RHO * speed**2 * AREA


def test_level_flight_has_lift_and_drag():
    force, moment = air_loads(wing(), np.array([20.0, 0, 0]), np.zeros(3), NOTHING)
    drag = 0.02 + 0.2**2 / (math.pi * RATIO * 0.9)
    assert force == pytest.approx(pressure(20) * np.array([-drag, 0, 0.2]), rel=1e-6)
    assert moment == pytest.approx((0, 0, 0))


def test_lift_is_across_the_flow_and_grows_with_the_angle_of_attack():
    """Flying at 0.1 rad below its nose, the lift leans forward."""
    config = wing(by_attack=six(lift=4.0))
    velocity = 20 * np.array([math.cos(0.1), 0, -math.sin(0.1)])
    force, _ = air_loads(config, velocity, np.zeros(3), NOTHING)
    lift = 0.2 + 4.0 * 0.1
    drag = 0.02 + lift**2 / (math.pi * RATIO * 0.9)
    ahead, up = velocity / 20, np.array([math.sin(0.1), 0, math.cos(0.1)])
    assert force == pytest.approx(pressure(20) * (lift * up - drag * ahead), rel=1e-3)


def test_a_stalled_wing_is_a_flat_plate():
    config = wing(by_attack=six(lift=4.0), stall_angle=0.3)
    found = coefficients(config, 1.0, 0.0, NOTHING)
    assert found[LIFT] == pytest.approx(2 * math.sin(1.0) ** 2 * math.cos(1.0), rel=1e-3)
    flat = 2 / (1 + math.exp(-0.224 - 0.115 * RATIO))
    assert found[DRAG] == pytest.approx(flat * math.sin(1.0) ** 2, rel=1e-2)
    below = coefficients(config, -1.0, 0.0, NOTHING)
    assert below[LIFT] == pytest.approx(-found[LIFT], rel=1e-3)


def test_the_flow_separates_at_the_stall_angle():
    assert stalled_share(0.0, 0.5) == pytest.approx(0.0, abs=2e-3)
    assert stalled_share(0.5, 0.5) == pytest.approx(0.5, abs=1e-3)
    assert stalled_share(-1.0, 0.5) == pytest.approx(1.0, abs=2e-3)
    assert stalled_share(1.0, 1e9) == pytest.approx(0.0)


def test_sideslip_pushes_and_turns_it():
    """Flying to the right of its nose; the moments are about its own forward, right and down."""
    config = wing(by_sideslip=six(side=-0.3, roll=-0.1, pitch=0.2, yaw=0.05))
    velocity = np.array([20 * math.cos(0.1), -20 * math.sin(0.1), 0])
    force, moment = air_loads(config, velocity, np.zeros(3), NOTHING)
    flow = pressure(20 * math.cos(0.1))
    # To the left.
    assert force[1] == pytest.approx(flow * 0.3 * 0.1)
    expected = flow * 0.1 * np.array([-0.1 * SPAN, -0.2 * CHORD, -0.05 * SPAN])
    assert moment == pytest.approx(expected)


def test_rates_are_damped():
    rates = np.zeros((6, 3))
    rates[ROLL, 0], rates[PITCH, 1], rates[YAW, 2] = -0.5, -10.0, -0.1
    turning = np.array([0.3, 0.2, -0.4])
    _, moment = air_loads(wing(by_rates=rates), np.array([20.0, 0, 0]), turning, NOTHING)
    scale = pressure(20) / 20 / 2
    expected = -scale * turning * np.array([0.5 * SPAN**2, 10.0 * CHORD**2, 0.1 * SPAN**2])
    assert moment == pytest.approx(expected)


def test_control_surfaces_add_to_the_coefficients():
    force, moment = air_loads(
        wing(lift=0.0, drag=0.0),
        np.array([20.0, 0, 0]),
        np.zeros(3),
        six(drag=0.01, roll=0.02, pitch=-0.03),
    )
    assert force == pytest.approx(pressure(20) * np.array([-0.01, 0, 0]))
    assert moment == pytest.approx(pressure(20) * np.array([0.02 * SPAN, 0.03 * CHORD, 0]))


def test_without_motion_there_is_no_force():
    force, moment = air_loads(wing(), np.zeros(3), np.ones(3), NOTHING)
    assert not force.any()
    assert not moment.any()
