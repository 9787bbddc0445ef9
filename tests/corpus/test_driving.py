"""Bases that are driven forward and turned in place."""

import pytest
from tests.corpus.carts import RADIUS, TRACK, cart, controlled, plugin, written

from cartwheel.codes.devices import PLUGIN_PARAMETER_OBSOLETE
from cartwheel.codes.robot import WHEEL_DIAMETER_MISMATCH, WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot
from cartwheel.corpus.driving import VELOCITY

INERTIA = 0.2
"""Of each wheel, kg m²: that of a flywheel."""


@pytest.mark.parametrize("diameter", [RADIUS, 2 * RADIUS])
def test_a_base_that_still_accelerates_is_measured_until_it_does_not(tmp_path, diameter):
    """The torque accelerates it to the commanded velocity in the middle of the measurement."""
    force = VELOCITY / 5.0 * (2.0 + 2 * INERTIA / RADIUS**2)
    torque = f"<wheelTorque>{force * RADIUS / 2}</wheelTorque>"
    drive = plugin(more=torque).replace("Diameter>0.1<", f"Diameter>{diameter}<")
    heavy = cart().replace('iyy="1e-4" izz="2e-4"', f'iyy="{INERTIA}" izz="{INERTIA}"')
    heavy = heavy.replace('ixx="1e-4"', f'ixx="{INERTIA}"')
    verdict = try_robot(written(tmp_path, heavy, drive), standing=1.0)
    (driven,) = verdict.drives
    assert driven.error == pytest.approx(2 * RADIUS / diameter - 1.0, abs=0.02)
    wrong = ("drive", WHEEL_DIAMETER_MISMATCH) if diameter == RADIUS else None
    assert [(each.test, each.code) for each in verdict.faults[:1]] == ([wrong] if wrong else [])


@pytest.mark.parametrize("tag", ["torque", "wheelTorque"])
def test_a_torque_that_gazebo_ignores_explains_why_a_heavy_base_is_slow(tmp_path, tag):
    """With the default of 5 N m, it cannot push the casters, which slide."""
    heavy = cart(friction=0.5).replace('mass value="2"', 'mass value="900"')
    drive = plugin(more=f"<{tag}>600</{tag}>")
    verdict = try_robot(written(tmp_path, heavy, drive), standing=1.0)
    faults = [(each.code, each.source) for each in verdict.faults if each.test == "drive"]
    assert faults == [(PLUGIN_PARAMETER_OBSOLETE, "file")] * (tag == "torque")


@pytest.mark.parametrize("timeout", [0.03, 0.011])
def test_commands_are_published_before_the_controller_stops_the_wheels(tmp_path, timeout):
    """Otherwise it is too slow, which hides that it turns too fast."""
    drive = controlled(tmp_path, 1.25 * TRACK)
    file = tmp_path / "base.yaml"
    file.write_text(f"{file.read_text()}    cmd_vel_timeout: {timeout}\n")
    verdict = try_robot(written(tmp_path, cart(), drive), standing=1.0)
    (driven,) = verdict.drives
    assert driven.error == pytest.approx(0.0, abs=0.01)
    assert driven.error_turn == pytest.approx(0.25, abs=0.02)
    assert [(each.test, each.code) for each in verdict.faults] == [
        ("turn", WHEEL_SEPARATION_MISMATCH)
    ]


def test_a_plugin_without_wheels_receives_commands_before_they_expire(tmp_path):
    move = (
        '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so">'
        "<commandTopic>cmd_vel</commandTopic><cmdTimeout>0.03</cmdTimeout></plugin></gazebo>"
    )
    verdict = try_robot(written(tmp_path, cart(), move), standing=1.0)
    (driven,) = verdict.drives
    assert driven.passes
