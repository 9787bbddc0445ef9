"""The largest efforts that gravity demands of joints."""

import math

import pytest
from tests.dialects.ros_control.arms import ARM, GRAVITY, MASS, beam, robot

from cartwheel.description import load_text
from cartwheel.devices.joints.gravity import gravity_efforts

ALONE = MASS * GRAVITY * ARM
"""N m: of one beam."""
LENGTH = 1.0
"""m, between the joints of two beams."""


def chain(**second):
    return load_text(robot(beam("near", "world") + beam("far", "near", **second), ""))


def test_a_joint_holds_its_links_in_the_worst_pose():
    """The joint of the second beam is above that of the first."""
    efforts = gravity_efforts(chain())
    assert efforts["far_joint"] == pytest.approx(ALONE, rel=1e-3)
    # The most with both beams horizontal; no pose exceeds it.
    most = MASS * GRAVITY * (math.hypot(ARM, LENGTH) + ARM)
    assert 0.95 * most < efforts["near_joint"] <= most


def test_a_fixed_link_is_held_at_its_place():
    most = MASS * GRAVITY * math.hypot(2 * ARM, LENGTH)
    assert gravity_efforts(chain(kind="fixed")) == {"near_joint": pytest.approx(most, rel=1e-3)}


def test_a_joint_with_a_vertical_axis_needs_no_effort():
    efforts = gravity_efforts(
        load_text(robot(beam("near", "world", axis="0 0 1") + beam("far", "near"), ""))
    )
    assert efforts["near_joint"] == pytest.approx(0.0, abs=1e-9)
    assert efforts["far_joint"] == pytest.approx(ALONE, rel=1e-3)


@pytest.mark.parametrize(("axis", "share"), [("0 0 1", 1.0), ("1 0 0", 0.0), ("0 3 4", 0.8)])
def test_a_prismatic_joint_holds_the_weight_along_its_axis(axis, share):
    near = beam("near", "world", kind="prismatic", axis=axis)
    efforts = gravity_efforts(load_text(robot(near + beam("far", "near"), "")))
    assert efforts["near_joint"] == pytest.approx(share * 2 * MASS * GRAVITY)


def test_a_link_without_gravity_has_no_weight():
    floats = '<gazebo reference="far"><gravity>false</gravity></gazebo></robot>'
    arm = robot(beam("near", "world") + beam("far", "near"), "").replace("</robot>", floats)
    efforts = gravity_efforts(load_text(arm))
    assert efforts["near_joint"] == pytest.approx(ALONE, rel=1e-3)
    assert efforts["far_joint"] == 0.0
