"""Recorder for the topics of a graph."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.mirror import offered_by_others
from cartwheel.bridges.recording.backlog import Backlog
from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.formats import (
    Encoding,
    check_writable,
    encoding_for,
    reason_of,
)
from cartwheel.bridges.recording.patterns import Patterns
from cartwheel.bridges.recording.tap import READER, Tap
from cartwheel.bridges.recording.writing import Writer, open_writer
from cartwheel.codes.recording import (
    DISK_SLOW,
    MESSAGE_NOT_RECORDED,
    RECORDING_BROKE_OFF,
    RECORDING_SPLIT,
    TOPIC_PATTERN_UNMATCHED,
)
from cartwheel.errors import (
    CartwheelError,
    Diagnostic,
    RecordingError,
    UnknownNameError,
    one_line,
)
from cartwheel.messages import decode_cdr, encode_cdr, zero

FLUSH = 0.5
"""Wall time in s after which recorded data is passed to the operating system. A killed recorder
may lose at most 1 s. The remaining half is a reserve for busy machines."""
_LONG_WAIT = 1.0
"""Total waiting time of the simulation in s from which it is reported."""


_AT_ONCE = 100
"""Number of messages that are written without looking at the clock."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Summary:
    """Result of a recording."""

    files: tuple[Path, ...]
    messages: int
    topics: int
    size: int
    """Size of the messages in bytes."""
    waited: float
    """Wall time in s for which the simulation has waited for the disk."""


_Item = tuple[Tap | None, int, bytes | str]
"""Topic, time in ns, and an encoded message, or a text to be attached. Without a topic, a new file
begins, because time jumped back."""


class Recorder:
    """Writes all messages of the selected topics to a file, in order and with simulation time.

    No message is dropped: if the disk is too slow, the simulation waits. The recorder is a
    subscriber, so a recorded camera renders, and latched messages come first. Topics that appear
    later are recorded from then on. If time jumps back, for example after a reset, a new file
    begins.

    Args:
        graph: Graph with the topics.
        path: ``.mcap``, ``.bag``, ``.db3``, or a folder for a ROS 2 bag.
        time_ns: Returns the simulation time.
        topics: Patterns; empty for all topics.
        encoding: Encoding of the messages. None uses the default of the format.
        overwrite: Whether to replace an existing recording.
        notes: Text to store with the recording.
        report: Receives diagnostics for the user, on any thread.
        on_failure: Called on a separate thread when an error has ended the recording.

    Raises:
        RecordingError: The recording cannot be created.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        path: Path | str,
        *,
        time_ns: Callable[[], int],
        topics: Sequence[str] = (),
        encoding: Encoding | None = None,
        overwrite: bool = False,
        notes: Mapping[str, str] | None = None,
        report: Callable[[Diagnostic], None] = lambda _: None,
        on_failure: Callable[[RecordingError], None] = lambda _: None,
    ) -> None:
        self.path = Path(path)
        self._graph = graph
        self._time_ns = time_ns
        self._patterns = Patterns(topics)
        self._encoding: Encoding = encoding_for(self.path, encoding)
        self._overwrite = overwrite
        self._notes = dict(notes or {})
        self._report = report
        self._on_failure = on_failure
        self._codec = codec(self._encoding, graph.cdr.encode)
        self._is_ros1 = self._encoding == "ros1"
        self._pack = graph.cdr.encode
        self._counts: dict[str, int] = {}
        """Number of messages of each channel that were encoded for the current file, for ROS 1."""
        self._backlog = Backlog[_Item]()
        self._taps: dict[str, Tap] = {}
        self._survey_due = False
        self._surveyor: int | None = None
        self._time = -1
        self._files: list[Path] = []
        self._writer: Writer | None = None
        self._channels: dict[str, int] = {}
        self._refused: set[str] = set()
        self._messages = 0
        self._size = 0
        self._topics: set[str] = set()
        self._has_warned = False
        self._flush_due = 0.0
        self.failure: RecordingError | None = None
        """The error that ended the recording, or None."""
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        check_writable(self.path, overwrite=overwrite)

    def start(self) -> None:
        """Starts recording. Call it on the owner's thread.

        Raises:
            RecordingError: The file cannot be written.
        """
        self._begin(self.path)
        self._graph.on_change.append(self._changed)
        self._survey()
        self._prepare()
        self._thread.start()

    def update(self) -> None:
        """Subscribes to new topics at once, before they publish."""
        self._survey()

    def close(self) -> Summary:
        """Stops recording and completes the file. Call it on the owner's thread.

        Raises:
            RecordingError: An error had already ended the recording.
        """
        if self._changed in self._graph.on_change:
            self._graph.on_change.remove(self._changed)
        for tap in self._taps.values():
            tap.close()
        self._taps.clear()
        self._backlog.close()
        if self._thread.is_alive():
            self._thread.join()
        if self.failure is not None:
            raise self.failure
        for pattern in self._patterns.unmatched:
            self._warn(
                TOPIC_PATTERN_UNMATCHED.diagnostic(
                    f'no topic matched "{pattern}"', values={"pattern": pattern}
                )
            )
        return self.summary

    @property
    def summary(self) -> Summary:
        """Result of the recording so far."""
        return Summary(
            files=tuple(self._files),
            messages=self._messages,
            topics=len(self._topics),
            size=self._size,
            waited=self._backlog.waited,
        )

    # -- on the owner's thread

    def take(self, tap: Tap, message: Any) -> None:
        """Encodes and queues a message. Waits if too many messages are queued.

        Messages are encoded here, because keeping their many objects until the recorder's thread
        encodes them takes several times as long, in Python's garbage collector.
        """
        time_ns = self._time_ns()
        if time_ns < self._time:
            self._restart(tap, time_ns)
        self._time = time_ns
        if tap.latched:
            tap.last = message
        self._put(tap, time_ns, message)

    def _restart(self, tap: Tap, time_ns: int) -> None:
        """Begins a new file with the latched messages, except that of a tap, which follows."""
        self._counts.clear()
        self._backlog.put((None, time_ns, b""), 0)
        for other in self._taps.values():
            if other.last is not None and other is not tap:
                self._put(other, time_ns, other.last)

    def _put(self, tap: Tap, time_ns: int, message: Any) -> None:
        try:
            if self._is_ros1:
                count = self._counts.get(tap.key, 0) + 1
                data = self._codec.encode(message, count)
                self._counts[tap.key] = count
            else:
                data = self._pack(message)
        except CartwheelError as error:
            self._refuse(tap, error)
            return
        self._backlog.put((tap, time_ns, data), len(data))
        if tap.describes:
            self._backlog.put((tap, time_ns, message.data), len(data))
        if self._backlog.waited > _LONG_WAIT and not self._has_warned:
            self._has_warned = True
            self._warn(
                DISK_SLOW.diagnostic(
                    "the disk is slower than the simulation, so the simulation waits; no messages "
                    "are lost"
                )
            )

    def _refuse(self, tap: Tap, error: CartwheelError) -> None:
        """Reports the first message of a topic that cannot be encoded."""
        if tap.topic in self._refused:
            return
        self._refused.add(tap.topic)
        if isinstance(error, UnknownNameError):
            diagnostic = MESSAGE_NOT_RECORDED.diagnostic(
                f"{tap.topic} is not recorded because ROS 1 has no type {tap.type}",
                values={"topic": tap.topic, "type": tap.type},
            )
        else:
            diagnostic = MESSAGE_NOT_RECORDED.because(
                f"messages on {tap.topic} are not recorded", error, values={"topic": tap.topic}
            )
        self._warn(diagnostic)

    def _changed(self) -> None:
        """Called on any thread, with the graph locked."""
        if threading.get_ident() == self._surveyor:
            return  # caused by the recorder's own subscriptions
        if not self._survey_due:
            self._survey_due = True
            self._graph.post(self._survey)

    def _survey(self) -> None:
        self._survey_due = False
        if not self._backlog.is_open:
            return
        self._surveyor = threading.get_ident()
        try:
            self._mirror()
        finally:
            self._surveyor = None

    def _mirror(self) -> None:
        topics = offered_by_others(self._graph, READER)
        for name, tap in list(self._taps.items()):
            if name not in topics or topics[name].type != tap.type:
                del self._taps[name]
                tap.close()
            else:
                tap.latched = topics[name].qos == "latched"
        for name, info in topics.items():
            if name not in self._taps and self._patterns.match(name):
                self._taps[name] = Tap(self._graph, info, self.take)

    def _prepare(self) -> None:
        """Prepares the encoding of each type, which would otherwise delay its first message.

        For ROS 1, this generates the code that reads and writes the messages.
        """
        for tap in self._taps.values():
            with suppress(CartwheelError):
                self._codec.schema(tap.type)
                message = zero(tap.type)
                if self._is_ros1:
                    message = decode_cdr(encode_cdr(message), tap.type)
                self._codec.encode(message, 0)

    # -- on the recorder's thread

    def _run(self) -> None:
        self._flush_due = time.monotonic() + FLUSH
        try:
            while True:
                was_open = self._backlog.is_open
                items = self._backlog.get(max(0.0, self._flush_due - time.monotonic()))
                for begin in range(0, len(items), _AT_ONCE):
                    some = items[begin : begin + _AT_ONCE]
                    for (tap, time_ns, data), _ in some:
                        self._write(tap, time_ns, data)
                    self._backlog.done(sum(size for _, size in some))
                    self._flush_if_due()
                self._flush_if_due()
                if not was_open and not items:
                    break
            if self._writer is not None:
                self._writer.close()
        except OSError as error:
            self._fail(reason_of(error), hint=_HINT)
        except CartwheelError as error:
            self._fail(error.message, hint=error.hint)
        except Exception as error:  # noqa: BLE001 - the simulation must not wait forever
            self._fail(one_line(error))

    def _fail(self, why: str, *, hint: str | None = None) -> None:
        kept = 0
        if self._writer is not None:
            with suppress(OSError):
                self._writer.abandon()
            # Its last chunk may have been removed to make space for the end of the file.
            kept = self._writer.kept_ns
        self.failure = RecordingError(
            f'the recording "{self._files[-1]}" stopped at {kept / 1e9:.3f} s: {why}',
            code=RECORDING_BROKE_OFF,
            hint=hint,
            values={"path": str(self._files[-1]), "time": kept / 1e9, "reason": why},
        )
        self._backlog.close()
        self._on_failure(self.failure)

    def _flush_if_due(self) -> None:
        if time.monotonic() >= self._flush_due:
            if self._writer is not None:
                self._writer.flush()
            self._flush_due = time.monotonic() + FLUSH

    def _write(self, tap: Tap | None, time_ns: int, data: bytes | str) -> None:
        if tap is None:
            self._begin_next(time_ns)
            return
        writer = self._writer
        assert writer is not None
        if isinstance(data, str):
            name = f"{tap.topic.strip('/').replace('/', '.')}.xml"
            writer.attach(name, "application/xml", data.encode(), time_ns)
            return
        channel = self._channels.get(tap.key)
        if channel is None:
            channel = writer.add(tap.topic, tap.type, latched=tap.latched)
            self._channels[tap.key] = channel
            self._topics.add(tap.topic)
        writer.write(channel, time_ns, data)
        self._messages += 1
        self._size += len(data)

    def _begin_next(self, time_ns: int) -> None:
        """Begins a new file, because time jumped back and messages would no longer be in order."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None
        number = len(self._files)
        while True:
            path = self.path.with_name(f"{self.path.stem}_{number}{self.path.suffix}")
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
            path,
            self._encoding,
            overwrite=self._overwrite,
            notes=self._notes,
        )
        self._files.append(path)

    def _warn(self, diagnostic: Diagnostic) -> None:
        self._report(replace(diagnostic, message=f"recording: {diagnostic.message}"))


_HINT = "Earlier messages can be read. Inspect the file with cartwheel info."
