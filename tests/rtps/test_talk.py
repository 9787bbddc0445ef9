"""Two participants in one process discover each other and exchange samples."""

from __future__ import annotations

import threading

from tests.bridges.ros2_peers import DOMAIN

from cartwheel.bridges.loop import Loop
from rtps_lite.discovery import EndpointQos
from rtps_lite.network import Reach
from rtps_lite.participant import Participant

PATIENCE = 60.0
STRING = "std_msgs::msg::dds_::String_"


def test_a_late_reader_gets_the_kept_sample_and_the_next_ones() -> None:
    faults: list[Exception] = []
    loop = Loop(faults.append, name="test")
    received: list[bytes] = []
    both = threading.Event()

    def take(sample: object) -> None:
        received.append(bytes(sample.payload))  # type: ignore[attr-defined]
        if len(received) == 2:
            both.set()

    def participant(name: str) -> Participant:
        made = Participant(
            loop,
            domain=DOMAIN + 9,
            reach=Reach(),
            name=name,
            user_data=b"",
            warn=lambda warning: faults.append(RuntimeError(warning.message)),
        )
        made.start()
        return made

    loop.start()
    qos = EndpointQos(reliable=True, transient_local=True)
    talker = loop.call(lambda: participant("talker")).result(PATIENCE)
    writer = loop.call(lambda: talker.writer("rt/chatter", STRING, qos)).result(PATIENCE)
    loop.call(lambda: writer.write(b"\0\1\0\0abcd")).result(PATIENCE)
    listener = loop.call(lambda: participant("listener")).result(PATIENCE)
    loop.call(lambda: listener.reader("rt/chatter", STRING, qos, take)).result(PATIENCE)
    loop.call(lambda: writer.write(b"\0\1\0\0efgh")).result(PATIENCE)
    try:
        assert both.wait(PATIENCE)
        assert received == [b"\0\1\0\0abcd", b"\0\1\0\0efgh"]
        assert not faults
    finally:
        loop.call(listener.close).result(PATIENCE)
        loop.call(talker.close).result(PATIENCE)
        loop.stop()
