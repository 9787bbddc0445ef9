"""The files of a recording. A new one begins when time jumps back."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from cartwheel.bridges.recording.formats import Encoding
from cartwheel.bridges.recording.tap import Tap
from cartwheel.bridges.recording.writing import Writer, open_writer
from cartwheel.codes.recording import RECORDING_SPLIT
from cartwheel.errors import Diagnostic

FLUSH = 0.5
"""Wall time in s after which recorded data is passed to the operating system. A killed recorder
may lose at most 1 s. The remaining half is a reserve for busy machines."""
NEW_FILE = -1
"""Instead of the number of a topic: a new file begins, because time jumped back."""


def attached(number: int) -> int:
    """Number of a topic for a text to be attached; of such a number, the number of the topic."""
    return -2 - number


class Output:
    """Writes encoded messages to files.

    Args:
        path: Path of the first file.
        encoding: Encoding of the messages.
        overwrite: Whether to replace existing recordings.
        notes: Text to store with each file.
        taps: Topics by number. New ones may be appended at any time.
        warn: Receives warnings.
    """

    def __init__(
        self,
        path: Path,
        encoding: Encoding,
        *,
        overwrite: bool,
        notes: Mapping[str, str],
        taps: list[Tap],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._path = path
        self._encoding: Encoding = encoding
        self._overwrite = overwrite
        self._notes = notes
        self._taps = taps
        self._warn = warn
        self._writer: Writer | None = None
        self._channels: dict[int, int] = {}
        """Channels of the current file, by the number of the topic."""
        self.flush_due = 0.0
        """Time of the next flush on the monotonic clock, s."""
        self.files: list[Path] = []
        self.messages = 0
        """Number of written messages."""
        self.size = 0
        """Size of the written messages in bytes."""
        self.topics: set[str] = set()
        """Topics with messages."""

    def begin(self) -> None:
        """Creates the first file.

        Raises:
            RecordingError: The file cannot be written.
        """
        self._begin(self._path)

    def write(self, numbers: list[int], times: list[int], data: list[Any]) -> None:
        """Writes messages.

        Args:
            numbers: For each message, the number of its topic, `attached` of it for a text to be
                attached, or `NEW_FILE`.
            times: Times in ns.
            data: Encoded messages and texts.

        Raises:
            OSError: The file cannot be written.
            CartwheelError: A new file cannot be written.
        """
        if min(numbers) >= 0:
            self._write(numbers, times, data)
            return
        for number, time_ns, each in zip(numbers, times, data, strict=True):
            if number >= 0:
                self._write([number], [time_ns], [each])
            elif number == NEW_FILE:
                self._begin_next(time_ns)
            else:
                name = f"{self._taps[attached(number)].topic.strip('/').replace('/', '.')}.xml"
                self._current.attach(name, "application/xml", each.encode(), time_ns)

    def _write(self, numbers: list[int], times: list[int], data: list[bytes]) -> None:
        writer, channels = self._current, self._channels
        for number in dict.fromkeys(numbers):
            if number not in channels:
                tap = self._taps[number]
                channels[number] = writer.add(tap.topic, tap.type, latched=tap.latched)
                self.topics.add(tap.topic)
        writer.write([channels[number] for number in numbers], times, data)
        self.messages += len(data)
        self.size += sum(map(len, data))

    @property
    def _current(self) -> Writer:
        assert self._writer is not None
        return self._writer

    def flush_if_due(self) -> None:
        """Passes the messages to the operating system at the interval `FLUSH`.

        Raises:
            OSError: The file cannot be written.
        """
        now = time.monotonic()
        if now >= self.flush_due:
            if self._writer is not None:
                self._writer.flush()
            self.flush_due = now + FLUSH

    def close(self) -> None:
        """Completes the current file.

        Raises:
            OSError: The file cannot be written.
        """
        if self._writer is not None:
            self._writer.close()

    def abandon(self) -> int:
        """Saves what was written, after an `OSError`. Returns the time of the last message, ns."""
        if self._writer is None:
            return 0
        with suppress(OSError):
            self._writer.abandon()
        # Its last chunk may have been removed to make space for the end of the file.
        return self._writer.kept_ns

    def _begin_next(self, time_ns: int) -> None:
        """Begins a new file, because messages would no longer be in order."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None
        number = len(self.files)
        while True:
            path = self._path.with_name(f"{self._path.stem}_{number}{self._path.suffix}")
            if self._overwrite or not path.exists():
                break
            number += 1
        self._begin(path)
        self._warn(
            RECORDING_SPLIT.diagnostic(
                f"time jumped back to {time_ns / 1e9:.3f} s, so the recording "
                f'continues in "{path}"',
                values={"path": str(path), "time": time_ns / 1e9},
            )
        )

    def _begin(self, path: Path) -> None:
        self._channels.clear()
        self._writer = open_writer(
            path, self._encoding, overwrite=self._overwrite, notes=self._notes
        )
        self.flush_due = time.monotonic() + FLUSH
        self.files.append(path)
