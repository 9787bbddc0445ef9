"""Messages through memory that two ends share."""

import random
import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from cartwheel.bridges.apart import ring
from cartwheel.bridges.apart.ring import RingReader, RingWriter

Ends = Callable[..., tuple[RingWriter, RingReader, list[tuple[int, int, bytes]]]]


@pytest.fixture
def ends() -> Iterator[Ends]:
    opened: list[RingWriter] = []

    def make(
        size: int, *, patient: bool = False, take: Callable[[int, int, bytes], None] | None = None
    ) -> tuple[RingWriter, RingReader, list[tuple[int, int, bytes]]]:
        file = ring.memory(size)
        bell, other = socket.socketpair()
        taken: list[tuple[int, int, bytes]] = []
        writer = RingWriter(file, bell, patient=patient)
        reader = RingReader(
            file,
            other,
            patient=patient,
            take=take or (lambda *found: taken.append(found)),
            on_fault=lambda error: taken.append((-1, 0, str(error).encode())),
        )
        opened.append(writer)
        return writer, reader, taken

    yield make
    for writer in opened:
        writer.close()


def test_all_sizes_come_in_order_many_times_round(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16, patient=True)
    reader.start()
    numbers = random.Random(1)
    sent = []
    for count in range(3000):
        size = numbers.choice([0, 1, 15, 16, 17, 900, 16_383, 16_384, 16_385, 200_000])
        data = numbers.randbytes(size)
        sent.append((count, count * 10, data))
        writer.put_patiently(count, count * 10, data)
    reader.read_to(writer.written)
    assert taken == sent


def test_a_full_ring_takes_no_more_and_loses_nothing_it_took(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16)
    took = [number for number in range(200) if writer.put(number, 0, bytes(1000))]
    # Most of the ring: some is kept for a message that has to begin at the beginning.
    assert 55 <= len(took) <= 65
    assert took == list(range(len(took)))
    reader.start()
    reader.read_to(writer.written)
    assert [number for number, _, _ in taken] == took
    assert writer.put(7, 0, b"room again")


def test_a_message_of_several_parts_comes_whole_or_not_at_all(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16)
    large = bytes(range(256)) * 160
    assert writer.put(1, 5, large)
    assert not writer.put(2, 5, large)
    assert not writer.put(3, 5, bytes(1 << 16))
    reader.start()
    reader.read_to(writer.written)
    assert taken == [(1, 5, large)]


def test_a_patient_writer_waits_for_a_slow_reader(ends: Ends) -> None:
    held = threading.Event()
    taken = []

    def take(number: int, _: int, data: bytes) -> None:
        held.wait(60)
        taken.append((number, len(data)))

    writer, reader, _ = ends(1 << 16, patient=True, take=take)
    reader.start()
    waited: list[float] = []

    def write() -> None:
        waited.extend(writer.put_patiently(number, 0, bytes(5000)) for number in range(40))

    thread = threading.Thread(target=write)
    thread.start()
    time.sleep(0.2)
    assert thread.is_alive()
    held.set()
    thread.join(60)
    assert sum(waited) > 0.05
    reader.read_to(writer.written)
    assert taken == [(number, 5000) for number in range(40)]


def test_what_was_written_is_read_after_the_writer_has_gone(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16, patient=True)
    for number in range(10):
        writer.put_patiently(number, 0, b"last words")
    writer.close()
    assert not writer.put(10, 0, b"too late")
    reader.start()
    reader.read_all()
    assert [number for number, _, _ in taken] == list(range(10))


def test_a_patient_reader_looks_by_itself(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 20, patient=True)
    reader.start()
    writer.put(1, 2, b"small")
    deadline = time.monotonic() + 60
    while not taken and time.monotonic() < deadline:
        time.sleep(0.005)
    assert taken == [(1, 2, b"small")]


def test_a_fault_of_one_message_is_told_and_the_next_one_comes(ends: Ends) -> None:
    told = []

    def take(number: int, _: int, data: bytes) -> None:
        if number == 1:
            raise ValueError("no such message")
        told.append(data)

    writer, reader, faults = ends(1 << 16, take=take)
    reader.start()
    for number in range(3):
        writer.put(number, 0, b"%d" % number)
    reader.read_to(writer.written)
    assert told == [b"0", b"2"]
    assert faults == [(-1, 0, b"no such message")]


def test_a_limit_for_files_makes_a_smaller_ring(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def truncate(_: int, size: int) -> None:
        asked.append(size)
        if size > 5_000_000:
            raise OSError(27, "File too large")

    monkeypatch.setattr(ring.os, "ftruncate", truncate)
    ring.memory()
    assert len(asked) == 3
    assert asked[-1] <= 5_000_000
