"""Reports about the program that is connected to a port."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from cartwheel.codes import wires
from cartwheel.errors import Code, Diagnostic, Origin, Severity, Value

Address = tuple[str, int]
_MOST = 10
"""Reports of one kind, so that a program that repeats its mistakes cannot flood the terminal."""


class Reports:
    """Reports the connections of an autopilot and the packets that are ignored.

    Args:
        report: Receives diagnostics.
        title: Name of the plugin in messages.
        origin: File and line of the plugin.
    """

    def __init__(
        self, report: Callable[[Diagnostic], None], *, title: str, origin: Origin | None
    ) -> None:
        self._report, self.title, self._origin = report, title, origin
        self._counts: Counter[tuple[Code, str]] = Counter()

    def connected(self, address: Address) -> None:
        """Reports that an autopilot has connected."""
        name = text(address)
        self.tell(
            wires.AUTOPILOT_CONNECTED,
            "",
            f"{self.title} is connected to the autopilot at {name}",
            {"address": name},
            severity="info",
        )

    def lost(self, address: Address) -> None:
        """Reports that the autopilot is no longer connected."""
        name = text(address)
        self.tell(
            wires.AUTOPILOT_LOST,
            "",
            f"{self.title} has lost the connection to the autopilot at {name}, so its joints are "
            "no longer driven",
            {"address": name},
        )

    def ignored(self, reason: str, fault: str, size: int, address: Address) -> None:
        """Reports a packet that has no effect.

        Args:
            reason: Kind of the fault, for programs.
            fault: The fault, as a clause such as "has an invalid length".
            size: Length of the packet, bytes.
            address: Sender of the packet.
        """
        name = text(address)
        self.tell(
            wires.AUTOPILOT_PACKET_IGNORED,
            reason,
            f"{self.title} ignores a packet of {size} bytes from {name}, which {fault}",
            {"reason": reason, "address": name, "bytes": size},
        )

    def tell(
        self,
        code: Code,
        kind: str,
        message: str,
        values: dict[str, Value],
        *,
        severity: Severity = "warning",
    ) -> None:
        """Reports a diagnostic, unless ten of its kind were reported."""
        self._counts[code, kind] += 1
        if self._counts[code, kind] <= _MOST:
            self._report(
                code.diagnostic(message, origin=self._origin, values=values, severity=severity)
            )


def text(address: Address) -> str:
    """Returns an address as ``host:port``."""
    return f"{address[0]}:{address[1]}"
