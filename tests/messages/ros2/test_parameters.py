"""Parameters of nodes: their types, and which names a listing has."""

from typing import Any

import pytest

from cartwheel.messages import encode_cdr
from cartwheel.messages.ros2.parameters import FIELDS, listed, parameter_type, parameter_value

NAMES = ["a", "a.b", "a.b.c", "ab.c", "d.e.f.g"]


@pytest.mark.parametrize(
    ("value", "number"),
    [
        (True, 1), (3, 2), (0.5, 3), ("x", 4),
        ([True, False], 6), ([1, 2], 7), ([0.5, 1], 8), (["x", "y"], 9),
        ([], 0), (None, 0), ({}, 0), ([1, "x"], 0), ([[1]], 0), ([True, 1.0], 0),
    ],
)  # fmt: skip
def test_a_value_has_the_type_that_ros_gives_it(value: Any, number: int) -> None:
    assert parameter_type(value) == number
    made = parameter_value(value)
    encode_cdr(made)
    assert made.type == number
    if number:
        told = getattr(made, FIELDS[number])
        assert list(told) == value if isinstance(value, list) else told == value


@pytest.mark.parametrize(
    ("prefixes", "depth", "found"),
    [
        ([], 0, NAMES),
        ([], 1, ["a"]),
        ([], 2, ["a", "a.b", "ab.c"]),
        (["a"], 0, ["a", "a.b", "a.b.c"]),
        (["a"], 1, ["a", "a.b"]),
        (["a.b", "d"], 1, ["a.b", "a.b.c"]),
        (["none"], 0, []),
    ],
)
def test_a_listing_has_what_is_below_its_prefixes(
    prefixes: list[str], depth: int, found: list[str]
) -> None:
    result = listed(reversed(NAMES), prefixes, depth)
    assert result.names == found
    assert result.prefixes == sorted({n.rpartition(".")[0] for n in found if "." in n})
