"""Formulas of steered wheels, against the centre of the turn."""

import math

import numpy as np
import pytest

from cartwheel.devices.drives import steering
from cartwheel.devices.drives.ackermann import reversed_angle

BASE, TRACK = 0.5, 0.4
ANGLES = (-1.2, -0.3, -1e-6, 0.0, 0.2, 0.9)


@pytest.mark.parametrize("middle", [angle for angle in ANGLES if abs(angle) > 1e-3])
def test_the_axes_of_all_wheels_intersect_at_the_centre_of_the_turn(middle):
    """The centre is on the unsteered axle, base / tan(angle) to the left of its middle."""
    center = BASE / math.tan(middle)
    angles = steering.wheel_angles(middle, BASE, TRACK)
    factors = steering.rim_factors(middle, BASE, TRACK)
    for angle, factor, y in zip(angles, factors, (TRACK / 2, -TRACK / 2), strict=True):
        # The wheel is square to the line from its place (BASE, y) to (0, center).
        along = (math.cos(angle), math.sin(angle))
        assert along[0] * BASE + along[1] * (y - center) == pytest.approx(0, abs=1e-12)
        assert factor == pytest.approx((center - y) / center)


@pytest.mark.parametrize("middle", ANGLES)
def test_both_formulas_of_an_axle_are_equal(middle):
    assert steering.wheel_angles_in_place(middle, BASE, TRACK) == pytest.approx(
        steering.wheel_angles(middle, BASE, TRACK), abs=1e-15
    )
    assert steering.rim_factors_in_place(middle, BASE, TRACK) == pytest.approx(
        steering.rim_factors(middle, BASE, TRACK), rel=1e-15
    )


def test_at_a_right_angle_the_robot_turns_in_place():
    """The centre is the middle of the unsteered axle, and the wheels are square to it."""
    left, right = steering.wheel_angles_in_place(math.pi / 2, BASE, TRACK)
    assert left == pytest.approx(math.atan2(BASE, -TRACK / 2))
    assert right == pytest.approx(math.atan2(BASE, TRACK / 2))
    assert steering.rim_factors_in_place(math.pi / 2, BASE, TRACK) == (1.0, 1.0)


@pytest.mark.parametrize("middle", ANGLES)
def test_the_middle_angle_is_that_of_either_wheel(middle):
    left, right = steering.wheel_angles(middle, BASE, TRACK)
    assert steering.middle_angle(left, BASE, TRACK, -1) == pytest.approx(middle, abs=1e-15)
    assert steering.middle_angle(right, BASE, TRACK, 1) == pytest.approx(middle, abs=1e-15)
    assert steering.middle_angle(middle, BASE, TRACK, 0) == pytest.approx(middle, abs=1e-15)


@pytest.mark.parametrize(("speed", "turn"), [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)])
def test_the_angle_of_a_turn_gives_its_yaw_rate(speed, turn):
    for function in (steering.angle_of_turn, steering.angle_of_turn_in_place):
        angle = function(speed, turn, BASE)
        assert abs(angle) < math.pi / 2
        assert speed * math.tan(angle) / BASE == pytest.approx(turn)


def test_at_standstill_the_wheel_is_straight_or_square():
    assert steering.angle_of_turn(0.0, 0.4, BASE) == 0.0
    assert steering.angle_of_turn_in_place(0.0, 0.4, BASE) == math.pi / 2
    assert steering.angle_of_turn_in_place(0.0, -0.4, BASE) == -math.pi / 2
    assert steering.angle_of_turn_in_place(0.0, 0.0, BASE) == 0.0


def test_in_reverse_the_sign_of_the_angle_is_inverted():
    assert reversed_angle(0.1, 0.3) == 0.3
    assert reversed_angle(-0.1, 0.3) == -0.3


@pytest.mark.parametrize(("speed", "turn"), [(0.5, 0.4), (-0.3, 0.4), (0.0, -0.6)])
def test_a_driven_and_steered_wheel_moves_the_axle_as_commanded(speed, turn):
    radius = 0.1
    angle = steering.angle_of_turn_in_place(speed, turn, BASE)
    rolled = radius * steering.driven_wheel_speed(speed, turn, angle, BASE, radius)
    assert steering.driven_wheel_motion(rolled, angle, BASE) == pytest.approx(
        (speed, turn), abs=1e-15
    )


def test_a_driven_wheel_slows_down_until_it_is_steered():
    assert steering.alignment(0.5) == 1.0
    assert steering.alignment(-0.6) == pytest.approx(math.cos(0.6))
    assert steering.alignment(-1.6) == 0.01


@pytest.mark.parametrize(
    ("function", "numbers"),
    [
        (steering.angle_of_turn, 2),
        (steering.angle_of_turn_in_place, 2),
        (steering.wheel_angles, 1),
        (steering.wheel_angles_in_place, 1),
        (steering.rim_factors, 1),
        (steering.rim_factors_in_place, 1),
        (steering.driven_wheel_motion, 2),
        (steering.alignment, 1),
    ],
)
def test_arrays_give_the_bits_of_floats(function, numbers):
    constants = {steering.alignment: (), steering.driven_wheel_motion: (BASE,)}.get(
        function, (BASE, TRACK) if numbers == 1 else (BASE,)
    )
    values = [*ANGLES, 2.0, -2.0, 0.0]
    arrays = [np.array(np.roll(values, shift)) for shift in range(numbers)]
    together = np.atleast_2d(function(*arrays, *constants))
    for index in range(len(values)):
        alone = np.atleast_1d(function(*(float(each[index]) for each in arrays), *constants))
        assert together[:, index].tobytes() == alone.tobytes()
