"""Joints by hand: where sliders send an arm, and what they show."""

import math

import pytest

from cartwheel.description.model import Axis, Joint
from cartwheel.errors import Origin
from cartwheel.viewer.panels.joints import range_of, way


def joint(name, velocity=None):
    return Joint(
        name=name,
        type="revolute",
        parent="a",
        child="b",
        origin=Origin(file="x", line=1),
        axis=Axis(xyz=(0.0, 0.0, 1.0), lower=-2.0, upper=2.0, velocity=velocity),
    )


JOINTS = {name: joint(name) for name in ("one", "two")}


def test_others_stay_where_they_are():
    targets, seconds = way(JOINTS, {"one": 0.1, "two": 0.3}, {}, {"one": 0.6})
    assert targets == {"one": 0.6, "two": 0.3}
    assert seconds == pytest.approx(0.5)


def test_others_that_are_on_their_way_go_on():
    targets, seconds = way(JOINTS, {"one": 0.1, "two": 0.3}, {"two": 1.3}, {"one": 0.1})
    assert targets == {"one": 0.1, "two": 1.3}
    assert seconds == pytest.approx(1.0)


def test_a_joint_s_own_limit_of_velocity_counts_and_a_small_way_takes_a_while():
    slow = {"one": joint("one", velocity=0.25)}
    assert way(slow, {"one": 0.0}, {}, {"one": 1.0})[1] == pytest.approx(4.0)
    assert way(slow, {"one": 0.0}, {}, {"one": 0.001})[1] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (-math.pi, math.pi, (-3.141, 3.141, 0.001)),
        (-2.0, 2.0, (-2.0, 2.0, 0.001)),
        (0.0, 0.04, (0.0, 0.04, 0.0001)),
        (-100.0, 100.0, (-100.0, 100.0, 0.001)),
    ],
)
def test_sliders_show_few_decimals_and_stay_within_the_limits(low, high, expected):
    wide = Joint(
        name="wide",
        type="revolute",
        parent="a",
        child="b",
        origin=Origin(file="x", line=1),
        axis=Axis(xyz=(0.0, 0.0, 1.0), lower=low, upper=high),
    )
    assert range_of(wide) == pytest.approx(expected, abs=1e-12)
