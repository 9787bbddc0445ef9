"""What joints bear, and effort limits that cannot be meant."""

import math

import pytest
from tests.plugins.control.arms import ARM, GRAVITY, MASS, ROS1, beam, robot, transmission

from cartwheel.description import load_text
from cartwheel.plugins.control.burden import burden

ALONE = MASS * GRAVITY * ARM
"""N m: of one beam."""
LENGTH = 1.0
"""m, between the joints of two beams."""


def chain(**second):
    return load_text(robot(beam("near", "world") + beam("far", "near", **second), ""))


def test_a_joint_bears_all_that_it_carries_held_out_straight():
    """Though the second beam stands upon the first, and not at its end."""
    arm = chain()
    assert burden(arm, "far_joint") == pytest.approx(ALONE)
    assert burden(arm, "near_joint") == pytest.approx(ALONE + MASS * GRAVITY * (LENGTH + ARM))


def test_what_is_fixed_is_carried_where_it_is():
    arm = chain(kind="fixed")
    away = (LENGTH**2 + ARM**2) ** 0.5
    assert burden(arm, "near_joint") == pytest.approx(ALONE + MASS * GRAVITY * away)


def test_what_slides_bears_a_weight():
    arm = load_text(robot(beam("near", "world", kind="prismatic") + beam("far", "near"), ""))
    assert burden(arm, "near_joint") == pytest.approx(2 * MASS * GRAVITY)


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


def test_an_effort_limit_that_cannot_be_meant_does_not_let_an_arm_sink(held):
    places, warnings = held(1)
    assert places[-1] == pytest.approx(-0.2, abs=1e-3)
    (said,) = warnings
    assert "its effort limit of 1 N m cannot bear" in said
    assert "up to 9.8 N m" in said


def test_an_effort_limit_that_may_be_meant_does(held):
    """Half of what holds it level: it sinks beyond where its weight pulls no more than that."""
    places, warnings = held(ALONE / 2)
    assert max(places) > math.acos(0.5)
    assert warnings == []
