"""Parts of arrays in messages, by the names of their fields."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.coded import raises

from cartwheel import arrays
from cartwheel.arrays.fields import with_changed
from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.messages import from_dict

SCAN = from_dict("sensor_msgs/msg/LaserScan", {"ranges": [1.0, 2.0, 3.0, 4.0]})
TOUCH = from_dict("gazebo_msgs/msg/ContactsState", {"states": [{"depths": [0.5]}]})
FREE = from_dict("gazebo_msgs/msg/ContactsState", {})


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("ranges[:2]", [1, 2]),
        ("ranges[1:3]", [2, 3]),
        ("ranges[::2]", [1, 3]),
        ("ranges[2:400]", [3, 4]),
        ("ranges[-1:]", [4]),
        ("ranges[:-1]", [1, 2, 3]),
        ("ranges[:]", [1, 2, 3, 4]),
    ],
)
def test_a_part_of_an_array_is_that_of_python(field, expected):
    assert arrays.values([SCAN, SCAN], field).tolist() == [expected, expected]
    assert np.array_equal(arrays.reader(field)(SCAN), expected)


@pytest.mark.parametrize("read", [lambda field: arrays.values([SCAN], field)[0],
                                  lambda field: arrays.single(SCAN, field)])  # fmt: skip
def test_an_index_counts_from_either_end(read):
    assert (read("ranges[1]"), read("ranges[-1]")) == (2.0, 4.0)


@pytest.mark.parametrize("field", ["ranges[4]", "ranges[-5]", "ranges[4:]", "ranges[1000]"])
def test_an_index_after_the_end_of_all_arrays_is_an_error(field):
    for read in (
        lambda: arrays.values([SCAN, SCAN], field),
        lambda: arrays.reader(field)(SCAN),
        lambda: with_changed(SCAN, field, lambda numbers: numbers + 1),
    ):
        with raises(FIELD_UNKNOWN, field=field, length=4):
            read()


def test_an_array_that_is_long_enough_in_one_message_is_nan_in_the_others():
    short = from_dict("sensor_msgs/msg/LaserScan", {"ranges": [1.0]})
    assert np.array_equal(arrays.values([short, SCAN], "ranges[2]"), [np.nan, 3.0], equal_nan=True)


def test_elements_that_do_not_exist_at_times_are_nan():
    """Such as contacts, of which there may be none."""
    assert np.isnan(arrays.values([FREE, TOUCH], "states[1].depths[0]")).all()
    assert arrays.values([FREE, TOUCH], "states[0].depths[0]")[1] == 0.5
    assert math.isnan(float(arrays.single(FREE, "states[0].depths[0]")))


@pytest.mark.parametrize(
    "field",
    ["ranges[2:1]", "ranges[::0]", "ranges[::-1]", "ranges[:2].x", "ranges[a]", "ranges[:2][0]",
     "ranges[", "header[:2]", f"ranges[{10**9}]", f"ranges[:{10**9}]"],
)  # fmt: skip
def test_what_is_no_part_is_refused(field):
    with raises(FIELD_UNKNOWN, field=field):
        arrays.values([SCAN], field)


def test_a_part_is_changed():
    changed = with_changed(SCAN, "ranges[1:3]", lambda numbers: numbers + 10)
    assert changed.ranges.tolist() == [1, 12, 13, 4]
    changed = with_changed(changed, "ranges[-1]", lambda numbers: numbers * 2)
    assert changed.ranges.tolist() == [1, 12, 13, 8]
    assert SCAN.ranges.tolist() == [1, 2, 3, 4]


def test_a_single_value_can_be_a_text():
    scan = from_dict("sensor_msgs/msg/LaserScan", {"header": {"frame_id": "laser"}})
    assert arrays.single(scan, "header.frame_id") == "laser"
    assert arrays.single(from_dict("std_msgs/msg/Bool", {"data": True}), "data") is True
    with raises(FIELD_UNKNOWN, field="ranges"):
        arrays.single(SCAN, "ranges")


@pytest.mark.wording
def test_the_hints():
    with raises(FIELD_UNKNOWN) as caught:
        arrays.values([SCAN], "ranges[5]")
    assert caught.value.hint == "The last one has the index 3."
    with raises(FIELD_UNKNOWN) as caught:
        arrays.values([TOUCH], "states[:1]")
    assert caught.value.hint is not None and caught.value.hint.startswith("Write states[0].wrench")
