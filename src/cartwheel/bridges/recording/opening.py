"""Opening recordings of any format."""

from __future__ import annotations

from pathlib import Path

from cartwheel.bridges.recording.reading import Recording
from cartwheel.codes.recording import NOT_A_RECORDING, RECORDING_UNREADABLE
from cartwheel.errors import RecordingError


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
        raise RecordingError(
            f'"{path}" cannot be read: {error.strerror or error}',
            code=RECORDING_UNREADABLE,
            values={"path": str(path)},
        ) from error


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
    if not begin:
        raise RecordingError(
            f'"{path}" is not a recording: it is empty',
            code=NOT_A_RECORDING,
            values={"path": str(path)},
        )
    packed = path.suffix == ".zstd"
    hint = "The whole file is compressed. Decompress it first with unzstd." if packed else None
    raise RecordingError(
        f'"{path}" is not a recording: it does not start with the signature of an MCAP file or a '
        "bag",
        code=NOT_A_RECORDING,
        hint=hint,
        values={"path": str(path)},
    )
