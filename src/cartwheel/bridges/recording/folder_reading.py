"""Reading ROS 2 bags that are folders with one or several files."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.bridges.recording.compression import decompress
from cartwheel.bridges.recording.db3_reading import Db3Recording
from cartwheel.bridges.recording.formats import path_error
from cartwheel.bridges.recording.reading import Recorded, Recording
from cartwheel.codes.recording import NOT_A_RECORDING, RECORDING_DAMAGED, RECORDING_UNREADABLE

_MOST_METADATA = 1 << 24
"""Maximum size in bytes of ``metadata.yaml``, which contains the QoS of each topic."""


class FolderRecording(Recording):
    """Several files, read as one recording."""

    def __init__(self, files: Sequence[Recording], *, complete: bool) -> None:
        super().__init__(
            form="ROS 2 bag",
            size=sum(file.size for file in files),
            complete=complete and all(file.complete for file in files),
            notes={k: v for file in files for k, v in file.notes.items()},
            attachments={k: v for file in files for k, v in file.attachments.items()},
        )
        self._files = files
        self._numbers: list[list[int]] = []
        known: dict[tuple[str, str, str], int] = {}
        for file in files:
            numbers = []
            for topic in file.topics:
                key = (topic.name, topic.type, topic.encoding)
                if key in known:
                    self.topics[known[key]].join(topic)
                else:
                    known[key] = len(self.topics)
                    self.topics.append(topic)
                numbers.append(known[key])
            self._numbers.append(numbers)

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        return heapq.merge(
            *(
                self._of(file, numbers, start_ns, topics)
                for file, numbers in zip(self._files, self._numbers, strict=True)
            ),
            key=lambda message: message.time_ns,
        )

    def close(self) -> None:
        for file in self._files:
            file.close()

    @staticmethod
    def _of(
        file: Recording, numbers: list[int], start_ns: int, topics: Collection[int] | None
    ) -> Iterator[Recorded]:
        wanted = None if topics is None else {i for i, n in enumerate(numbers) if n in topics}
        for message in file.messages(start_ns=start_ns, topics=wanted):
            yield message._replace(number=numbers[message.number])


def open_folder(path: Path, open_file: Callable[[Path], Recording]) -> Recording:
    """Opens all files of a folder.

    Args:
        path: The folder.
        open_file: Opens a file that is not a database.

    Raises:
        RecordingError: The folder contains no recording, or a file cannot be read.
    """
    about = _metadata(path)
    stated = about.get("relative_file_paths")
    stated = stated if isinstance(stated, list) else []
    names = [Path(name).name for name in stated if isinstance(name, str)]
    # All files of a bag are in its folder. Some versions also write the folder's name, which may
    # have changed since, and a path must not lead out of the folder. So use only the last part.
    files = [path / name for name in names if name]
    for file in files:
        if not file.is_file():
            message = f'the metadata in "{path}" lists "{file.name}", which does not exist'
            raise path_error(RECORDING_UNREADABLE, path, message, file=file.name)
    files = files or sorted([*path.glob("*.mcap"), *path.glob("*.db3")])
    if not files:
        message = f'"{path}" is not a recording: it contains no .mcap or .db3 file'
        raise path_error(NOT_A_RECORDING, path, message)
    unpack: Callable[[bytes], bytes] = lambda data: data  # noqa: E731
    mode, kind = about.get("compression_mode"), about.get("compression_format", "zstd")
    if isinstance(mode, str) and mode.upper() == "MESSAGE" and isinstance(kind, str):
        unpack = lambda data: decompress(data, kind)  # noqa: E731
    opened = [
        Db3Recording(file, unpack=unpack) if file.suffix == ".db3" else open_file(file)
        for file in files
    ]
    return FolderRecording(opened, complete=bool(about))


def _metadata(path: Path) -> dict[str, Any]:
    import yaml

    file = path / "metadata.yaml"
    if not file.is_file():
        return {}
    try:
        read = yaml_text.load(yaml_text.read(file, _MOST_METADATA))
    except (yaml.YAMLError, ValueError, OSError) as error:
        what = " ".join(str(error).split())
        raise path_error(RECORDING_DAMAGED, file, f'"{file}" cannot be read: {what}') from error
    about = read.get("rosbag2_bagfile_information") if isinstance(read, dict) else None
    return about if isinstance(about, dict) else {}
