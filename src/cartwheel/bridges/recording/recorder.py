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
from cartwheel.bridges.recording.backlog import WIDTH, Backlog
from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.formats import (
    Encoding,
    check_writable,
    encoding_for,
    reason_of,
)
from cartwheel.bridges.recording.output import NEW_FILE, Output, attached
from cartwheel.bridges.recording.patterns import Patterns
from cartwheel.bridges.recording.tap import READER, Tap
from cartwheel.codes.recording import (
    DISK_SLOW,
    MESSAGE_NOT_RECORDED,
    RECORDING_BROKE_OFF,
    TOPIC_PATTERN_UNMATCHED,
)
from cartwheel.errors import (
    CartwheelError,
    Diagnostic,
    RecordingError,
    UnknownNameError,
    one_line,
)
from cartwheel.graph import TakeValues, TopicInfo
from cartwheel.messages import Form, decode_cdr, encode_cdr, zero

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
        self._report = report
        self._on_failure = on_failure
        self._codec = codec(self._encoding, graph.cdr.encode)
        self._is_ros1 = self._encoding == "ros1"
        self._pack = graph.cdr.encode
        self._counts: dict[int, int] = {}
        """Number of messages of each topic that were encoded for the current file, for ROS 1."""
        self._backlog = Backlog(on_wait=self._waited)
        self._taps: dict[str, Tap] = {}
        self._known: list[Tap] = []
        """The last tap of each topic and type, by its number in the backlog."""
        self._survey_due = False
        self._surveyor: int | None = None
        self._time = -1
        self._refused: set[str] = set()
        self._has_warned = False
        self._output = Output(
            self.path,
            self._encoding,
            overwrite=overwrite,
            notes=dict(notes or {}),
            taps=self._known,
            warn=self._warn,
        )
        self.failure: RecordingError | None = None
        """The error that ended the recording, or None."""
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        check_writable(self.path, overwrite=overwrite)

    def start(self) -> None:
        """Starts recording. Call it on the owner's thread.

        Raises:
            RecordingError: The file cannot be written.
        """
        self._output.begin()
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
        output = self._output
        return Summary(
            files=tuple(output.files),
            messages=output.messages,
            topics=len(output.topics),
            size=output.size,
            waited=self._backlog.waited,
        )

    # -- on the owner's thread

    def _take_of(self, tap: Tap) -> Callable[[Any], None]:
        """Returns the function that receives the messages of a tap.

        It encodes and queues a message, and waits if too many messages are queued. Messages are
        encoded here, because keeping their many objects until the recorder's thread encodes them
        takes several times as long, in Python's garbage collector.
        """
        # Local names instead of attributes, because this runs for each message.
        now, pack, put, number = self._time_ns, self._pack, self._backlog.put, tap.number
        is_special = tap.describes or self._is_ros1

        def take(message: Any) -> None:
            time_ns = now()
            if time_ns < self._time:
                self._restart(tap, time_ns)
            self._time = time_ns
            if is_special or tap.latched:
                self._put(tap, time_ns, message)
                return
            try:
                data = pack(message)
            except CartwheelError as error:
                self._refuse(tap, error)
                return
            put(number, time_ns, data)

        return take

    def _take_values_of(self, tap: Tap) -> TakeValues | None:
        """Returns the function that receives values instead of messages, which it encodes and
        queues; None if the tap needs the messages.
        """
        if tap.describes:
            return None
        now, put, number = self._time_ns, self._backlog.put, tap.number
        counts = self._counts if self._is_ros1 else None

        def take_values(form: Form, values: tuple[Any, ...]) -> None:
            time_ns = now()
            if time_ns < self._time:
                self._restart(tap, time_ns)
            self._time = time_ns
            try:
                if counts is None:
                    data = form.encode(values)
                else:
                    count = counts.get(number, 0) + 1
                    data = form.encode_ros1(values, seq=count)
                    counts[number] = count
            except CartwheelError as error:
                self._refuse(tap, error)
                return
            put(number, time_ns, data)

        return take_values

    def _restart(self, tap: Tap, time_ns: int) -> None:
        """Begins a new file with the latched messages, except that of a tap, which follows."""
        self._counts.clear()
        self._backlog.put(NEW_FILE, time_ns, b"")
        for other in self._taps.values():
            if other.last is not None and other is not tap:
                self._put(other, time_ns, other.last)

    def _put(self, tap: Tap, time_ns: int, message: Any) -> None:
        """Queues a message that is latched, or attached, or encoded for ROS 1."""
        if tap.latched:
            tap.last = message
        try:
            if self._is_ros1:
                count = self._counts.get(tap.number, 0) + 1
                data = self._codec.encode(message, count)
                self._counts[tap.number] = count
            else:
                data = self._pack(message)
        except CartwheelError as error:
            self._refuse(tap, error)
            return
        self._backlog.put(tap.number, time_ns, data)
        if tap.describes:
            self._backlog.put(attached(tap.number), time_ns, message.data)

    def _waited(self, seconds: float) -> None:
        if seconds > _LONG_WAIT and not self._has_warned:
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
                self._taps[name] = tap = self._tap(info)
                tap.open(self._graph, self._take_of(tap), self._take_values_of(tap))

    def _tap(self, info: TopicInfo) -> Tap:
        """Creates the tap of a topic. A topic that returns keeps its channel in the file."""
        for number, known in enumerate(self._known):
            if (known.topic, known.type) == (info.name, info.type):
                self._known[number] = tap = Tap(info, number)
                return tap
        tap = Tap(info, len(self._known))
        self._known.append(tap)
        return tap

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
        output, backlog = self._output, self._backlog
        try:
            while True:
                was_open = backlog.is_open
                items = backlog.get(max(0.0, output.flush_due - time.monotonic()))
                for begin in range(0, len(items), WIDTH * _AT_ONCE):
                    some = items[begin : begin + WIDTH * _AT_ONCE]
                    numbers, times, data = (some[place::WIDTH] for place in range(WIDTH))
                    output.write(numbers, times, data)
                    backlog.done(data)
                    output.flush_if_due()
                output.flush_if_due()
                if not was_open and not items:
                    break
            output.close()
        except OSError as error:
            self._fail(reason_of(error), hint=_HINT)
        except CartwheelError as error:
            self._fail(error.message, hint=error.hint)
        except Exception as error:  # noqa: BLE001 - the simulation must not wait forever
            self._fail(one_line(error))

    def _fail(self, why: str, *, hint: str | None = None) -> None:
        kept, path = self._output.abandon(), self._output.files[-1]
        self.failure = RecordingError(
            f'the recording "{path}" stopped at {kept / 1e9:.3f} s: {why}',
            code=RECORDING_BROKE_OFF,
            hint=hint,
            values={"path": str(path), "time": kept / 1e9, "reason": why},
        )
        self._backlog.close()
        self._on_failure(self.failure)

    def _warn(self, diagnostic: Diagnostic) -> None:
        self._report(replace(diagnostic, message=f"recording: {diagnostic.message}"))


_HINT = "Earlier messages can be read. Inspect the file with cartwheel info."
