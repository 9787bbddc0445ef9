"""Robots whose turn rate depends on ``<slip1>`` and ``<slip2>``, which are not simulated."""

import pytest
from tests.checks.test_slip import model
from tests.corpus.carts import plugin, written
from tests.corpus.test_several_causes import dragging

from cartwheel.codes.robot import CASTER_FRICTION, SKID_STEERING, WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot


@pytest.mark.parametrize(("slip", "outcome"), [(0.0, "good"), (0.01, "unknown")])
def test_a_robot_that_turns_as_commanded_only_without_slip_does_not_pass(tmp_path, slip, outcome):
    path = tmp_path / "m.sdf"
    path.write_text(model(0.8, slip))
    verdict = try_robot(path, standing=1.0)
    assert all(drive.passes for drive in verdict.drives)
    assert verdict.outcome == outcome
    assert [(each.test, each.code) for each in verdict.faults] == (
        [] if outcome == "good" else [("turn", SKID_STEERING)]
    )


SLIPPERY = (
    '<gazebo reference="caster"><collision><surface><friction><ode><slip1>{0}</slip1>'
    "<slip2>{0}</slip2></ode></friction></surface></collision></gazebo>"
)


@pytest.mark.parametrize(
    ("separation", "reason"), [(0.2, CASTER_FRICTION), (0.4, WHEEL_SEPARATION_MISMATCH)]
)
@pytest.mark.parametrize(("slip", "source"), [(0.0, "file"), (0.1, "unknown")])
def test_what_slides_with_slip_is_no_certain_reason_for_a_wrong_turn_rate(
    tmp_path, separation, reason, slip, source
):
    path = written(tmp_path, dragging(0.5), SLIPPERY.format(slip), plugin(separation))
    (fault,) = try_robot(path, standing=1.0).faults
    assert (fault.test, fault.code, fault.source) == ("turn", reason, source)
