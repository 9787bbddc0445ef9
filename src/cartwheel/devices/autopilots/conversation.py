"""The exchange of packets with ArduPilot: which packets count, and how long a step waits."""

from __future__ import annotations

import time

from cartwheel.codes import wires
from cartwheel.devices.autopilots.ardupilot_packets import ServoPacket, decode
from cartwheel.devices.autopilots.datagrams import DatagramPort
from cartwheel.devices.autopilots.reports import Address, Reports

WAIT = 0.01
"""Wall time to wait for the next packet, s, as in Gazebo's plugins."""
MOST_WAITS = 100
"""Number of waits after which the connection is lost with lock step."""
_MOST_DATAGRAMS = 64
"""Datagrams that are read during one wait."""
_FAULTS = {
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
        reports: Receives what happens on the port.
    """

    is_connection = True
    """The state of a world does not contain connections to other programs."""

    def __init__(
        self, port: DatagramPort, *, lock_step: bool, most_missed: int, reports: Reports
    ) -> None:
        self._port = port
        self._lock_step = lock_step
        self._most_missed = most_missed
        self._reports = reports
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
            if self._lock_step and waits < MOST_WAITS:
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
        self._reports.lost(peer)

    def _read(self) -> ServoPacket | None:
        """Returns the next valid packet, or None after a short wait."""
        end = time.monotonic() + (WAIT if self._peer is not None else 0.0)
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
            self._reports.ignored(packet, _FAULTS[packet], len(data), sender)
            return None
        if self._peer is None:
            self._peer = sender
            self._reports.connected(sender)
        elif sender != self._peer:
            self._reports.ignored("sender", _FAULTS["sender"], len(data), sender)
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
                self._reports.tell(
                    wires.AUTOPILOT_FRAMES_MISSED,
                    "",
                    f"{self._reports.title} has not received {missed} packets of the autopilot",
                    {"missed": missed},
                )
        self._frame = frame
        return packet
