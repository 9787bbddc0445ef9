"""A saved world continues bit for bit: a robot for each plugin."""

import pytest
from tests.saving.continuing import compare
from tests.saving.journeys import ROBOTS, Journey

CONNECTED = {
    "ArduPilotPlugin.urdf": ["Conversation"],
    "libgazebo_mavlink_interface.urdf": ["Px4Link"],
}
"""Robots with a connection to a flight controller, which is not saved, and its class."""
NAMES = sorted(each.name for each in ROBOTS.iterdir() if each.suffix in (".urdf", ".world"))


@pytest.mark.parametrize("name", NAMES)
def test_each_plugin_continues(name, elsewhere):
    left_out = compare(ROBOTS / name, elsewhere)
    assert [each.rpartition("(")[2].rstrip(")") for each in left_out] == CONNECTED.get(name, [])


@pytest.mark.parametrize("name", NAMES)
def test_a_reset_plugin_is_that_of_a_new_world(name):
    new = Journey(ROBOTS / name, seed=3)
    with new.world:
        expected = new.go_on()
    used = Journey(ROBOTS / name, seed=4)
    with used.world as world:
        used.set_out()
        world.reset(seed=3)
        assert used.go_on() == expected
