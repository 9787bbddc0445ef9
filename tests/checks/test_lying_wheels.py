"""Wheels whose cylinder was not turned to the axle, so that they lie flat."""

import math

import pytest

from cartwheel.checks import check
from cartwheel.codes.robot import UNBALANCED, WHEEL_NOT_ROUND

INERTIA = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
BODY = (
    '<link name="body"><inertial><origin xyz="0.02 0 0.1"/><mass value="2"/>'
    + INERTIA
    + '<collision><geometry><box size="0.5 0.3 0.1"/></geometry></collision></link>'
)
WHEEL = (
    '<link name="{name}"><inertial><mass value="0.2"/>'
    + INERTIA
    + '<collision><origin rpy="{turned} 0 0"/><geometry><cylinder radius="0.1" length="0.04"/>'
    "</geometry></collision></link>"
    '<joint name="{name}_joint" type="continuous"><parent link="body"/><child link="{name}"/>'
    '<origin xyz="0 {y} -0.05"/><axis xyz="0 1 0"/></joint>'
)


@pytest.fixture
def found(tmp_path):
    def run(turned, more=""):
        wheels = "".join(
            WHEEL.format(name=name, y=y, turned=turned)
            for name, y in (("left", 0.2), ("right", -0.2))
        )
        file = tmp_path / "cart.urdf"
        file.write_text(f'<robot name="cart">{BODY}{wheels}{more}</robot>')
        return check(file).findings

    return run


def lying(findings):
    return [each.values["link"] for each in findings if each.code is WHEEL_NOT_ROUND]


def angle(findings):
    (each,) = [each for each in findings if each.code is UNBALANCED]
    return each.values["angle"]


def test_wheels_without_a_motor_that_lie_flat_are_reported(found):
    assert lying(found(0)) == ["left", "right"]
    assert lying(found(math.pi / 2)) == []


def test_a_robot_tips_on_wheels_that_lie_flat_by_their_height(found):
    """The axle is 0.02 m above the ground instead of 0.1 m. The body's corner, 0.25 m ahead of the
    axle, is at its height.
    """
    assert angle(found(0)) == pytest.approx(math.asin(0.02 / 0.25), rel=0.01)
    assert angle(found(math.pi / 2)) == pytest.approx(math.asin(0.1 / 0.25), rel=0.01)
