"""A function that sets the same fields each time makes the messages of `from_dict`."""

from __future__ import annotations

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.graph import FIELD_UNKNOWN, FIELD_VALUE_INVALID
from cartwheel.messages import from_dict, to_dict
from cartwheel.messages.making import maker


@pytest.mark.parametrize(
    ("kind", "names", "values", "expected"),
    [
        ("geometry_msgs/msg/Twist", ["linear.x", "angular.z"], [0.5, -1.0],
         {"linear": {"x": 0.5}, "angular": {"z": -1.0}}),
        ("geometry_msgs/msg/Twist", ["angular.z", "linear.x"], [-1.0, 0.5],
         {"linear": {"x": 0.5}, "angular": {"z": -1.0}}),
        ("geometry_msgs/msg/TwistStamped", ["twist.linear.y"], [2.0],
         {"twist": {"linear": {"y": 2.0}}}),
        ("std_msgs/msg/Float64", ["data"], [3.0], {"data": 3.0}),
        ("std_msgs/msg/Int32", ["data"], [3.0], {"data": 3}),
        ("std_msgs/msg/Empty", [], [], {}),
    ],
)  # fmt: skip
def test_it_makes_the_message_of_its_fields(kind, names, values, expected):
    make = maker(kind, names)
    make(np.ones(len(names)).tolist())
    made = make(values)
    assert to_dict(made) == to_dict(from_dict(kind, expected))
    assert type(made) is type(from_dict(kind, expected))


def test_messages_are_separate():
    make = maker("geometry_msgs/msg/Twist", ["linear.x"])
    first, second = make([1.0]), make([2.0])
    assert (first.linear.x, second.linear.x) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("names", "code"), [(["linear.w"], FIELD_UNKNOWN), (["linear"], FIELD_VALUE_INVALID)]
)
def test_wrong_fields_are_errors(names, code):
    with raises(code):
        maker("geometry_msgs/msg/Twist", names)


def test_values_of_integers_are_checked():
    make = maker("std_msgs/msg/Int8", ["data"])
    with raises(FIELD_VALUE_INVALID):
        make([1000.0])
