"""Trajectories at times at which the polynomial is known."""

import numpy as np
import pytest

from cartwheel.devices.joints.trajectory import Trajectory, Waypoint, next_point, polynomial

SECOND = 1_000_000_000


def test_points_without_velocities_are_connected_by_lines():
    path = Trajectory(
        0, [Waypoint(time=0, position=(0.0, 1.0)), Waypoint(time=2, position=(1.0, 0.0))]
    )
    state = path.at(SECOND // 2)
    assert state.position == pytest.approx((0.25, 0.75))
    assert state.velocity == pytest.approx((0.5, -0.5))
    assert state.acceleration == (0.0, 0.0)


def test_points_with_velocities_are_connected_by_a_cubic():
    """From rest to rest: 3 s² - 2 s³ of the way, 1.5 of its mean speed in the middle."""
    rest = (0.0,)
    path = Trajectory(
        SECOND,
        [
            Waypoint(time=0, position=(0.0,), velocity=rest),
            Waypoint(time=4, position=(2.0,), velocity=rest),
        ],
    )
    for share in (0.1, 0.25, 0.5, 0.9):
        state = path.at(SECOND + round(4 * share * SECOND))
        assert state.position[0] == pytest.approx(2 * (3 * share**2 - 2 * share**3))
    assert path.at(3 * SECOND).velocity[0] == pytest.approx(1.5 * 2 / 4)


def test_points_with_accelerations_are_connected_by_a_quintic():
    """From rest to rest: 10 s³ - 15 s⁴ + 6 s⁵ of the way."""
    rest = (0.0,)
    path = Trajectory(
        0,
        [
            Waypoint(time=0, position=(1.0,), velocity=rest, acceleration=rest),
            Waypoint(time=2, position=(0.0,), velocity=rest, acceleration=rest),
        ],
    )
    for share in (0.2, 0.5, 0.7):
        state = path.at(round(2 * share * SECOND))
        way = 10 * share**3 - 15 * share**4 + 6 * share**5
        assert state.position[0] == pytest.approx(1 - way)
    assert path.at(SECOND).velocity[0] == pytest.approx(-15 / 8 * 1 / 2)


def test_a_quintic_has_the_states_of_its_ends():
    ends = [
        Waypoint(time=0, position=(0.3,), velocity=(-0.4,), acceleration=(0.9,)),
        Waypoint(time=1.5, position=(1.1,), velocity=(0.7,), acceleration=(-0.2,)),
        Waypoint(time=2.5, position=(0.0,), velocity=(0.0,), acceleration=(0.0,)),
    ]
    path = Trajectory(0, ends)
    for point in ends[:2]:
        state = path.at(round(point.time * SECOND))
        assert state.position == pytest.approx(point.position)
        assert state.velocity == pytest.approx(point.velocity)
        assert state.acceleration == pytest.approx(point.acceleration)
    # Just before the point, in the previous segment.
    before = path.at(round(1.5 * SECOND) - 1)
    assert before.velocity[0] == pytest.approx(0.7, abs=1e-6)
    assert before.acceleration[0] == pytest.approx(-0.2, abs=1e-6)


def test_a_trajectory_is_at_rest_before_and_after_its_points():
    path = Trajectory(
        SECOND, [Waypoint(time=0, position=(1.0,)), Waypoint(time=1, position=(3.0,))]
    )
    assert path.at(0).position == (1.0,)
    assert path.at(0).velocity == (0.0,)
    assert path.at(5 * SECOND).position == (3.0,)
    assert path.at(5 * SECOND).velocity == (0.0,)
    assert path.end_ns == 2 * SECOND


def test_the_next_point_is_the_first_whose_time_has_not_passed():
    times = [100, 200, 150, 300]
    assert next_point(times, 0, 100) == 0
    assert next_point(times, 0, 101) == 1
    # The times need not increase: the third point is passed with the second.
    assert next_point(times, 0, 201) == 3
    assert next_point(times, 2, 0) == 2
    assert next_point(times, 3, 301) == 4
    assert next_point([], 0, 5) == 0


def test_a_polynomial_and_its_derivatives():
    assert polynomial((1.0, 2.0, 3.0, 4.0, 5.0, 6.0), 2.0) == (
        1 + 4 + 12 + 32 + 80 + 192,
        2 + 12 + 48 + 160 + 480,
        6 + 48 + 240 + 960,
    )
    generator = np.random.default_rng(1)
    coefficients, times = generator.normal(size=(6, 20)), generator.uniform(0.0, 3.0, size=20)
    together = polynomial(coefficients, times)
    for index in range(20):
        alone = polynomial([float(each[index]) for each in coefficients], float(times[index]))
        assert [float(each[index]) for each in together] == list(alone)
