"""The tags with the port of a flight controller."""

from __future__ import annotations

import ipaddress
from typing import Any

from cartwheel.codes import devices
from cartwheel.devices.autopilots.datagrams import HOST
from cartwheel.dialects.plugin import Plugin

MOST_PORT = 65535
"""Largest number of a port."""


def check_address(plugin: Plugin[Any], tag: str, address: str, *, program: str) -> None:
    """Reports an address of another computer, which has no effect.

    Args:
        plugin: The plugin.
        tag: Tag with the address.
        address: The address, such as ``localhost``.
        program: Name of the flight controller's program.
    """
    address = address.strip()
    try:
        loopback = address == "localhost" or ipaddress.ip_address(address).is_loopback
    except ValueError:
        loopback = False
    if not loopback:
        plugin.warn(
            devices.PLUGIN_PARAMETER_UNSUPPORTED,
            f'<{tag}> "{address}" is not a loopback address, so packets are received on {HOST}',
            at=plugin.scope.place_of(tag),
            hint=f"Run {program} on this computer.",
            values={"parameter": tag, "value": address},
        )
