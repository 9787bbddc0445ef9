"""Datagrams on the port of a flight controller, from one program or several."""

from __future__ import annotations

import math
import struct

from tests.campaign.target import FaultError, Target
from tests.devices.autopilots.ardupilot_client import servo_packet

from cartwheel.devices.autopilots.ardupilot_packets import VehicleState, encode_binary, encode_json
from cartwheel.devices.autopilots.conversation import Conversation
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


TARGETS = (Target(name="ardupilot", seeds=seeds, run_one=run_one),)
