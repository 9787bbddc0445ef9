"""The contents of a recording."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cartwheel.bridges.recording.opening import open_recording
from cartwheel.bridges.recording.reading import Recording, span_of
from cartwheel.cli.commands.report import size_text
from cartwheel.cli.console import paint, say, say_table
from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import RECORDING_UNFINISHED
from cartwheel.errors import Diagnostic

_SINCE_1970 = 10**17
"""ns; recordings that begin later have wall-clock timestamps."""


def info(path: Path, *, as_json: bool) -> None:
    """Prints the contents of a recording in any format.

    Raises:
        RecordingError: The recording cannot be read.
    """
    recording = open_recording(path)
    try:
        if as_json:
            say(json.dumps(_described(path, recording), indent=2))
        else:
            _print(path, recording)
    finally:
        recording.close()


def _described(path: Path, recording: Recording) -> dict[str, Any]:
    first, last = span_of(recording) or (0, 0)
    return {
        "file": str(path),
        "form": recording.form,
        "complete": recording.complete,
        "size": recording.size,
        "start_ns": first,
        "end_ns": last,
        "messages": sum(topic.count for topic in recording.topics),
        "notes": dict(recording.notes),
        "attachments": dict(recording.attachments),
        "topics": [
            {
                "name": topic.name,
                "type": topic.type,
                "encoding": topic.encoding,
                "messages": topic.count,
                "rate": topic.rate,
                "latched": topic.latched,
            }
            for topic in _sorted(recording)
        ],
    }


def _print(path: Path, recording: Recording) -> None:
    encodings = {"cdr": "ROS 2 messages", "ros1": "ROS 1 messages"}
    kinds = sorted({encodings.get(t.encoding, t.encoding) for t in recording.topics})
    _line("file", f"{path}, {recording.form}{', ' + ', '.join(kinds) if kinds else ''}")
    _line("size", size_text(recording.size))
    span = span_of(recording)
    if span is not None:
        first, last = span
        began = "" if first < _SINCE_1970 else f" ({_date(first)})"
        _line(
            "time", f"{(last - first) / 1e9:.3f} s, {first / 1e9:.3f} to {last / 1e9:.3f} s{began}"
        )
    _line("messages", str(sum(topic.count for topic in recording.topics)))
    for name, size in recording.attachments.items():
        _line("attached", f"{name}, {size_text(size)}")
    if recording.notes:
        _line("metadata", ", ".join(f"{key} {value}" for key, value in recording.notes.items()))
    rows = [["topic", "type", "messages", "rate"]]
    for topic in _sorted(recording):
        rate = "latched" if topic.latched else f"{topic.rate:.4g} Hz" if topic.rate else ""
        rows.append([topic.name, topic.type.replace("/msg/", "/"), str(topic.count), rate])
    say()
    say_table(rows)
    if not recording.complete:
        print_diagnostic(unfinished("The listed messages can be read."))


def unfinished(hint: str) -> Diagnostic:
    """The warning for a recording without an end."""
    return RECORDING_UNFINISHED.diagnostic(
        "the recording is incomplete because the program that wrote it was interrupted", hint=hint
    )


def _sorted(recording: Recording) -> list[Any]:
    return sorted(recording.topics, key=lambda topic: topic.name)


def _date(time_ns: int) -> str:
    from datetime import UTC, datetime

    return datetime.fromtimestamp(time_ns / 1e9, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")


def _line(title: str, text: str) -> None:
    say(f"{paint(title.ljust(8), 'dim')} {text}")
