"""The process in which a target reads its inputs. Started by the harness."""

from __future__ import annotations

import atexit
import collections
import contextlib
import faulthandler
import hashlib
import itertools
import json
import mmap
import os
import resource
import signal
import struct
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

COUNTERS = struct.Struct("<6Q")
"""Loaded (0 or 1), inputs begun, accepted, refused, with a finding, slowest in ms of CPU time."""
_TROUBLE = (b"Traceback (most recent call last)", b"Cartwheel has a fault", b"Exception ignored in")
_IMPORTING_S = 3.0
"""Wall time of the first input that does not count."""
_NEWEST = 4000
"""Inputs of the corpus that are kept."""


def main() -> None:
    """Reads its task as JSON from the command line."""
    task = json.loads(sys.argv[1])
    _die_with_parent()
    room = Path(task["room"])
    output = os.open(room / "output", os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
    # The file stays open as long as the process.
    stacks = (room / "stacks").open("w")
    faulthandler.enable(stacks)
    faulthandler.register(signal.SIGUSR1, stacks)
    os.dup2(output, 1)
    os.dup2(output, 2)
    os.environ["TMPDIR"] = str(room / "tmp")
    os.chdir(room / "tmp")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _Worker(task, room, output).run()
    # What targets opened is closed, and threads that they left behind hold nothing up.
    atexit._run_exitfuncs()
    sys.stdout.flush()
    os._exit(0)


def _die_with_parent() -> None:
    import ctypes

    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class _Worker:
    def __init__(self, task: dict, room: Path, output: int) -> None:
        from tests.campaign.coverage import Coverage

        self._task = task
        self._room = room
        self._output = output
        self._coverage = Coverage("cartwheel", room / "seen", room.parent / "compiled")
        from tests.campaign.registry import load

        self._target = load(task["target"])
        self._begin = os.open(room / "current", os.O_RDWR | os.O_CREAT)
        with (room / "counters").open("r+b") as file:
            self._counters = mmap.mmap(file.fileno(), COUNTERS.size)
        self._numbers = [1, 0, 0, 0, 0, 0]
        self._recent: collections.deque[bytes] = collections.deque(maxlen=self._target.history + 1)
        self._corpus: list[bytes] = []
        self._limited = False

    def run(self) -> None:
        given = self._task.get("inputs")
        if given is not None:
            # As in a campaign, where a seed imports what is needed before memory is limited.
            with contextlib.suppress(*self._target.allowed):
                self._target.run_one(self._target.seeds()[0])
            self._limited = True
            self._limit()
            COUNTERS.pack_into(self._counters, 0, *self._numbers)
            for file in given:
                self._one(Path(file).read_bytes())
            return
        inputs = self._inputs()
        first = next(inputs)
        # Seeds can take longer than an input: from here on, the time of an input holds.
        COUNTERS.pack_into(self._counters, 0, *self._numbers)
        begin = time.monotonic()
        end = 0.0
        for data in itertools.chain([first], inputs):
            new = self._one(data)
            if new and len(self._corpus) < _NEWEST:
                self._keep(data)
            # The first input imports what is needed: the time is for those after it.
            end = end or min(time.monotonic(), begin + _IMPORTING_S) + self._task["seconds"]
            if time.monotonic() > end:
                break
        self._coverage.save()
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        (self._room / "stats").write_text(
            json.dumps({"peak_mb": peak, "blocks": self._coverage.blocks})
        )

    def _inputs(self) -> Iterator[bytes]:
        seeds = self._target.seeds()
        if not seeds:
            raise RuntimeError(f'the target "{self._target.name}" has no seeds')
        folder = self._room / "corpus"
        self._corpus = [file.read_bytes() for file in sorted(folder.iterdir())]
        first = self._task["first"]
        # All seeds at first, one in each later slice: after it the limit of memory is set.
        yield from seeds if first == 0 else seeds[:1]
        self._corpus += seeds
        number = first
        while True:
            random = Random(f"{self._task['seed']} {self._target.name} {number}")
            number += 1
            base = random.choice(self._corpus[-200:] if random.random() < 0.3 else self._corpus)
            yield self._target.mutate(base, self._corpus, random)[: self._target.most_bytes]

    def _keep(self, data: bytes) -> None:
        name = f"{len(self._corpus):06d}-{hashlib.sha256(data).hexdigest()[:12]}"
        (self._room / "corpus" / name).write_bytes(data)
        self._corpus.append(data)

    def _one(self, data: bytes) -> bool:
        """Lets the target read one input; says whether it reached something new."""
        from tests.campaign.finding import of_exception

        self._recent.append(data)
        self._write_current()
        self._numbers[1] += 1
        COUNTERS.pack_into(self._counters, 0, *self._numbers)
        before = time.process_time()
        outcome = 2
        try:
            self._target.run_one(data)
        except self._target.allowed as error:
            outcome = 3
            str(error)
        except (Exception, SystemExit, KeyboardInterrupt) as error:  # noqa: BLE001
            outcome = 4
            of_exception(self._target.name, error, tuple(self._recent)).save(
                self._room.parent / "findings"
            )
        if self._printed_trouble():
            outcome = 4
        took = round((time.process_time() - before) * 1000)
        self._numbers[outcome] += 1
        self._numbers[5] = max(self._numbers[5], took)
        COUNTERS.pack_into(self._counters, 0, *self._numbers)
        if not self._limited:
            self._limited = True
            self._limit()
        return outcome != 4 and self._coverage.is_new()

    def _write_current(self) -> None:
        parts = b"".join(struct.pack("<Q", len(each)) + each for each in self._recent)
        os.pwrite(self._begin, struct.pack("<Q", len(parts)) + parts, 0)

    def _printed_trouble(self) -> bool:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(ValueError, OSError):
                stream.flush()
        if not os.fstat(self._output).st_size:
            return False
        text = os.pread(self._output, 1 << 20, 0)
        os.ftruncate(self._output, 0)
        if not any(word in text for word in _TROUBLE):
            return False
        from tests.campaign.finding import of_output

        shown = text.decode(errors="replace")
        of_output(self._target.name, shown, tuple(self._recent)).save(
            self._room.parent / "findings"
        )
        return True

    def _limit(self) -> None:
        if self._target.memory_mb is not None:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            most = pages * resource.getpagesize() + (self._target.memory_mb << 20)
            hard = resource.getrlimit(resource.RLIMIT_AS)[1]
            resource.setrlimit(resource.RLIMIT_AS, (most, hard))


if __name__ == "__main__":
    main()
