"""Opens a Zenoh session, as a router if no router responds.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import json
import os
import socket
from typing import Any

from cartwheel.codes.wires import ZENOH_NOT_OPENED
from cartwheel.errors import CartwheelError
from rtps_lite.network import Reach

PORT = 7447
"""Port of the Zenoh router. If no router responds there, the session listens on it."""
_NOTICE = 0.5
"""Timeout in s for a router to respond."""


def open_session(zenoh: Any, reach: Reach) -> tuple[Any, bool]:
    """Opens a session. Returns it, and whether it acts as a router.

    Args:
        zenoh: Module of Zenoh.
        reach: Discovery range, which ``ZENOH_SESSION_CONFIG_URI`` overrides.

    Raises:
        CartwheelError: No session can be opened, or an environment variable is invalid.
    """
    is_router = False
    uri = os.environ.get("ZENOH_SESSION_CONFIG_URI")
    if uri:
        try:
            made = zenoh.Config.from_file(uri)
        except zenoh.ZError as error:
            raise _unusable("ZENOH_SESSION_CONFIG_URI", "refers to", uri, error) from None
    else:
        is_router = not _responds(PORT)
        made = zenoh.Config()
        for name, value in _settings(reach, is_router).items():
            made.insert_json5(name, json.dumps(value))
    for pair in filter(str.strip, os.environ.get("ZENOH_CONFIG_OVERRIDE", "").split(";")):
        name, _, text = pair.partition("=")
        try:
            made.insert_json5(name.strip(), text.strip())
        except zenoh.ZError as error:
            raise _unusable("ZENOH_CONFIG_OVERRIDE", "contains", pair, error) from None
    try:
        return zenoh.open(made), is_router
    except zenoh.ZError as error:
        raise CartwheelError(
            f"Zenoh cannot open a session: {error}", code=ZENOH_NOT_OPENED
        ) from None


def _settings(reach: Reach, is_router: bool) -> dict[str, Any]:
    """Settings of a session without ``ZENOH_SESSION_CONFIG_URI``, by their path."""
    listen, connect = "tcp/127.0.0.1:0", [f"tcp/127.0.0.1:{PORT}"]
    if is_router:
        host = "[::]" if reach.range == "SUBNET" else "127.0.0.1"
        listen, connect = f"tcp/{host}:{PORT}", [f"tcp/{peer}:{PORT}" for peer in reach.peers]
    return {
        "mode": "router" if is_router else "peer",
        "listen/endpoints": [listen],
        "connect/endpoints": connect,
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,
    }


def _unusable(variable: str, verb: str, value: str, error: Exception) -> CartwheelError:
    return CartwheelError(
        f"{variable} {verb} {value}, which cannot be used: {error}",
        code=ZENOH_NOT_OPENED,
        values={"variable": variable, "value": value},
    )


def _responds(port: int) -> bool:
    try:
        with socket.create_connection(("127.0.0.1", port), _NOTICE):
            return True
    except OSError:
        return False
