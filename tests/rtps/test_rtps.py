"""RTPS's bytes against the standard's layouts, and delivery over a network that loses."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence

import pytest

from rtps_lite import discovery, wire
from rtps_lite.discovery import Endpoint, EndpointQos
from rtps_lite.outbox import Outbox
from rtps_lite.reader import Reader, Taken
from rtps_lite.writer import Writer

OURS, THEIRS = b"w" * 12, b"r" * 12
WRITER, READER = b"\0\0\1\3", b"\0\0\1\4"
HERE = ("127.0.0.1", 1)


def endpoint(guid: bytes, **qos: object) -> Endpoint:
    return Endpoint(guid=guid, topic="rt/x", type="X", qos=EndpointQos(**qos))  # type: ignore[arg-type]


def test_a_heartbeat_has_the_standards_layout() -> None:
    made = wire.heartbeat(
        reader=READER, writer=WRITER, first=1, last=(1 << 32) + 5, count=7, final=True
    )
    # Kind, flags (final, little-endian), length; entities; 64-bit numbers high word first; count.
    assert made.hex() == ("07031c0000000104000001030000000001000000010000000500000007000000")


def test_a_set_of_numbers_has_the_standards_layout() -> None:
    made = wire.acknack(
        reader=READER, writer=WRITER, base=10, missing=[10, 12, 42], count=1, final=True
    )
    # 33 bits, the first of them the highest of its word: 10 and 12 are 0xa…, 42 the next word's.
    assert made[12:].hex() == "000000000a00000021000000000000a00000008001000000"
    (read,) = wire.read(memoryview(wire.message(THEIRS, made)))
    assert isinstance(read.content, wire.Acknack)
    assert (read.content.base, read.content.missing) == (10, (10, 12, 42))


def test_endpoints_are_read_as_they_were_written() -> None:
    for reliable in (True, False):
        for stays in (True, False):
            made = Endpoint(
                guid=OURS + WRITER,
                topic="rt/odom",
                type="nav_msgs::msg::dds_::Odometry_",
                qos=EndpointQos(reliable=reliable, transient_local=stays, lifespan=10.25),
                user_data=b"typehash=RIHS01_0;",
            )
            assert discovery.decode_endpoint(discovery.encode_endpoint(made), writer=True) == made


def test_what_is_not_said_of_reliability_depends_on_the_side() -> None:
    # Cyclone DDS leaves out what is the default.
    whole = discovery.encode_endpoint(endpoint(OURS + WRITER))
    at = whole.index(b"\x1a\x00\x0c\x00")
    bare = whole[:at] + whole[at + 16 :]
    assert discovery.decode_endpoint(bare, writer=True).qos.reliable
    assert not discovery.decode_endpoint(bare, writer=False).qos.reliable


def test_what_a_reader_asks_for_beyond_what_is_offered_has_ros_name() -> None:
    offered = EndpointQos(reliable=False)
    assert offered.misfit(EndpointQos(reliable=False)) == ""
    assert offered.misfit(EndpointQos()) == "RELIABILITY"
    assert EndpointQos().misfit(EndpointQos(transient_local=True)) == "DURABILITY"
    whole = discovery.encode_endpoint(endpoint(OURS + READER))
    # A deadline of half a second, before all others; then by-topic liveliness of one second.
    strict = whole[:4] + b"\x23\x00\x08\x00\0\0\0\0\0\0\0\x80" + whole[4:]
    asked = discovery.decode_endpoint(strict, writer=False).qos
    assert (asked.deadline, EndpointQos().misfit(asked)) == (0.5, "DEADLINE")
    at = whole.index(b"\x1b\x00\x0c\x00")
    shown = whole[:at] + b"\x1b\x00\x0c\x00\2\0\0\0\1\0\0\0\0\0\0\0" + whole[at + 16 :]
    asked = discovery.decode_endpoint(shown, writer=False).qos
    assert (asked.liveliness, asked.lease) == (2, 1.0)
    assert EndpointQos().misfit(asked) == "LIVELINESS"


@pytest.mark.parametrize("loss", [0.0, 0.3])
@pytest.mark.parametrize("size", [10, 150_000])
def test_reliable_samples_arrive_in_order_over_a_network_that_loses(loss: float, size: int) -> None:
    dice = random.Random(1)
    under_way: list[bytes] = []
    taken: list[Taken] = []

    def send(parts: Sequence[bytes | memoryview], _: object) -> None:
        if dice.random() >= loss:
            under_way.append(b"".join(parts))

    writer = Writer(endpoint(OURS + WRITER, depth=50), send)
    reader = Reader(endpoint(THEIRS + READER), send, taken.append)
    reader.match(writer.endpoint, HERE)
    writer.match(reader.endpoint, HERE)
    sent = [bytes([0, 1, 0, 0]) + dice.randbytes(size - 4) for _ in range(30)]

    def carry() -> None:
        while under_way:
            data = under_way.pop(dice.randrange(len(under_way)) if loss else 0)
            for each in wire.read(memoryview(data)):
                content = each.content
                if isinstance(content, wire.Data):
                    reader.take_data(OURS + WRITER, b"\1\2", content)
                elif isinstance(content, wire.Heartbeat):
                    reader.take_heartbeat(OURS + WRITER, content)
                elif isinstance(content, wire.Gap):
                    reader.take_gap(OURS + WRITER, content)
                elif isinstance(content, wire.Acknack):
                    writer.take_acknack(THEIRS + READER, content)

    for payload in sent:
        writer.write(payload)
        carry()
    now = 1e12
    for _ in range(200):
        # Reminders, as time goes by.
        now += 1e6
        writer.remind(now)
        carry()
        reader.remind()
        carry()
        if len(taken) == len(sent):
            break
    padding = b"\0" * (-size % 4)
    assert [each.payload for each in taken] == [payload + padding for payload in sent]


@pytest.mark.parametrize("reliable", [True, False])
@pytest.mark.parametrize("again", [True, False])
def test_samples_of_a_writer_that_was_lost_are_not_delivered_again(
    reliable: bool, again: bool
) -> None:
    """One that has not received the acknowledgement sends them again when it is back."""
    sent: list[bytes] = []
    taken: list[Taken] = []
    writer = Writer(
        endpoint(OURS + WRITER, reliable=reliable), lambda parts, _: sent.append(b"".join(parts))
    )
    writer.match(endpoint(THEIRS + READER, reliable=reliable), HERE)
    for number in range(3):
        writer.write(bytes([0, 1, 0, 0, number, 0, 0, 0]))
    contents = [each.content for data in sent for each in wire.read(memoryview(data))]
    samples = [each for each in contents if isinstance(each, wire.Data)]
    reader = Reader(
        endpoint(THEIRS + READER, reliable=reliable), lambda *_: None, taken.append, again=again
    )
    for wave in (samples[:2], samples):
        reader.match(writer.endpoint, HERE)
        for sample in wave:
            reader.take_data(OURS + WRITER, b"\1\2", sample)
        reader.unmatch(OURS + WRITER)
    assert [each.number for each in taken] == ([1, 2, 1, 2, 3] if again else [1, 2, 3])


def test_requests_for_samples_that_are_gone_are_answered_and_counted() -> None:
    sent: list[bytes] = []
    reported: list[int] = []
    writer = Writer(endpoint(OURS + WRITER, depth=2), lambda parts, _: sent.append(b"".join(parts)))
    writer.on_drop = lambda: reported.append(writer.dropped)
    writer.match(endpoint(THEIRS + READER), HERE)
    for number in range(5):
        writer.write(bytes([0, 1, 0, 0, number, 0, 0, 0]))
    sent.clear()
    asked = wire.Acknack(READER, WRITER, 1, (1, 2, 3, 4, 5), 1, True)
    writer.take_acknack(THEIRS + READER, asked)
    contents = [each.content for data in sent for each in wire.read(memoryview(data))]
    assert [each.number for each in contents if isinstance(each, wire.Data)] == [4, 5]
    (gap,) = [each for each in contents if isinstance(each, wire.Gap)]
    assert (gap.start, gap.base) == (1, 4)
    # Once for all, and not again if it asks again.
    assert reported == [3]
    for count in range(2, 5):
        writer.take_acknack(
            THEIRS + READER, wire.Acknack(READER, WRITER, 1, (1, 2, 3, 4, 5), count, True)
        )
    assert reported == [3]


def test_a_receiver_that_falls_behind_gets_the_latest_samples() -> None:
    sent: list[bytes] = []
    outbox = Outbox(lambda parts, _: not sent.append(b"".join(parts)), lambda _: None)  # type: ignore[func-returns-value]
    writer = Writer(
        endpoint(OURS + WRITER, reliable=False, depth=5), lambda *_: True, outbox=outbox
    )
    reported: list[int] = []
    writer.on_refusal = lambda: reported.append(writer.dropped)
    writer.match(endpoint(THEIRS + READER, reliable=False), HERE)
    for number in range(50):
        writer.write(bytes([number]) * 150_000)
    while outbox._jobs:
        outbox.tick()
    contents = [each.content for data in sent for each in wire.read(memoryview(data))]
    fragments = [each for each in contents if isinstance(each, wire.Data)]
    assert list(dict.fromkeys(each.number for each in fragments)) == [1, 46, 47, 48, 49, 50]
    # The one that was on its way is complete.
    assert len(fragments) == 6 * 3
    assert reported == list(range(1, 45))


def test_what_a_frozen_reader_misses_is_counted_once() -> None:
    reported: list[int] = []
    writer = Writer(endpoint(OURS + WRITER, depth=2), lambda *_: None)
    writer.on_silence = lambda: reported.append(writer.dropped)
    writer.match(endpoint(THEIRS + READER), HERE)
    payload = bytes([0, 1, 0, 0, 0, 0, 0, 0])
    for _ in range(3):
        writer.write(payload)
    writer.take_acknack(THEIRS + READER, wire.Acknack(READER, WRITER, 4, (), 1, True))
    for _ in range(7):
        writer.write(payload)
    now = time.monotonic() + 1.0
    writer.remind(now)
    assert writer.dropped == 0
    # It has 3 of 10, and 2 are kept for it.
    writer.remind(now + 4.0)
    assert reported == [5]
    writer.write(payload)
    writer.remind(now + 20.0)
    writer.remind(now + 30.0)
    assert reported == [5, 6]
    # It wakes, and asks for what is gone.
    asked = wire.Acknack(READER, WRITER, 4, tuple(range(4, 12)), 2, True)
    writer.take_acknack(THEIRS + READER, asked)
    assert writer.dropped == 6
    writer.remind(now + 31.0)
    assert writer.dropped == 6


@pytest.mark.parametrize("size", [8, 150_000])
def test_what_the_system_does_not_take_is_counted_where_nobody_asks_again(size: int) -> None:
    reported: list[int] = []
    takes = [True]
    writer = Writer(endpoint(OURS + WRITER), lambda *_: takes[0])
    writer.on_refusal = lambda: reported.append(writer.dropped)
    other = b"o" * 12
    for guid in (THEIRS + READER, THEIRS + b"\0\0\2\4", other + READER):
        writer.match(endpoint(guid, reliable=guid.startswith(other)), HERE)
    payload = bytes(size)
    writer.write(payload)
    assert writer.dropped == 0
    takes[0] = False
    writer.write(payload)
    # Two readers of one participant get none of it; the reliable one will ask.
    assert reported == [2]
    writer.unmatch(THEIRS + READER)
    writer.unmatch(THEIRS + b"\0\0\2\4")
    writer.write(payload)
    assert reported == [2]


def test_who_comes_late_gets_what_is_not_too_old() -> None:
    sent: list[bytes] = []
    now = [0]
    writer = Writer(
        endpoint(OURS + WRITER, transient_local=True, lifespan=10.0),
        lambda parts, _: not sent.append(b"".join(parts)),  # type: ignore[func-returns-value]
        clock=lambda: now[0],
    )
    for second in (0, 5, 12):
        now[0] = second * 1_000_000_000
        writer.write(bytes([0, 1, 0, 0, second, 0, 0, 0]))
    writer.match(endpoint(THEIRS + READER, transient_local=True), HERE)
    contents = [each.content for data in sent for each in wire.read(memoryview(data))]
    got = [each.payload[4] for each in contents if isinstance(each, wire.Data)]
    assert got == [5, 12]
    (reported,) = (each for each in contents if isinstance(each, wire.Heartbeat))
    assert (reported.first, reported.last) == (2, 3)


def test_who_comes_late_is_reminded_until_it_answers() -> None:
    """It may hear of the writer only after what was sent at once."""
    sent: list[bytes] = []
    writer = Writer(
        endpoint(OURS + WRITER, transient_local=True),
        lambda parts, _: not sent.append(b"".join(parts)),  # type: ignore[func-returns-value]
    )
    writer.write(bytes([0, 1, 0, 0, 1, 0, 0, 0]))
    writer.match(endpoint(THEIRS + READER, transient_local=True), HERE)
    sent.clear()
    now = time.monotonic()
    for passed in (0.5, 1.0, 5.0):
        writer.remind(now + passed)
    assert len(sent) == 3
    writer.take_acknack(THEIRS + READER, wire.Acknack(READER, WRITER, 2, (), 1, final=True))
    sent.clear()
    writer.remind(now + 100.0)
    assert not sent


def test_a_response_goes_to_whom_it_is_for_and_others_do_not_wait_for_it() -> None:
    sent: list[bytes] = []
    writer = Writer(endpoint(OURS + WRITER), lambda parts, _: sent.append(b"".join(parts)))
    other = b"o" * 12
    writer.match(endpoint(THEIRS + READER), HERE)
    writer.match(endpoint(other + READER), HERE)
    sent.clear()
    writer.write(b"\0\1\0\0", to=THEIRS)
    by_receiver = {
        each.to: type(each.content) for data in sent for each in wire.read(memoryview(data))
    }
    assert by_receiver == {THEIRS: wire.Data, other: wire.Gap}
