"""A run that is recorded."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.cli import interrupts
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.report import Report
from cartwheel.errors import RecordingError, UnknownNameError

if TYPE_CHECKING:
    from cartwheel.bridges.recording import Encoding, Recorder
    from cartwheel.session import Session


def check_recording(options: Options) -> None:
    """Refuses what cannot be recorded, before anything is built.

    Raises:
        CartwheelError: That.
    """
    from cartwheel.bridges.recording.formats import check_writable, encoding_for

    found: set[Path] = set()
    for path in options.record:
        encoding_for(path, _encoding(options))
        check_writable(path, overwrite=options.overwrite)
        place = path.absolute()
        if place in found:
            raise RecordingError(f'--record names "{path}" twice')
        found.add(place)


@contextlib.contextmanager
def recorded(session: Session, options: Options, report: Report) -> Iterator[None]:
    """Records the enclosed run, if that was asked for; a recording that breaks off ends it.

    Args:
        session: To record.
        options: Of the run.
        report: Tells the user.

    Raises:
        RecordingError: One cannot be written, or broke off.
    """
    with contextlib.ExitStack() as stack:
        for path in options.record:
            stack.enter_context(_recorded_to(path, session, options, report))
        yield


@contextlib.contextmanager
def _recorded_to(path: Path, session: Session, options: Options, report: Report) -> Iterator[None]:
    from cartwheel.bridges.recording import Recorder

    simulation = session.simulation
    recorder = Recorder(
        session.graph,
        path,
        time_ns=lambda: simulation.time_ns,
        topics=options.record_topics,
        encoding=_encoding(options),
        overwrite=options.overwrite,
        notes=session.notes,
        report=simulation.report,
        on_failure=lambda _: simulation.stop(),
    )
    ending = _Ending(recorder)
    # Stays among the last rites until it is done: a second of messages takes longer to write
    # than Ctrl-C allows.
    with interrupts.finally_do(ending.finish):
        recorder.start()
        report.recording(path)
        try:
            yield
        finally:
            ending.finish()
            simulation.drain()
            if ending.failure is not None:
                # In place of whatever else ended the run: the failure did.
                raise ending.failure
            found = recorder.summary
            report.recorded(found.files, found.messages, found.topics, found.size)


class _Ending:
    """The end of a recording, on whichever thread comes first; the others wait for it."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self._lock = threading.Lock()
        self._done = False
        self.failure: RecordingError | None = None

    def finish(self) -> None:
        with self._lock:
            if self._done:
                return
            self._done = True
            try:
                self._recorder.close()
            except RecordingError as error:
                self.failure = error


def _encoding(options: Options) -> Encoding | None:
    from cartwheel.bridges.recording import ENCODINGS

    if options.record_encoding is None:
        return None
    for known in ENCODINGS:
        if known == options.record_encoding:
            return known
    raise UnknownNameError("encoding", options.record_encoding, ENCODINGS)
