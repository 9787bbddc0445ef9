"""Axes of the wheels that controllers drive."""

import pytest
from tests.corpus.carts import cart, controlled, written
from tests.corpus.test_heading import CAMERA

import cartwheel
from cartwheel.codes.robot import WHEEL_AXIS_MISALIGNED
from cartwheel.corpus import try_robot

AXIS = '<axis xyz="0 0 1"/>'


def found(path):
    return [each for each in cartwheel.check(path).findings if each.code is WHEEL_AXIS_MISALIGNED]


def reversed_cart(*sides):
    """A cart with wheels whose axes point to the right."""
    head, left, right = cart().split(AXIS)
    axes = [AXIS.replace("0 0 1", "0 0 -1") if side in sides else AXIS for side in (0, 1)]
    return f"{head}{axes[0]}{left}{axes[1]}{right}"


@pytest.mark.parametrize("sides", [(), (0,), (1,), (0, 1)])
def test_wheels_of_controllers_with_reversed_axes_are_reported(tmp_path, sides):
    path = written(tmp_path, reversed_cart(*sides), controlled(tmp_path))
    names = [("left_joint", "right_joint")[side] for side in sides]
    assert [each.values["joint"] for each in found(path)] == names
    verdict = try_robot(path, standing=1.0)
    assert {each.code for each in verdict.faults} == ({WHEEL_AXIS_MISALIGNED} if sides else set())


def test_a_negative_multiplier_makes_up_for_a_reversed_axis(tmp_path):
    path = written(tmp_path, reversed_cart(1), controlled(tmp_path))
    file = tmp_path / "base.yaml"
    file.write_text(file.read_text() + "    right_wheel_radius_multiplier: -1.0\n")
    assert not found(path)


@pytest.mark.wording
@pytest.mark.parametrize("sides", [(0,), (0, 1)])
def test_the_message_states_the_axis_of_the_other_wheel_if_it_points_to_the_left(tmp_path, sides):
    path = written(tmp_path, reversed_cart(*sides), controlled(tmp_path))
    if 1 in sides:
        file = tmp_path / "base.yaml"
        file.write_text(file.read_text() + "    right_wheel_radius_multiplier: -1.0\n")
    (one,) = found(path)
    assert one.values["joint"] == "left_joint"
    assert ("the other wheel's axis to the left" in one.message) is (1 not in sides)


def test_reversed_axes_of_swapped_wheels_face_backwards_if_a_camera_does(tmp_path):
    parts = reversed_cart(0, 1), controlled(tmp_path, swapped=True)
    assert not found(written(tmp_path, *parts, CAMERA.format(yaw=3.14)))
    assert len(found(written(tmp_path, *parts))) == 2
