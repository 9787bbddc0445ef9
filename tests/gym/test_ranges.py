"""Ranges of `vary` that are refused at once."""

import pytest
from tests.coded import raises

from cartwheel.codes.world import VALUE_INVALID
from cartwheel.gym import vary


def test_an_unknown_coordinate_is_refused():
    with raises(VALUE_INVALID) as caught:
        vary("bot", pose={"yaws": (1.0, 1.1)})
    assert '"yaws" does not exist' in str(caught.value)


@pytest.mark.parametrize("where", ["mass", "friction", "damping", "effort", "light", "pose"])
@pytest.mark.parametrize("limits", [(1.1, 0.9), (1.0,), 1.0, (0.0, float("inf")), ("a", "b")])
def test_a_range_has_the_smaller_number_first(where, limits):
    with raises(VALUE_INVALID):
        vary("bot", **{where: {"x": limits} if where == "pose" else limits})


def test_swapped_limits_are_shown_in_order():
    with raises(VALUE_INVALID) as caught:
        vary("bot", mass=(1.1, 0.9))
    assert "Write (0.9, 1.1)" in str(caught.value)
