"""Recordings of a session, each written by a process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.assembly.observer import Observer
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.codes.recording import RECORDING_BROKE_OFF
from cartwheel.errors import CartwheelError, ControlError, RecordingError, UnknownNameError
from cartwheel.options import RECORD

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.recording import Encoding
    from cartwheel.bridges.recording.recorder import Summary
    from cartwheel.session import Session


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordingOptions:
    """What is recorded, and how."""

    topics: tuple[str, ...] = ()
    """Patterns; all topics if empty."""
    encoding: str | None = None
    """Message encoding in ``.mcap`` files: ``ros2`` or ``ros1``."""
    overwrite: bool = False


def check_recordings(paths: Sequence[Path], options: RecordingOptions) -> None:
    """Rejects invalid options before anything is built.

    Raises:
        CartwheelError: An option is invalid, or a file cannot be written.
    """
    from cartwheel.bridges.recording.formats import check_writable, encoding_for

    found: set[Path] = set()
    for path in paths:
        encoding_for(path, _encoding(options))
        check_writable(path, overwrite=options.overwrite)
        place = path.absolute()
        if place in found:
            raise RecordingError(
                f'{RECORD} specifies "{path}" twice',
                code=OPTIONS_CONFLICT,
                values={"path": str(path)},
            )
        found.add(place)


class Recording:
    """A recording of a session. A failing recording stops the run.

    Args:
        session: The session.
        process: The recorder's process, which is closed with the recording.
        path: File or folder to record to.
        options: What is recorded.
        observer: Is notified.
        failed: Called when the recording has failed, on any thread.

    Raises:
        RecordingError: The recording cannot be written.
    """

    def __init__(
        self,
        session: Session,
        process: BridgeProcess,
        path: Path,
        options: RecordingOptions,
        *,
        observer: Observer,
        failed: Callable[[], None],
    ) -> None:
        self.path = path
        self._session = session
        self._process = process
        self._observer = observer
        self._on_failure = failed
        self._lock = threading.Lock()
        self._finished = self._closed = False
        self._failure: CartwheelError | None = None
        self._summary: Summary | None = None
        self.failed = False
        """Whether the recording has failed, and `close` will raise the error."""
        simulation = session.simulation
        process.open(
            session.graph,
            {
                "path": str(path),
                "topics": options.topics,
                "encoding": _encoding(options),
                "overwrite": options.overwrite,
                "notes": dict(session.notes),
            },
            time_ns=lambda: simulation.time_ns,
            echo=True,
            report=simulation.report,
            handlers={"failed": (lambda _: self._fail(), False)},
        )
        process.on_lost = self._fail

    def start(self) -> None:
        """Starts to record. Call it on the owner's thread.

        Raises:
            RecordingError: The recording cannot be written.
        """
        self._process.call("start")
        self._observer.recording_started(self.path)

    def update(self) -> None:
        """Subscribes to new topics, so that their first messages are recorded. Call it on the
        owner's thread between two runs.
        """
        if not self.failed and not self._finished:
            self._process.call("update")

    def close(self) -> None:
        """Completes the recording. Call it on the owner's thread.

        Raises:
            RecordingError: The recording has failed.
        """
        self.finish()
        if self._closed:
            return
        self._closed, self.failed = True, False
        self._session.simulation.drain()
        if self._failure is not None:
            raise self._failure
        done = self._summary
        if done is not None:
            self._observer.recording_ended(done.files, done.messages, done.topics, done.size)

    def finish(self) -> None:
        """Writes all messages and closes the file. Other threads that call it wait."""
        with self._lock:
            if self._finished:
                return
            self._finished = True
            self._process.leave_graph()
            try:
                # without a timeout, because the disk may be slow
                self._summary = self._process.call("close", self._process.written, timeout=None)
            except ControlError:
                self._failure = RecordingError(
                    f'the recording "{self.path}" stopped because its process exited',
                    code=RECORDING_BROKE_OFF,
                    hint="Earlier messages can be read. Inspect the file with cartwheel info.",
                    values={"path": str(self.path)},
                )
            except CartwheelError as error:
                self._failure = error
            self._process.close()

    def _fail(self) -> None:
        self.failed = True
        self._on_failure()


def _encoding(options: RecordingOptions) -> Encoding | None:
    from cartwheel.bridges.recording import ENCODINGS

    if options.encoding is None:
        return None
    for known in ENCODINGS:
        if known == options.encoding:
            return known
    raise UnknownNameError("encoding", options.encoding, ENCODINGS, code=OPTION_INVALID)
