"""The exchange of packets with ArduPilot: which packets count, and how long a step waits."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable

from cartwheel.codes import wires
from cartwheel.devices.autopilots.ardupilot_packets import ServoPacket, decode
from cartwheel.devices.autopilots.datagrams import Address, DatagramPort
from cartwheel.errors import Code, Diagnostic, Origin, Severity, Value

_WAIT = 0.01
"""Wall time to wait for the next packet, s, as in Gazebo's plugin."""
_MOST_WAITS = 100
"""Number of waits after which the connection is lost with lock step."""
_MOST_DATAGRAMS = 64
"""Datagrams that are read during one wait."""
_MOST_REPORTS = 10
"""Reports of one kind, so that a program that repeats its mistakes cannot flood the terminal."""
_WANTED = {
    "length": "has an invalid length",
    "magic": "begins with the wrong number",
    "number": "contains a number that is not finite",
    "sender": "comes from a different program than the connected autopilot",
}


class Conversation:
    """Receives an autopilot's packets and sends the vehicle's states.

    The first program that sends a valid packet is connected. Packets from other programs are
    ignored until the connection is lost.

    Args:
        port: UDP port, which this object closes.
        lock_step: Whether each step waits for a packet.
        most_missed: With lock step, number of waits after which the last state is sent again.
            Otherwise, number of consecutive steps without a packet after which the connection is
            lost.
        report: Receives diagnostics.
        title: Name of the plugin in messages.
        origin: File and line of the plugin.
    """

    def __init__(
        self,
        port: DatagramPort,
        *,
        lock_step: bool,
        most_missed: int,
        report: Callable[[Diagnostic], None],
        title: str,
        origin: Origin | None,
    ) -> None:
        self._port = port
        self._lock_step = lock_step
        self._most_missed = most_missed
        self._report = report
        self._title = title
        self._origin = origin
        self._reports: Counter[tuple[Code, str]] = Counter()
        self._peer: Address | None = None
        self._forget()

    @property
    def connected(self) -> bool:
        """Whether an autopilot is connected."""
        return self._peer is not None

    def next(self) -> ServoPacket | None:
        """Returns the packet for the next step; None: there is none.

        Without a connection, it does not wait. With lock step, it waits up to 1 s for the packet.
        Otherwise it waits up to 10 ms, and returns the newest packet.
        """
        waits = 0
        while True:
            packet = self._read()
            if packet is not None:
                self._missed = 0
                return packet
            if self._peer is None:
                return None
            waits += 1
            self._missed += 1
            if self._lock_step and waits < _MOST_WAITS:
                if waits % (self._most_missed + 1) == 0:
                    # The state, or the packet that answered it, may be lost.
                    self._port.send(self._sent, self._peer)
            elif self._lock_step or self._missed > self._most_missed:
                self._lose()
                return None
            else:
                return None

    def send(self, state: bytes) -> None:
        """Sends a state to the connected autopilot."""
        self._sent = state
        if self._peer is not None:
            self._port.send(state, self._peer)

    def close(self) -> None:
        """Closes the port."""
        self._port.close()

    def _forget(self) -> None:
        self._frame: int | None = None
        self._missed = 0
        self._sent = b""

    def _lose(self) -> None:
        assert self._peer is not None
        peer, self._peer = self._peer, None
        self._forget()
        self._tell(
            wires.AUTOPILOT_LOST,
            "",
            f"{self._title} has lost the connection to the autopilot at {_text(peer)}, so its "
            "joints are no longer driven",
            {"address": _text(peer)},
        )

    def _read(self) -> ServoPacket | None:
        """Returns the next valid packet, or None after a short wait."""
        end = time.monotonic() + (_WAIT if self._peer is not None else 0.0)
        newest: ServoPacket | None = None
        for _ in range(_MOST_DATAGRAMS):
            left = 0.0 if newest is not None else max(0.0, end - time.monotonic())
            received = self._port.receive(left)
            if received is None:
                break
            packet = self._accept(*received)
            newest = packet or newest
            if newest is not None and self._lock_step:
                # Each packet controls one step, so that the results do not depend on the speed.
                break
        return newest

    def _accept(self, data: bytes, sender: Address) -> ServoPacket | None:
        """Checks a packet, and connects its sender if no autopilot is connected."""
        packet = decode(data)
        if isinstance(packet, str):
            self._ignore(packet, data, sender)
            return None
        if self._peer is None:
            self._peer = sender
            self._tell(
                wires.AUTOPILOT_CONNECTED,
                "",
                f"{self._title} is connected to the autopilot at {_text(sender)}",
                {"address": _text(sender)},
                severity="info",
            )
        elif sender != self._peer:
            self._ignore("sender", data, sender)
            return None
        frame, before = packet.frame, self._frame
        if frame is not None and before is not None:
            if frame == before:
                if self._lock_step and self._sent:
                    # The autopilot repeats its packet because it has not received the state.
                    self._port.send(self._sent, sender)
                return None
            missed = frame - before - 1
            if missed > 0:
                self._tell(
                    wires.AUTOPILOT_FRAMES_MISSED,
                    "",
                    f"{self._title} has not received {missed} packets of the autopilot",
                    {"missed": missed},
                )
        self._frame = frame
        return packet

    def _ignore(self, reason: str, data: bytes, sender: Address) -> None:
        self._tell(
            wires.AUTOPILOT_PACKET_IGNORED,
            reason,
            f"{self._title} ignores a packet of {len(data)} bytes from {_text(sender)}, which "
            f"{_WANTED[reason]}",
            {"reason": reason, "address": _text(sender), "bytes": len(data)},
        )

    def _tell(
        self,
        code: Code,
        kind: str,
        message: str,
        values: dict[str, Value],
        *,
        severity: Severity = "warning",
    ) -> None:
        self._reports[code, kind] += 1
        if self._reports[code, kind] <= _MOST_REPORTS:
            self._report(
                code.diagnostic(message, origin=self._origin, values=values, severity=severity)
            )


def _text(address: Address) -> str:
    return f"{address[0]}:{address[1]}"
