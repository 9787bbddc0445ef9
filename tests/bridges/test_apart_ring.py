"""Messages through memory that two ends share."""

import contextlib
import errno
import os
import random
import resource
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.bridges.ring_reader import Steps

from cartwheel.bridges.apart import ring
from cartwheel.bridges.apart.ring import Put, RingReader, RingWriter
from cartwheel.bridges.apart.ring_files import RingFiles

Ends = Callable[..., tuple[RingWriter, RingReader, list[tuple[int, int, bytes]]]]
_PATIENCE = 60.0
_IDLE = 0.05
"""s for which one end is held at a step: the other has nothing left to do then, mostly. Where it
has, the test sees less, and does not fail."""


@pytest.fixture
def ends() -> Iterator[Ends]:
    opened: list[RingWriter] = []

    def make(
        size: int, *, patient: bool = False, take: Callable[[int, int, bytes], None] | None = None
    ) -> tuple[RingWriter, RingReader, list[tuple[int, int, bytes]]]:
        files, others = RingFiles.pair(size)
        taken: list[tuple[int, int, bytes]] = []
        writer = RingWriter(files)
        reader = RingReader(
            others,
            patient=patient,
            take=take or (lambda *found: taken.append(found)),
            on_fault=lambda error: taken.append((-1, 0, str(error).encode())),
        )
        opened.append(writer)
        return writer, reader, taken

    yield make
    for writer in opened:
        writer.close()


def _own_files() -> int:
    """Files of this process that hold a message."""
    names = []
    for each in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):  # closed just now
            names.append(str(each.readlink()))
    return sum("cartwheel message" in name for name in names)


class Apart:
    """A reader in another process, which can be stopped at one of its steps."""

    def __init__(self, step: int | None = None) -> None:
        files, theirs = RingFiles.pair(1 << 16)
        self.writer = RingWriter(files)
        self._process = subprocess.Popen(
            [
                *(sys.executable, "-m", "tests.bridges.ring_reader", str(theirs), "1000"),
                *([] if step is None else [str(step)]),
            ],
            pass_fds=theirs.numbers,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
        )
        theirs.close()

    def says(self, patience: float = _PATIENCE) -> str:
        """The next thing that it says; nothing where that does not come."""
        assert self._process.stdout is not None
        if not select.select([self._process.stdout], [], [], patience)[0]:
            return ""
        return self._process.stdout.readline().decode().strip()

    def go_on(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(b"\n")

    def signal(self, number: int) -> None:
        self._process.send_signal(number)
        if number == signal.SIGSTOP:
            # The signal returns before the process has stopped.
            os.waitid(os.P_PID, self._process.pid, os.WSTOPPED)

    def kill(self) -> None:
        self._process.kill()
        self._process.wait(_PATIENCE)

    def __enter__(self) -> "Apart":
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()
        self.kill()


def test_no_wakeup_is_lost_wherever_the_writer_is_held() -> None:
    """Held at each of its steps until the reader has read all and waits again."""
    step = 0
    while _writer_held(step):
        step += 1
    assert step > 10


def _writer_held(step: int) -> bool:
    """Whether it has as many steps."""
    held, released = threading.Event(), threading.Event()

    def hold() -> None:
        held.set()
        released.wait(_PATIENCE)

    def write() -> None:
        sys.settrace(Steps(step, hold).trace)
        reader.writer.put(1, 0, b"second")
        sys.settrace(None)

    with Apart() as reader:
        assert reader.says() == "ready"
        reader.writer.put(0, 0, b"first")
        assert reader.says() == "got 0 5"
        thread = threading.Thread(target=write)
        thread.start()
        while thread.is_alive() and not held.wait(0.01):
            pass
        reader.go_on()
        time.sleep(_IDLE)
        released.set()
        thread.join(_PATIENCE)
        assert reader.says() == "got 1 6", f"held at step {step}"
    return held.is_set()


def test_no_wakeup_is_lost_wherever_the_reader_is_held() -> None:
    """Held at each of its steps while the writer adds a message, and goes."""
    held = 0
    for step in range(40):
        with Apart(step) as reader:
            said: list[str] = []
            reader.writer.put(1, 0, b"first")
            while "stopped" not in said and "got 1 5" not in said:
                said.append(reader.says())
                assert said[-1]
            if "stopped" not in said:
                # Among the steps to the next wait, perhaps.
                said.append(reader.says(_IDLE))
            held += "stopped" in said
            reader.writer.put(2, 0, b"second")
            reader.writer.close()
            reader.go_on()
            while "end" not in said:
                said.append(reader.says())
                assert said[-1] or said[-2], f"held at step {step}: {said}"
            assert [each for each in said if each.startswith("got")] == ["got 1 5", "got 2 6"]
    assert held > 15


def test_what_was_put_before_the_writer_is_killed_is_read() -> None:
    """Whichever step it has come to."""
    program = (
        "import os, sys\n"
        "from cartwheel.bridges.apart.ring import RingWriter\n"
        "from cartwheel.bridges.apart.ring_files import RingFiles\n"
        "from tests.bridges.ring_reader import Steps\n"
        "writer = RingWriter(RingFiles.of(sys.argv[1]))\n"
        "writer.put(1, 0, b'first')\n"
        "sys.settrace(Steps(int(sys.argv[2]), lambda: os.kill(os.getpid(), 9)).trace)\n"
        "writer.put(2, 0, b'second')\n"
        "sys.settrace(None)\n"
        "os.write(1, b'put')\n"
        "os.kill(os.getpid(), 9)\n"
    )
    step, done = 0, False
    whole = []
    while not done:
        files, others = RingFiles.pair(1 << 16)
        taken: list[int] = []
        reader = RingReader(
            others,
            patient=True,
            take=lambda number, *_, taken=taken: taken.append(number),  # type: ignore[misc]
            on_fault=lambda _: None,
        )
        reader.start()
        died = subprocess.run(
            [sys.executable, "-c", program, str(files), str(step)],
            pass_fds=files.numbers,
            stdout=subprocess.PIPE,
            timeout=_PATIENCE,
            check=False,
        )
        files.close()
        reader.join()
        done = died.stdout == b"put"
        assert taken == [1, 2] or (not done and taken == [1])
        whole.append(len(taken))
        step += 1
    assert whole[0] == 1
    assert whole[-1] == 2


def test_a_writer_goes_on_where_the_reader_is_killed() -> None:
    with Apart() as reader:
        assert reader.says() == "ready"
        reader.kill()
        large = bytes(10_000)
        put = [reader.writer.put(1, 0, large) for _ in range(20)]
        assert put[-1] is Put.FULL
        assert put.index(Put.FULL) >= 4
        closing = threading.Timer(0.2, reader.writer.close)
        closing.start()
        assert reader.writer.put_patiently(1, 0, large)[0] is Put.CLOSED
        closing.join()


def test_a_reader_that_is_stopped_goes_on_reading() -> None:
    with Apart() as reader:
        assert reader.says() == "ready"
        reader.signal(signal.SIGSTOP)
        put = [reader.writer.put(number, 0, bytes(1000)) for number in range(1, 100)]
        assert put[-1] is Put.FULL
        reader.signal(signal.SIGCONT)
        for number in range(1, 1 + put.count(Put.TAKEN)):
            assert reader.says() == f"got {number} 1000"
        while reader.writer.put(100, 0, b"again") is Put.FULL:
            time.sleep(0.001)
        assert reader.says() == "got 100 5"


def test_all_sizes_come_in_order_many_times_round(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16, patient=True)
    reader.start()
    numbers = random.Random(1)
    sent = []
    for count in range(3000):
        size = numbers.choice([0, 1, 15, 16, 17, 900, 16_383, 16_384, 16_385, 200_000])
        data = numbers.randbytes(size)
        sent.append((count, count * 10, data))
        assert writer.put_patiently(count, count * 10, data)[0] is Put.TAKEN
    reader.read_to(writer.written)
    assert taken == sent


def test_a_full_ring_takes_no_more_and_loses_nothing_it_took(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16)
    took = [number for number in range(200) if writer.put(number, 0, bytes(1000)) is Put.TAKEN]
    assert len(took) == (1 << 16) // 1024
    assert took == list(range(len(took)))
    reader.start()
    reader.read_to(writer.written)
    assert [number for number, _, _ in taken] == took
    assert writer.put(7, 0, b"room again") is Put.TAKEN


def test_a_large_message_comes_in_its_place(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16)
    large = bytes(range(256)) * 260_000
    assert writer.put(1, 5, b"before") is Put.TAKEN
    assert writer.put(2, 6, large) is Put.TAKEN
    assert writer.put(3, 7, b"after") is Put.TAKEN
    reader.start()
    reader.read_to(writer.written)
    assert taken == [(1, 5, b"before"), (2, 6, large), (3, 7, b"after")]


def test_large_messages_on_their_way_are_bounded(
    ends: Ends, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ring, "LARGEST", 1 << 20)
    writer, reader, taken = ends(1 << 16)
    assert writer.put(0, 0, bytes((1 << 20) + 1)) is Put.TOO_LARGE
    put = [writer.put(number, 0, bytes(1 << 18)) for number in range(3)]
    assert put == [Put.TAKEN] * 3
    assert writer.put(3, 0, bytes(1 << 19)) is Put.FULL
    small = [writer.put(9, 0, bytes(20_000)) for _ in range(20)]
    assert small.count(Put.TAKEN) == 13, "there may be 16 of them at a time"
    assert not _own_files(), "what is on its way is the kernel's"
    reader.start()
    reader.read_to(writer.written)
    assert len(taken) == 16
    assert writer.put(0, 0, bytes(1 << 20)) is Put.TAKEN


def test_what_a_limit_for_files_forbids_is_too_large(ends: Ends) -> None:
    writer, reader, taken = ends(1 << 16)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, hard))
    try:
        assert writer.put(1, 0, bytes(200_000)) is Put.TOO_LARGE
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert writer.largest == (1 << 16) // 4
    assert writer.put(2, 0, bytes(writer.largest)) is Put.TAKEN
    reader.start()
    reader.read_to(writer.written)
    assert [number for number, _, _ in taken] == [2]


def test_a_patient_writer_waits_for_a_slow_reader(
    ends: Ends, monkeypatch: pytest.MonkeyPatch
) -> None:
    held, full = threading.Event(), threading.Event()
    taken = []

    def take(number: int, _: int, data: bytes) -> None:
        held.wait(_PATIENCE)
        taken.append((number, len(data)))

    writer, reader, _ = ends(1 << 16, patient=True, take=take)
    real = writer.put

    def put(number: int, time_ns: int, data: bytes) -> Put:
        found = real(number, time_ns, data)
        if found is Put.FULL:
            full.set()
        return found

    monkeypatch.setattr(writer, "put", put)
    reader.start()
    put_in: list[Put] = []
    waited: list[float] = []

    def write() -> None:
        for number in range(40):
            found, seconds = writer.put_patiently(number, 0, bytes(5000))
            put_in.append(found)
            waited.append(seconds)

    thread = threading.Thread(target=write)
    thread.start()
    # 40 messages of 5,000 bytes do not fit into 65,536, and the reader takes none.
    assert full.wait(_PATIENCE)
    assert 0 < len(put_in) < 40
    held.set()
    thread.join(_PATIENCE)
    assert put_in == [Put.TAKEN] * 40
    assert sum(waited) > 0
    reader.read_to(writer.written)
    assert taken == [(number, 5000) for number in range(40)]


@pytest.mark.parametrize("size", [10, 50_000])
def test_what_was_written_is_read_after_the_writer_has_gone(ends: Ends, size: int) -> None:
    writer, reader, taken = ends(1 << 16, patient=True)
    for number in range(10):
        writer.put_patiently(number, 0, bytes(size))
    writer.close()
    assert writer.put(10, 0, b"too late") is Put.CLOSED
    reader.start()
    reader.read_all()
    assert [(number, len(data)) for number, _, data in taken] == [(n, size) for n in range(10)]


@pytest.mark.parametrize("patient", [True, False])
def test_a_message_comes_without_another_one(ends: Ends, *, patient: bool) -> None:
    came = threading.Event()
    writer, reader, _ = ends(1 << 20, patient=patient, take=lambda *_: came.set())
    reader.start()
    writer.put(1, 2, b"small")
    assert came.wait(_PATIENCE)


def test_a_fault_of_one_message_is_reported_and_the_next_one_comes(ends: Ends) -> None:
    seen = []

    def take(number: int, _: int, data: bytes) -> None:
        if number == 1:
            raise ValueError("no such message")
        seen.append(data)

    writer, reader, faults = ends(1 << 16, take=take)
    reader.start()
    for number in range(3):
        writer.put(number, 0, b"%d" % number)
    reader.read_to(writer.written)
    assert seen == [b"0", b"2"]
    assert faults == [(-1, 0, b"no such message")]


def test_a_limit_for_files_makes_a_smaller_ring(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def truncate(_: int, size: int) -> None:
        asked.append(size)
        if size > 5_000_000:
            raise OSError(errno.EFBIG, "File too large")

    monkeypatch.setattr(ring.os, "ftruncate", truncate)
    for files in RingFiles.pair():
        files.close()
    assert len(asked) == 3
    assert asked[-1] <= 5_000_000


def test_nothing_is_left_open() -> None:
    files, others = RingFiles.pair()
    others.close()
    RingWriter(files).close()
    for number in (*files.numbers, *others.numbers):
        with pytest.raises(OSError, match="Bad file"):
            os.fstat(number)
