"""Swapped wheels whose axes point in opposite directions."""

import pytest
from tests.corpus.carts import cart, controlled, written

import cartwheel
from cartwheel.codes.robot import WHEELS_SWAPPED
from cartwheel.corpus import try_robot

AXIS = '<axis xyz="0 0 1"/>'


@pytest.mark.wording
@pytest.mark.parametrize(
    ("left", "right", "said", "ahead", "turn"),
    [
        # Both axes point to the left, so only the sides are wrong.
        (1, 1, "turns in the wrong direction", 1, -1),
        # The multiplier makes up for the mirrored axes, by turning both wheels backwards or ahead.
        (1, -1, "drives backwards", -1, 1),
        (-1, 1, "turns in the wrong direction", 1, -1),
    ],
)
def test_what_swapped_wheels_do_depends_on_their_axes(tmp_path, *, left, right, said, ahead, turn):
    """The controller takes the right wheel for the left one."""
    # The first wheel of the cart is on the left.
    first, second = cart().split(AXIS, 1)
    axes = (
        first + AXIS.replace("1", f"{left}") + second.replace(AXIS, AXIS.replace("1", f"{right}"))
    )
    control = controlled(tmp_path, swapped=True)
    file = tmp_path / "base.yaml"
    if left != right:
        # For the wheels that the controller takes for the right ones.
        file.write_text(file.read_text() + "    right_wheel_radius_multiplier: -1.0\n")
    path = written(tmp_path, axes, control)
    (finding,) = [e for e in cartwheel.check(path).findings if e.code is WHEELS_SWAPPED]
    assert said in finding.message
    (drive,) = try_robot(path, standing=1.0).drives
    assert drive.measured == pytest.approx(0.2 * ahead, rel=0.1)
    assert drive.measured_turn == pytest.approx(0.4 * turn, rel=0.1)
