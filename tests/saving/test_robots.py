"""A saved or reset world continues bit for bit: a robot for each plugin."""

from pathlib import Path

import pytest
from tests.reserved import free_port
from tests.saving.continuing import compare
from tests.saving.journeys import ROBOTS

CONNECTED = {
    "ArduPilotPlugin.urdf": ["Conversation"],
    "libgazebo_mavlink_interface.urdf": ["Px4Link"],
}
"""Robots with a connection to a flight controller, which is not saved, and its class."""
PORTS = ("39002", "34560")
"""The ports of these robots, which other tests may use at the same time."""
NAMES = sorted(each.name for each in ROBOTS.iterdir() if each.suffix in (".urdf", ".world"))


def with_own_port(name: str, folder: Path) -> Path:
    """The robot; a copy of it in the folder if it has a port."""
    text = (ROBOTS / name).read_text()
    port = next((each for each in PORTS if each in text), None)
    assert (port is not None) is (name in CONNECTED)
    if port is None:
        return ROBOTS / name
    copy = folder / name
    copy.write_text(text.replace(port, str(free_port())))
    return copy


@pytest.mark.parametrize("name", NAMES)
def test_each_plugin_continues_and_is_new_after_a_reset(name, elsewhere, tmp_path):
    left_out = compare(with_own_port(name, tmp_path), elsewhere, resets=True)
    assert [each.rpartition("(")[2].rstrip(")") for each in left_out] == CONNECTED.get(name, [])
