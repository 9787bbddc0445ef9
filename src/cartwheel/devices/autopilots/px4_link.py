"""The connection to PX4: which program is connected, and how long a step waits for it."""

from __future__ import annotations

import time

from cartwheel.devices.autopilots.conversation import MOST_WAITS, WAIT
from cartwheel.devices.autopilots.mavlink import (
    ACTUATORS,
    Controls,
    FrameReader,
    controls_of,
)
from cartwheel.devices.autopilots.reports import Address, Reports
from cartwheel.devices.autopilots.streams import StreamPort

_FIRST_WAIT = 10 * WAIT
"""Wall time to wait for controls if those for the previous state have arrived, s."""
_MOST_SILENCE = MOST_WAITS * WAIT
"""Wall time without controls after which the connection is lost, s."""
_MOST_READS = 64
"""Reads from the connection during one step."""


class Px4Link:
    """Receives PX4's controls, and sends it the states.

    The first program that sends a valid MAVLink frame is connected. Other programs are rejected
    until it has closed its connection. A program that has not sent a valid frame yet makes way for
    the next one.

    Args:
        port: TCP port, which this object closes.
        lock_step: Whether each step waits for controls while PX4 is armed.
        reports: Receives what happens on the port.
    """

    is_connection = True
    """The state of a world does not contain connections to other programs."""

    def __init__(self, port: StreamPort, *, lock_step: bool, reports: Reports) -> None:
        self._port = port
        self._lock_step = lock_step
        self._reports = reports
        self._known: Address | None = None
        self._reader = FrameReader()
        self._silence, self._armed, self._sequence = 0.0, False, -1

    @property
    def connected(self) -> bool:
        """Whether PX4 is connected."""
        return self._known is not None

    def next(self) -> Controls | None:
        """Returns the controls that have arrived since the last call; None: there are none.

        With lock step, it waits for controls while PX4 is armed: up to 0.1 s if controls arrived
        in the previous step, and otherwise up to 10 ms, because PX4 does not answer each state
        while its mode changes. After 1 s of such waits, the connection is lost.
        """
        self._accept()
        armed = self._lock_step and self._armed
        wait = (_FIRST_WAIT if self._silence == 0.0 else WAIT) if armed else 0.0
        newest = self._read(wait)
        if newest is not None:
            self._silence, self._armed = 0.0, newest.armed
        elif armed:
            self._silence += wait
            if self._silence >= _MOST_SILENCE:
                self._port.drop()
        if self._known is not None and self._port.peer != self._known:
            self._lose()
        return newest

    def send(self, *messages: bytes) -> None:
        """Sends messages to PX4."""
        if self._known is not None:
            self._port.send(b"".join(messages))

    def number(self) -> int:
        """Returns the number of the next message, from 0 to 255."""
        self._sequence = (self._sequence + 1) % 256
        return self._sequence

    def close(self) -> None:
        """Closes the port."""
        self._port.close()

    def _lose(self) -> None:
        assert self._known is not None
        self._reports.lost(self._known)
        self._known, self._reader = None, FrameReader()
        self._silence, self._armed, self._sequence = 0.0, False, -1

    def _accept(self) -> None:
        for _ in range(_MOST_READS):
            accepted = self._port.accept()
            if accepted is None:
                return
            stream, address = accepted
            if self._known is None:
                self._reader = FrameReader()
                self._port.connect(stream, address)
            else:
                stream.close()
                self._reports.ignored(
                    "sender",
                    "comes from a different program than the connected autopilot",
                    0,
                    address,
                )

    def _read(self, seconds: float) -> Controls | None:
        """Returns the newest controls, or None if none arrive within a time in s.

        With lock step, the first controls are returned.
        """
        end = time.monotonic() + seconds
        newest: Controls | None = None
        for _ in range(_MOST_READS):
            left = 0.0 if newest is not None else max(0.0, end - time.monotonic())
            peer = self._port.peer
            data = self._port.receive(left)
            if data is None or peer is None:
                break
            before = self._reader.invalid
            for frame in self._reader.feed(data):
                if self._known is None:
                    self._known = peer
                    self._reports.connected(peer)
                if frame.number == ACTUATORS:
                    newest = controls_of(frame.payload)
            if self._reader.invalid > before:
                self._reports.ignored(
                    "frame",
                    "contains bytes that belong to no valid MAVLink 2 frame",
                    self._reader.invalid - before,
                    peer,
                )
            if newest is not None and self._lock_step:
                break
        return newest
