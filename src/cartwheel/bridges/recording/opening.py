"""Opening recordings of any format."""

from __future__ import annotations

from pathlib import Path

from cartwheel.bridges.recording.formats import path_error, reason_of
from cartwheel.bridges.recording.reading import Recording
from cartwheel.codes.recording import NOT_A_RECORDING, RECORDING_UNREADABLE


def open_recording(path: Path | str) -> Recording:
    """Opens a recording. Its format is detected from its content, not from its name.

    Raises:
        RecordingError: The file is not a recording, or cannot be read.
    """
    path = Path(path)
    try:
        if path.is_dir():
            from cartwheel.bridges.recording.folder_reading import open_folder

            return open_folder(path, open_recording)
        with path.open("rb") as file:
            begin = file.read(16)
        return _opened(path, begin)
    except OSError as error:
        message = f'"{path}" cannot be read: {reason_of(error)}'
        raise path_error(RECORDING_UNREADABLE, path, message) from error


def _opened(path: Path, begin: bytes) -> Recording:
    if begin.startswith(b"\x89MCAP"):
        from cartwheel.bridges.recording.mcap_reading import open_mcap

        return open_mcap(path)
    if begin.startswith(b"#ROSBAG"):
        from cartwheel.bridges.recording.bag_reading import open_bag

        return open_bag(path)
    if begin.startswith(b"SQLite format 3"):
        from cartwheel.bridges.recording.db3_reading import Db3Recording

        return Db3Recording(path)
    why = (
        "it does not start with the signature of an MCAP file or a bag" if begin else "it is empty"
    )
    packed = begin and path.suffix == ".zstd"
    hint = "The whole file is compressed. Decompress it first with unzstd." if packed else None
    raise path_error(NOT_A_RECORDING, path, f'"{path}" is not a recording: {why}', hint=hint)
