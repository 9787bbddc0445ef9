"""Bytes on the ports of flight controllers: datagrams of several programs, and a stream."""

from __future__ import annotations

import math
import struct

from tests.campaign.target import FaultError, Target
from tests.devices.autopilots.ardupilot_client import servo_packet
from tests.devices.autopilots.px4_client import controls, heartbeat

from cartwheel.devices.autopilots.ardupilot_packets import VehicleState, encode_binary, encode_json
from cartwheel.devices.autopilots.conversation import Conversation
from cartwheel.devices.autopilots.px4_link import Px4Link
from cartwheel.devices.autopilots.reports import Reports
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Pose

_STATE = VehicleState(
    seconds=1.0, rates=[0.0] * 3, acceleration=[0.0] * 3, pose=Pose(), velocity=(0.0,) * 3
)
_MOST_REPORTS = 100


def joined(*datagrams: tuple[int, bytes]) -> bytes:
    """Datagrams with their senders as one input: sender, length, bytes."""
    return b"".join(bytes((sender, len(data))) + data for sender, data in datagrams)


class _Port:
    """Returns the datagrams of an input."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    @property
    def empty(self) -> bool:
        return not self._data

    def receive(self, seconds: float) -> tuple[bytes, tuple[str, int]] | None:
        if len(self._data) < 2:
            self._data = b""
            return None
        sender, length = self._data[:2]
        datagram, self._data = self._data[2 : 2 + length], self._data[2 + length :]
        return datagram, ("127.0.0.1", sender)

    def send(self, data: bytes, address: tuple[str, int]) -> None:
        pass

    def close(self) -> None:
        pass


def seeds() -> list[bytes]:
    """Both interfaces, a second program, lost and repeated packets."""
    servo = [servo_packet(frame, [1500] * 16) for frame in range(5)]
    binary = struct.pack("<16f", *[0.5] * 16)
    return [
        joined(*((1, each) for each in servo)),
        joined((1, servo_packet(0, [1100] * 32, count=32)), (2, servo[0]), (1, servo[4])),
        joined((1, servo[1]), (1, servo[1]), (1, b""), (1, servo[0])),
        joined((3, binary), (3, binary), (1, servo[0])),
    ]


def run_one(data: bytes) -> None:
    """Reads the datagrams, with and without lock step."""
    for lock_step in (True, False):
        port = _Port(data)
        reports: list[Diagnostic] = []
        conversation = Conversation(
            port,  # type: ignore[arg-type]
            lock_step=lock_step,
            most_missed=3,
            reports=Reports(reports.append, title="the plugin", origin=None),
        )
        while not port.empty:
            packet = conversation.next()
            if packet is not None and not all(map(math.isfinite, packet.outputs)):
                raise FaultError("an output is not finite")
            conversation.send(
                encode_binary(_STATE)
                if packet is not None and packet.protocol == "binary"
                else encode_json(_STATE, time_sync=False, lock_step=lock_step)
            )
        if len(reports) > _MOST_REPORTS:
            raise FaultError(f"{len(reports)} reports")


class _Stream:
    """Returns the bytes of an input, 100 at a time, from one program."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.peer: tuple[str, int] | None = ("127.0.0.1", 1)

    def accept(self) -> None:
        pass

    def receive(self, seconds: float) -> bytes | None:
        piece, self.data = self.data[:100], self.data[100:]
        return piece or None

    def send(self, data: bytes) -> None:
        pass

    def drop(self) -> None:
        self.peer = None

    def close(self) -> None:
        pass


def px4_seeds() -> list[bytes]:
    """Frames of PX4, broken frames, and other bytes."""
    frames = [heartbeat(), *(controls(number, [0.5] * 16) for number in range(4))]
    stream = b"".join(frames)
    return [stream, stream[:-1], b"GET / HTTP/1.1" + stream, frames[1][:40] + stream, b"\xfd" * 50]


def run_px4(data: bytes) -> None:
    """Reads the stream, with and without lock step."""
    for lock_step in (True, False):
        port = _Stream(data)
        reports: list[Diagnostic] = []
        link = Px4Link(
            port,  # type: ignore[arg-type]
            lock_step=lock_step,
            reports=Reports(reports.append, title="the plugin", origin=None),
        )
        while port.data:
            received = link.next()
            outputs = () if received is None else received.outputs
            if any(each is not None and not -1 <= each <= 1 for each in outputs):
                raise FaultError("an output is not between -1 and 1")
            link.send(b"state")
        if len(reports) > _MOST_REPORTS:
            raise FaultError(f"{len(reports)} reports")


TARGETS = (
    Target(name="ardupilot", seeds=seeds, run_one=run_one),
    Target(name="px4", seeds=px4_seeds, run_one=run_px4),
)
