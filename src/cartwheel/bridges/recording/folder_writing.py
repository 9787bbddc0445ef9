"""Writing ROS 2 bags as a folder: an MCAP file and rosbag2's metadata."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.mcap_writing import McapWriter
from cartwheel.bridges.recording.rosbag2_metadata import TopicCount, as_yaml, metadata


class FolderWriter:
    """Writes the folder. Each flush updates its ``metadata.yaml``.

    Args:
        path: Folder to create.
        notes: Stored in the metadata.

    Raises:
        OSError: The folder cannot be written.
    """

    def __init__(self, path: Path, *, notes: Mapping[str, str]) -> None:
        self.path = path
        path.mkdir()
        self._notes = notes
        self._file = path / f"{path.name}_0.mcap"
        self._mcap = McapWriter(self._file, "ros2", notes=notes)
        self._topics: list[TopicCount] = []
        self._write_metadata()

    @property
    def kept_ns(self) -> int:
        """Time of the last message that was passed to the operating system."""
        return self._mcap.kept_ns

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        schema = codec("ros2").schema(type_name)
        self._topics.append(TopicCount(topic, schema.name, schema.hash, latched))
        return self._mcap.add(topic, type_name, latched=latched)

    def write(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        self._mcap.write(channels, times, data)

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        self._mcap.attach(name, media_type, data, time_ns)

    def flush(self) -> None:
        self._mcap.flush()
        self._write_metadata()

    def close(self) -> None:
        self._mcap.close()
        self._write_metadata()

    def abandon(self) -> None:
        self._mcap.abandon()
        with suppress(OSError):
            self._write_metadata()

    def _write_metadata(self) -> None:
        for topic, count in zip(self._topics, self._mcap.counts, strict=True):
            topic.count = count
        about = metadata(
            self._topics,
            storage="mcap",
            file=self._file.name,
            span=self._mcap.span,
            notes=self._notes,
        )
        new = self.path / "metadata.new.yaml"
        new.write_text(as_yaml({"rosbag2_bagfile_information": about}))
        new.replace(self.path / "metadata.yaml")
