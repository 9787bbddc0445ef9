"""The efforts with which joints accelerate what they move."""

import time

import pytest

from cartwheel.description import load_text
from cartwheel.devices.joints.inertia import inertial_efforts

MASS, INERTIA, STEP = 2.0, 0.3, 0.5
"""kg and kg m² of each link, and m between two joints."""


def line(*kinds, axis="0 0 1"):
    """Links along x, each on a joint, the first of which is at a joint's step from the origin."""
    links = '<link name="l0"/>' + "".join(
        f'<link name="l{number}"><inertial><mass value="{MASS}"/><inertia ixx="{INERTIA}" ixy="0" '
        f'ixz="0" iyy="{INERTIA}" iyz="0" izz="{INERTIA}"/></inertial></link>'
        for number in range(1, len(kinds) + 1)
    )
    joints = "".join(
        f'<joint name="j{number}" type="{kind}"><parent link="l{number}"/>'
        f'<child link="l{number + 1}"/><origin xyz="{STEP} 0 0"/><axis xyz="{axis}"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        for number, kind in enumerate(kinds)
    )
    return load_text(f'<robot name="r">{links}{joints}</robot>')


def test_a_joint_turns_all_links_that_are_fixed_beyond_it():
    efforts = inertial_efforts(line("revolute", "fixed", "fixed"))
    # The first link turns about its own centre.
    levers = [0.0, STEP, 2 * STEP]
    assert efforts == {"j0": pytest.approx(sum(INERTIA + MASS * each**2 for each in levers))}


def test_a_slide_accelerates_at_a_tenth_and_also_what_turns_on_it():
    efforts = inertial_efforts(line("prismatic", "revolute", "fixed", axis="0 1 0"))
    # The last link is beside the axis of the hinge, but the axis is along the slide.
    assert efforts["j0"] == pytest.approx(0.1 * 3 * MASS)
    assert efforts["j1"] == pytest.approx(2 * INERTIA + MASS * STEP**2)


def test_thousands_of_links_beyond_many_joints_take_a_short_time():
    """With a mass matrix of its own for each link, this would take a minute."""
    robot = line(*["revolute"] * 199, *["fixed"] * 2000)
    start = time.monotonic()
    assert len(inertial_efforts(robot)) == 199
    assert time.monotonic() - start < 10.0
