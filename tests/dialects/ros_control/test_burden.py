"""What joints bear, and effort limits that cannot be meant."""

import math

import pytest
from tests.dialects.ros_control.arms import ARM, GRAVITY, MASS, ROS1, beam, robot, transmission

from cartwheel.codes import devices
from cartwheel.description import load_text
from cartwheel.dialects.ros_control.burden import burdens

ALONE = MASS * GRAVITY * ARM
"""N m: of one beam."""
LENGTH = 1.0
"""m, between the joints of two beams."""


def chain(**second):
    return load_text(robot(beam("near", "world") + beam("far", "near", **second), ""))


def test_a_joint_bears_what_it_carries_in_the_worst_of_its_poses():
    """The second beam stands upon the first, and not at its end."""
    asked = burdens(chain())
    assert asked["far_joint"] == pytest.approx(ALONE, rel=1e-3)
    # Both beams level, and the line between their joints as well as the first beam may have it.
    most = MASS * GRAVITY * (math.hypot(ARM, LENGTH) + ARM)
    assert 0.95 * most < asked["near_joint"] <= most


def test_what_is_fixed_is_carried_where_it_is():
    most = MASS * GRAVITY * math.hypot(2 * ARM, LENGTH)
    assert burdens(chain(kind="fixed")) == {"near_joint": pytest.approx(most, rel=1e-3)}


def test_a_joint_bears_nothing_about_an_upright_axis():
    asked = burdens(load_text(robot(beam("near", "world", axis="0 0 1") + beam("far", "near"), "")))
    assert asked["near_joint"] == pytest.approx(0.0, abs=1e-9)
    assert asked["far_joint"] == pytest.approx(ALONE, rel=1e-3)


@pytest.mark.parametrize(("axis", "share"), [("0 0 1", 1.0), ("1 0 0", 0.0), ("0 3 4", 0.8)])
def test_what_slides_bears_a_weight_as_far_as_it_slides_up(axis, share):
    near = beam("near", "world", kind="prismatic", axis=axis)
    asked = burdens(load_text(robot(near + beam("far", "near"), "")))
    assert asked["near_joint"] == pytest.approx(share * 2 * MASS * GRAVITY)


def test_what_gravity_leaves_alone_weighs_nothing():
    floats = '<gazebo reference="far"><gravity>false</gravity></gazebo></robot>'
    arm = robot(beam("near", "world") + beam("far", "near"), "").replace("</robot>", floats)
    asked = burdens(load_text(arm))
    assert asked["near_joint"] == pytest.approx(ALONE, rel=1e-3)
    assert asked["far_joint"] == 0.0


@pytest.fixture
def held(bench):
    """A beam that is to be held by an effort limit: where it was, every 50 ms for 2 s."""

    def make(effort):
        limit = f'lower="-3" upper="3" effort="{effort}" velocity="10"'
        body = beam("beam", "world", limit=limit) + transmission("beam_joint", "Position")
        group = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
        made = bench(robot(body, ROS1), {"c": group})
        made.publish("/c/command", "std_msgs/msg/Float64", data=-0.2)
        places = []
        for _ in range(40):
            made.world.run(0.05)
            places.append(made.position("beam_joint"))
        return places, made.warnings

    return make


def test_an_effort_limit_that_does_not_bear_the_weight_does_not_let_an_arm_sink(held):
    places, warnings = held(1)
    assert places[-1] == pytest.approx(-0.2, abs=1e-3)
    (said,) = warnings
    assert said.code is devices.EFFORT_LIMIT_TOO_LOW
    assert said.values["stated"] == 1
    assert said.values["needed"] == pytest.approx(9.8, rel=0.01)


def test_an_effort_limit_that_bears_the_weight_counts(held):
    places, warnings = held(1.02 * ALONE)
    assert warnings == []
    assert places[-1] == pytest.approx(-0.2, abs=1e-3)
