"""Bases with wheels that are fixed to the world."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written

from cartwheel.checks.checking import check
from cartwheel.codes.robot import BASE_FIXED
from cartwheel.corpus import try_robot

HOLD = (
    '<link name="world"/><joint name="hold" type="fixed"><parent link="world"/>'
    '<child link="base"/></joint>'
)


@pytest.mark.parametrize("held", [True, False])
def test_a_controller_cannot_drive_a_base_that_the_world_holds(tmp_path, held):
    path = written(tmp_path, cart(), controlled(tmp_path), HOLD * held)
    found = [each for each in check(path).findings if each.code is BASE_FIXED]
    assert len(found) == held
    for each in found:
        assert each.values["controller"] == "base"
        assert each.values["joint"] == "hold"
    verdict = try_robot(path, standing=1.0)
    assert verdict.controllers == ("base",)
    assert verdict.outcome == ("file" if held else "good")
    faults = [(each.test, each.subject, each.code) for each in verdict.faults]
    assert faults == [("drive", "base", BASE_FIXED)] * held


def test_a_controller_that_does_not_run_is_not_named(tmp_path):
    path = written(tmp_path, cart(), controlled(tmp_path), HOLD, plugin())
    text = (tmp_path / "base.yaml").read_text()
    (tmp_path / "base.yaml").write_text(text.replace("wheel_radius: 0.05", "wheel_radius: none"))
    verdict = try_robot(path, standing=1.0)
    assert not verdict.controllers
    held = [each.subject for each in verdict.faults if each.code is BASE_FIXED]
    assert held == ["gazebo_ros_diff_drive"]
