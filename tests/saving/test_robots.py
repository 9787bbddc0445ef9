"""A saved or reset world continues bit for bit: a robot for each plugin."""

import pytest
from tests.saving.continuing import compare
from tests.saving.journeys import ROBOTS

CONNECTED = {
    "ArduPilotPlugin.urdf": ["Conversation"],
    "libgazebo_mavlink_interface.urdf": ["Px4Link"],
}
"""Robots with a connection to a flight controller, which is not saved, and its class."""
NAMES = sorted(each.name for each in ROBOTS.iterdir() if each.suffix in (".urdf", ".world"))


@pytest.mark.parametrize("name", NAMES)
def test_each_plugin_continues_and_is_new_after_a_reset(name, elsewhere):
    left_out = compare(ROBOTS / name, elsewhere, resets=True)
    assert [each.rpartition("(")[2].rstrip(")") for each in left_out] == CONNECTED.get(name, [])
