"""Arithmetic on floats and arrays, with equal bits."""

import math
import struct

import numpy as np
import pytest

from cartwheel.devices import elementwise

VALUES = [0.0, -0.0, 1e-300, 0.1, -0.7, 1.5, 3.0, -123.456, 1e9, math.inf, -math.inf]
ONE = ("sin", "cos", "tan", "atan")
TWO = ("minimum", "maximum", "atan2", "copysign")


def bits(value):
    assert not isinstance(value, np.ndarray)
    return struct.pack("<d", value)


def finite(name, values):
    return [each for each in values if math.isfinite(each) or name == "atan"]


@pytest.mark.parametrize("name", ONE)
def test_a_function_of_one_number_has_the_bits_of_math(name):
    function = getattr(elementwise, name)
    values = [*finite(name, VALUES), *np.random.default_rng(1).normal(0, 10, 1000).tolist()]
    expected = [getattr(math, name)(each) for each in values]
    assert list(map(bits, map(function, values))) == list(map(bits, expected))
    assert list(map(bits, function(np.array(values)).tolist())) == list(map(bits, expected))


@pytest.mark.parametrize("name", TWO)
def test_a_function_of_two_numbers_has_the_bits_of_pythons(name):
    function = getattr(elementwise, name)
    own = {"minimum": min, "maximum": max}.get(name) or getattr(math, name)
    pairs = [(a, b) for a in VALUES for b in VALUES]
    expected = [bits(own(a, b)) for a, b in pairs]
    assert [bits(function(a, b)) for a, b in pairs] == expected
    first, second = (np.array(each) for each in zip(*pairs, strict=True))
    assert list(map(bits, function(first, second).tolist())) == expected
    # One of them may be a single number.
    assert bits(function(first, 0.1)[5]) == bits(own(pairs[5][0], 0.1))
    assert bits(function(0.1, second)[5]) == bits(own(0.1, pairs[5][1]))


def test_a_clamped_number_lies_between_its_bounds():
    assert [elementwise.clamp(each, -1.0, 2.0) for each in (-3.0, 0.5, 3.0)] == [-1.0, 0.5, 2.0]
    clamped = elementwise.clamp(np.array([-3.0, 0.5, 3.0]), -1.0, np.array([2.0, 0.0, 4.0]))
    assert clamped.tolist() == [-1.0, 0.0, 3.0]


def test_a_choice_is_made_for_each_element():
    assert elementwise.where(True, 1.0, 2.0) == 1.0
    chosen = elementwise.where(np.array([True, False]), np.array([1.0, 2.0]), 3.0)
    assert chosen.tolist() == [1.0, 3.0]


def test_a_condition_is_true_anywhere():
    assert elementwise.anywhere(True) and not elementwise.anywhere(False)
    assert elementwise.anywhere(np.array([False, True]))
    assert not elementwise.anywhere(np.array([False, False]))


def test_remainders_have_the_same_bits():
    angles = [0.0, -0.0, 3.0, -3.5, 6.3, 123.4]
    together = elementwise.remainder(np.array(angles), 2 * math.pi)
    for angle, each in zip(angles, together, strict=True):
        assert bits(float(each)) == bits(math.remainder(angle, 2 * math.pi))
