"""Swapped wheels whose axes point in opposite directions."""

import pytest
from tests.corpus.carts import cart, controlled, written

import cartwheel
from cartwheel.codes.robot import WHEELS_SWAPPED
from cartwheel.corpus import try_robot

AXIS = '<axis xyz="0 0 1"/>'


@pytest.mark.wording
@pytest.mark.parametrize(
    ("axes", "height", "ways", "advice"),
    [
        (1, 0.0, (1, 1), "Swap the two names."),
        (-1, 0.0, (1, 1), "Swap the two names. Reverse both axes."),
        # The multipliers make up for the axes.
        (-1, 0.0, (-1, -1), "Swap the two names."),
        # The direction of the axle is unknown.
        (1, 0.1, (1, 1), "Swap the two names."),
    ],
)
def test_axes_are_only_reversed_if_the_robot_drives_backwards(
    tmp_path, *, axes, height, ways, advice
):
    robot = cart().replace(AXIS, AXIS.replace("1", f"{axes}"))
    robot = robot.replace("0.1 -0.02", f"0.1 {height - 0.02:g}", 1)
    control = controlled(tmp_path, swapped=True)
    sides = zip(("left", "right"), ways, strict=True)
    file = tmp_path / "base.yaml"
    more = "".join(f"    {side}_wheel_radius_multiplier: {way}.0\n" for side, way in sides)
    file.write_text(file.read_text() + more)
    findings = cartwheel.check(written(tmp_path, robot, control)).findings
    (finding,) = [each for each in findings if each.code is WHEELS_SWAPPED]
    assert finding.hint == advice


@pytest.mark.wording
@pytest.mark.parametrize("axis", [1, -1])
def test_wheels_beside_each_other_along_x_need_only_other_names(tmp_path, axis):
    turned = cart().replace('xyz="0 0.1 ', 'xyz="0.1 0 ').replace('xyz="0 -0.1 ', 'xyz="-0.1 0 ')
    turned = turned.replace('rpy="-1.5708 0 0"', 'rpy="0 1.5708 0"')
    turned = turned.replace(AXIS, AXIS.replace("1", f"{axis}"))
    path = written(tmp_path, turned, controlled(tmp_path, swapped=axis > 0))
    (finding,) = [e for e in cartwheel.check(path).findings if e.code is WHEELS_SWAPPED]
    assert finding.hint == "Swap the two names."


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
