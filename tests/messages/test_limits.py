"""Limits for numbers in commands."""

from __future__ import annotations

import math

import pytest

from cartwheel.messages import from_dict
from cartwheel.messages.limits import unfit

TWIST = "geometry_msgs/msg/Twist"


def twist(forward, turn):
    return from_dict(TWIST, {"linear": {"x": forward}, "angular": {"z": turn}})


@pytest.mark.parametrize("turn", [0.0, -60.0, 100.0])
def test_numbers_up_to_the_limit_are_valid_even_if_their_sum_is_larger(turn):
    assert not unfit(twist(100.0, turn), most=100.0)


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 100.5, -100.5])
@pytest.mark.parametrize("other", [0.0, 100.0, -100.0])
def test_one_number_that_is_not_valid_is_found(wrong, other):
    assert "linear.x" in unfit(twist(wrong, other), most=100.0)
    assert "angular.z" in unfit(twist(other, wrong), most=100.0)


@pytest.mark.parametrize("unset", [math.nan, math.inf])
def test_numbers_may_be_unset(unset):
    message = twist(unset, 1.0)
    assert not unfit(message, most=100.0, unset=True) and unfit(message, most=100.0)
