"""Recorder for the topics of a graph."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.mirror import offered_by_others
from cartwheel.bridges.recording.backlog import Backlog, Item
from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.formats import (
    Encoding,
    check_writable,
    encoding_for,
    reason_of,
)
from cartwheel.bridges.recording.patterns import Patterns
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
    GraphError,
    RecordingError,
    UnknownNameError,
    one_line,
)
from cartwheel.graph import TopicInfo
from cartwheel.messages import decode_cdr, encode_cdr, zero

READER = "recorder"
"""Node name of the recorder in the graph."""
FLUSH = 0.5
"""Wall time in s after which recorded data is passed to the operating system. A killed recorder
may lose at most 1 s. The remaining half is a reserve for busy machines."""
_LONG_WAIT = 1.0
"""Total waiting time of the simulation in s from which it is reported."""


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


class _Tap:
    """Subscription of one topic."""

    def __init__(self, recorder: Recorder, graph: BridgedGraph, info: TopicInfo) -> None:
        self.type = info.type
        self.latched = info.qos == "latched"
        self.topic = info.name
        self.last: Any = None
        self._recorder = recorder
        self._subscription: BridgedSubscription = graph.subscribe(
            info.name, self._take, type_name=info.type, node=READER
        )

    def _take(self, message: Any) -> None:
        if self.latched:
            self.last = message
        self._recorder.take(self, message)

    def close(self) -> None:
        """Unsubscribes."""
        self._subscription.close()


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
        self._backlog = Backlog()
        self._taps: dict[str, _Tap] = {}
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

    def take(self, tap: _Tap, message: Any) -> None:
        """Queues a message. Waits if too many messages are queued."""
        time_ns = self._time_ns()
        begins = time_ns < self._time
        self._time = time_ns
        if begins:
            for other in self._taps.values():
                if other.last is not None and other is not tap:
                    self._put(other, time_ns, other.last, begins=begins)
                    begins = False
        self._put(tap, time_ns, message, begins=begins)

    def _put(self, tap: _Tap, time_ns: int, message: Any, *, begins: bool) -> None:
        self._backlog.put(Item(tap.topic, tap.type, tap.latched, time_ns, message, begins))
        if self._backlog.waited > _LONG_WAIT and not self._has_warned:
            self._has_warned = True
            self._warn(
                DISK_SLOW.diagnostic(
                    "the disk is slower than the simulation, so the simulation waits; no messages "
                    "are lost"
                )
            )

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
                self._taps[name] = _Tap(self, self._graph, info)

    def _prepare(self) -> None:
        """Prepares the encoding of each type, which would otherwise delay its first message.

        For ROS 1, this generates the code that reads and writes the messages.
        """
        made = codec(self._encoding)
        for tap in self._taps.values():
            with suppress(CartwheelError):
                made.schema(tap.type)
                if self._encoding == "ros1":
                    made.encode(decode_cdr(encode_cdr(zero(tap.type)), tap.type), 0)

    # -- on the recorder's thread

    def _run(self) -> None:
        self._flush_due = time.monotonic() + FLUSH
        try:
            while True:
                was_open = self._backlog.is_open
                items = self._backlog.get(max(0.0, self._flush_due - time.monotonic()))
                for item in items:
                    self._write(item)
                    self._flush_if_due()
                self._backlog.done(items)
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

    def _write(self, item: Item) -> None:
        if item.begins:
            self._begin_next()
        writer = self._writer
        assert writer is not None
        channel = self._channel(writer, item)
        if channel is None:
            return
        try:
            size = writer.write(channel, item.time_ns, item.message)
        except GraphError as error:
            if item.topic not in self._refused:
                self._refused.add(item.topic)
                self._warn(
                    MESSAGE_NOT_RECORDED.because(
                        f"messages on {item.topic} are not recorded",
                        error,
                        values={"topic": item.topic},
                    )
                )
            return
        self._messages += 1
        self._size += size
        self._topics.add(item.topic)
        if item.topic.endswith("robot_description") and item.type == "std_msgs/msg/String":
            name = f"{item.topic.strip('/').replace('/', '.')}.xml"
            writer.attach(name, "application/xml", item.message.data.encode(), item.time_ns)

    def _channel(self, writer: Writer, item: Item) -> int | None:
        key = f"{item.topic} {item.type}"
        if key in self._channels:
            return self._channels[key]
        if key in self._refused:
            return None
        try:
            made = writer.add(item.topic, item.type, latched=item.latched)
        except UnknownNameError:
            self._refused.add(key)
            self._warn(
                MESSAGE_NOT_RECORDED.diagnostic(
                    f"{item.topic} is not recorded because ROS 1 has no type {item.type}",
                    values={"topic": item.topic, "type": item.type},
                )
            )
            return None
        self._channels[key] = made
        return made

    def _begin_next(self) -> None:
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
                f"time jumped back to {self._time / 1e9:.3f} s, so the recording "
                f'continues in "{path}"',
                values={"path": str(path), "time": self._time / 1e9},
            )
        )

    def _begin(self, path: Path) -> None:
        self._channels.clear()
        self._writer = open_writer(
            path,
            self._encoding,
            overwrite=self._overwrite,
            notes=self._notes,
            pack=self._graph.cdr.encode,
        )
        self._files.append(path)

    def _warn(self, diagnostic: Diagnostic) -> None:
        self._report(replace(diagnostic, message=f"recording: {diagnostic.message}"))


_HINT = "Earlier messages can be read. Inspect the file with cartwheel info."
