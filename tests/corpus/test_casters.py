"""Bases that drag a caster."""

import pytest
from tests.checks.test_steering_and_casters import sdf_cart

from cartwheel.codes.robot import CASTER_FRICTION
from cartwheel.corpus import try_robot


@pytest.mark.parametrize(("effort", "moves"), [(0.7, False), (6.0, True)])
def test_a_base_whose_caster_holds_it_does_not_drive(tmp_path, effort, moves):
    """Half of the torque that the caster's friction requires, and four times as much."""
    path = tmp_path / "cart.sdf"
    path.write_text(sdf_cart(effort=effort))
    verdict = try_robot(path, standing=1.0)
    (drive,) = verdict.drives
    assert (drive.measured > 0.15) == moves
    for fault in verdict.faults:
        assert fault.code is CASTER_FRICTION, fault
        assert fault.reason.values["holds"] != moves
    assert moves or {fault.test for fault in verdict.faults} == {"drive", "turn"}
