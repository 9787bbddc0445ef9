"""Records a simulation."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.cli import interrupts
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.report import Report
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.codes.recording import RECORDING_BROKE_OFF
from cartwheel.errors import CartwheelError, ControlError, RecordingError, UnknownNameError

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.recording import Encoding
    from cartwheel.bridges.recording.recorder import Summary
    from cartwheel.session import Session


def check_recording(options: Options) -> None:
    """Rejects invalid recording options before anything is built.

    Raises:
        CartwheelError: An option is invalid.
    """
    from cartwheel.bridges.recording.formats import check_writable, encoding_for

    found: set[Path] = set()
    for path in options.record:
        encoding_for(path, _encoding(options))
        check_writable(path, overwrite=options.overwrite)
        place = path.absolute()
        if place in found:
            raise RecordingError(
                f'--record specifies "{path}" twice',
                code=OPTIONS_CONFLICT,
                values={"path": str(path)},
            )
        found.add(place)


@contextlib.contextmanager
def recorded(
    session: Session, processes: Mapping[Path, BridgeProcess], options: Options, report: Report
) -> Iterator[None]:
    """Records the enclosed run, if requested; a failing recording stops the run.

    Args:
        session: The session to record.
        processes: The recorders' processes, by file.
        options: Options of the run.
        report: Prints messages for the user.

    Raises:
        RecordingError: A recording cannot be written, or failed.
    """
    with contextlib.ExitStack() as stack:
        for path, process in processes.items():
            stack.enter_context(_recorded_to(path, process, session, options, report))
        yield


@contextlib.contextmanager
def _recorded_to(
    path: Path, process: BridgeProcess, session: Session, options: Options, report: Report
) -> Iterator[None]:
    simulation = session.simulation
    process.open(
        session.graph,
        {
            "path": str(path),
            "topics": tuple(options.record_topics),
            "encoding": _encoding(options),
            "overwrite": options.overwrite,
            "notes": dict(session.notes),
        },
        time_ns=lambda: simulation.time_ns,
        echo=True,
        report=simulation.report,
        handlers={"failed": (lambda _: simulation.stop(), False)},
    )
    process.on_lost = simulation.stop
    ending = _Ending(process, path)
    # Completed even after Ctrl-C: a second of messages takes longer to write than the normal
    # shutdown timeout allows.
    with interrupts.finally_do(ending.finish):
        process.call("start")
        report.recording(path)
        try:
            yield
        finally:
            ending.finish()
            simulation.drain()
            if ending.failure is not None:
                # Raised instead of other errors, because it stopped the run.
                raise ending.failure
            found = ending.summary
            if found is not None:
                report.recorded(found.files, found.messages, found.topics, found.size)


class _Ending:
    """Finishes a recording on the first thread that calls it; other threads wait."""

    def __init__(self, process: BridgeProcess, path: Path) -> None:
        self._process = process
        self._path = path
        self._lock = threading.Lock()
        self._done = False
        self.failure: CartwheelError | None = None
        self.summary: Summary | None = None

    def finish(self) -> None:
        with self._lock:
            if self._done:
                return
            self._done = True
            self._process.leave_graph()
            try:
                # without a timeout, because the disk may be slow
                self.summary = self._process.call("close", self._process.written, timeout=None)
            except ControlError:
                self.failure = RecordingError(
                    f'the recording "{self._path}" stopped because its process was ended',
                    code=RECORDING_BROKE_OFF,
                    hint="Earlier messages can be read. Inspect the file with cartwheel info.",
                    values={"path": str(self._path)},
                )
            except CartwheelError as error:
                self.failure = error
            self._process.close()


def _encoding(options: Options) -> Encoding | None:
    from cartwheel.bridges.recording import ENCODINGS

    if options.record_encoding is None:
        return None
    for known in ENCODINGS:
        if known == options.record_encoding:
            return known
    raise UnknownNameError("encoding", options.record_encoding, ENCODINGS, code=OPTION_INVALID)
