"""The keys of teleop_twist_keyboard."""

import pytest

from cartwheel.viewer.teleop import KEYS, MOVES, SPEEDS, Teleop


@pytest.mark.parametrize(
    ("key", "linear", "angular"),
    [
        ("i", 0.5, 0.0),
        (",", -0.5, 0.0),
        ("j", 0.0, 1.0),
        ("l", 0.0, -1.0),
        ("u", 0.5, 1.0),
        ("o", 0.5, -1.0),
        ("m", -0.5, -1.0),
        (".", -0.5, 1.0),
        ("k", 0.0, 0.0),
    ],
)
def test_moves_as_ros_does(key, linear, angular):
    teleop = Teleop()
    assert teleop.press(key)
    assert (teleop.linear, teleop.angular) == (linear, angular)


@pytest.mark.parametrize(
    ("key", "linear", "angular"),
    [
        ("q", 0.55, 1.1),
        ("z", 0.45, 0.9),
        ("w", 0.55, 1.0),
        ("x", 0.45, 1.0),
        ("e", 0.5, 1.1),
        ("c", 0.5, 0.9),
    ],
)
def test_speeds_change_by_a_tenth(key, linear, angular):
    teleop = Teleop()
    teleop.press(key)
    assert (teleop.linear_speed, teleop.angular_speed) == pytest.approx((linear, angular))


def test_a_moving_robot_takes_a_new_speed_at_once_and_a_standing_one_gets_no_message():
    teleop = Teleop()
    assert not teleop.press("w")
    teleop.press("i")
    assert teleop.press("w")
    assert teleop.linear == pytest.approx(0.5 * 1.1 * 1.1)


def test_any_other_key_stops():
    teleop = Teleop()
    teleop.press("i")
    assert teleop.press("g")
    assert (teleop.linear, teleop.angular) == (0.0, 0.0)


def test_no_key_is_used_twice():
    assert len(set(KEYS)) == len(MOVES) + len(SPEEDS)
