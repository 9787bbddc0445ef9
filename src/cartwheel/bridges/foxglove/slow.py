"""Detects clients of a Foxglove server that receive too slowly."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable

_LOG = logging.getLogger("foxglove.websocket.connected_client.send_lossy")
_FULL = re.compile(r"client (\S+) full")


class SlowClients(logging.Handler):
    """Detects slow clients in the library's log, because the library offers no other notification.

    Args:
        slow: Called with the address of a slow client, on any thread.
    """

    def __init__(self, slow: Callable[[str], None]) -> None:
        super().__init__(logging.INFO)
        self._slow = slow

    def start(self) -> None:
        """Starts to read the library's log."""
        _LOG.setLevel(logging.INFO)
        _LOG.addHandler(self)

    def stop(self) -> None:
        """Stops to read the library's log."""
        _LOG.removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Reads one entry of the log."""
        found = _FULL.search(record.getMessage())
        if found:
            self._slow(found[1])
