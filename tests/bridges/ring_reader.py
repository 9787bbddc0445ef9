"""The reading end of a ring, in a process of its own that a test can stop at each of its steps.

python -m tests.bridges.ring_reader FILES LINGER [STEP]

It writes ``got NUMBER SIZE`` for each message, ``stopped`` where it stops at a step and ``end`` at
its end, and goes on when it reads a line.
"""

import os
import sys
import threading
from types import FrameType
from typing import Any

from cartwheel.bridges.apart import ring, ring_files
from cartwheel.bridges.apart.ring import RingReader


class Steps:
    """Traces a thread, and calls a function before one of the steps that it makes in the ring.

    Args:
        step: Which, from 0 on: each line of `ring` and `ring_files` that the thread runs is one.
        stop: Called there, once.
    """

    def __init__(self, step: int, stop: Any) -> None:
        self.count = 0
        self._step = step
        self._stop = stop

    def trace(self, frame: FrameType, event: str, _: Any) -> Any:
        """For `sys.settrace`."""
        if frame.f_code.co_filename not in (ring.__file__, ring_files.__file__):
            return None
        if event == "line":
            self.count += 1
            if self.count == self._step + 1:
                self._stop()
        return self.trace


def _say(text: str) -> None:
    # In one piece: two threads do.
    os.write(1, f"{text}\n".encode())


def _stop() -> None:
    _say("stopped")
    sys.stdin.readline()


def main(files: str, linger: str, step: str = "") -> None:
    """Reads until the writer has gone."""
    # A wake-up that is lost must not be made good by the next look.
    ring.LINGER = float(linger)
    if step:
        threading.settrace(Steps(int(step), _stop).trace)

    def take(number: int, _: int, data: bytes) -> None:
        _say(f"got {number} {len(data)}")
        if number == 0:
            sys.stdin.readline()

    reader = RingReader(
        ring_files.RingFiles.of(files),
        patient=False,
        take=take,
        on_fault=lambda error: _say(f"fault {error!r}"),
    )
    reader.start()
    _say("ready")
    reader.join()
    _say("end")


if __name__ == "__main__":
    main(*sys.argv[1:])
