"""Texts of a websocket's client are judged, whatever pieces they come in."""

from __future__ import annotations

import random

import pytest
from websockets.frames import Frame, Opcode

from cartwheel.gate.frames import FrameError, Frames, Room


def framed(opcode: Opcode, data: bytes, *, fin: bool = True) -> bytes:
    return Frame(opcode, data, fin).serialize(mask=True)


def unexpected() -> None:
    raise AssertionError("disconnected")


def held_by_all(room: Room) -> Frames:
    """A client that no other disconnects."""
    return Frames(lambda _: True, room, unexpected)


KEPT = [
    framed(Opcode.BINARY, bytes(range(256)) * 300),
    framed(Opcode.TEXT, b"good " * 100),
    framed(Opcode.PING, b"now"),
    framed(Opcode.TEXT, b""),
    framed(Opcode.BINARY, b"a", fin=False) + framed(Opcode.CONT, b"b"),
]
REFUSED = [
    framed(Opcode.TEXT, b"bad " * 70_000),
    framed(Opcode.TEXT, b"b", fin=False) + framed(Opcode.CONT, b"", fin=False)
    + framed(Opcode.CONT, b"ad"),
]  # fmt: skip


@pytest.mark.parametrize("seed", range(5))
def test_a_refused_text_is_left_out_whole_and_all_else_passes(seed: int) -> None:
    pick = random.Random(seed)
    stream = pick.sample([*KEPT, *REFUSED], 7)
    seen: list[bytes] = []
    room = Room(1 << 20)
    frames = Frames(
        lambda text: seen.append(text) or not text.startswith(b"bad"),  # type: ignore[func-returns-value]
        room,
        unexpected,
    )
    data, out = memoryview(b"".join(stream)), b""
    while data:
        size = pick.choice([1, 2, 7, 1000, 100_000])
        out, data = out + frames.feed(data[:size]), data[size:]
    assert out == b"".join(each for each in stream if each in KEPT)
    assert sorted(seen) == sorted([b"good " * 100, b"", b"bad " * 70_000, b"bad"])
    room.take(held_by_all(room), 1 << 20)  # all is given back


def test_a_control_frame_within_a_text_passes() -> None:
    frames = Frames(lambda text: text == b"a text", Room(), unexpected)
    ping = framed(Opcode.PING, b"")
    begin, end = framed(Opcode.TEXT, b"a ", fin=False), framed(Opcode.CONT, b"text")
    assert frames.feed(memoryview(begin + ping)) == ping
    assert frames.feed(memoryview(end)) == begin + end


@pytest.mark.parametrize(
    "data",
    [
        Frame(Opcode.TEXT, b"no mask").serialize(mask=False),
        b"\x81\xff" + (1 << 20).to_bytes(8) + bytes(4),
        b"\x82\xff" + (1 << 63).to_bytes(8) + bytes(4),
        framed(Opcode.TEXT, b"", fin=False) + framed(Opcode.CONT, b"", fin=False) * 200_000,
    ],
)
def test_what_is_no_frame_or_too_large_is_an_error(data: bytes) -> None:
    with pytest.raises(FrameError):
        held_by_all(Room()).feed(memoryview(data))


def test_incomplete_messages_of_all_clients_are_bounded() -> None:
    room = Room(2000)
    ended: list[int] = []
    one, two, three, four = (
        Frames(lambda _: True, room, lambda number=number: ended.append(number))  # type: ignore[misc]
        for number in range(4)
    )
    head = b"\x82\xfe" + (800).to_bytes(2) + bytes(4)
    for each in (one, two):
        each.feed(memoryview(head + bytes(700)))
    # A message that is complete makes its client the last to go.
    one.feed(memoryview(bytes(100) + head + bytes(700)))
    assert ended == []
    for each in (three, four):
        each.feed(memoryview(head + bytes(700)))
    assert ended == [1, 0]
    assert two.fault and one.fault and not three.fault
    # The oldest does not disconnect younger ones to go on.
    with pytest.raises(FrameError):
        three.feed(memoryview(bytes(99) + head * 200))
    three.close()
    four.feed(memoryview(bytes(100)))
    assert ended == [1, 0] and not four.fault


@pytest.mark.parametrize(
    "data",
    [
        framed(Opcode.TEXT, b"a", fin=False) + framed(Opcode.TEXT, b"b", fin=False),
        framed(Opcode.BINARY, b"a", fin=False) + framed(Opcode.TEXT, b"b"),
        framed(Opcode.CONT, b"a"),
        framed(Opcode.TEXT, b"a") + framed(Opcode.CONT, b"b"),
        b"\x89\xfe" + (126).to_bytes(2) + bytes(4),
    ],
    ids=["text in text", "text in binary", "no begin", "no begin after an end", "control"],
)
def test_a_message_within_a_message_takes_no_room(data: bytes) -> None:
    room = Room(1 << 20)
    frames = held_by_all(room)
    with pytest.raises(FrameError):
        frames.feed(memoryview(data))
    frames.close()
    room.take(held_by_all(room), 1 << 20)
