"""``metadata.yaml`` of ROS 2 bags, version 9."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.recording.qos import qos


@dataclass(slots=True)
class TopicCount:
    """A topic and its number of messages."""

    name: str
    type: str
    hash: str
    latched: bool
    count: int = 0


def metadata(
    topics: Sequence[TopicCount],
    *,
    storage: str,
    file: str,
    span: tuple[int, int] | None,
    notes: Mapping[str, str],
) -> dict[str, Any]:
    """rosbag2's metadata of a bag with one file.

    Args:
        topics: Topics with messages.
        storage: ``mcap`` or ``sqlite3``.
        file: File name.
        span: Times of the first and last message in ns.
        notes: Custom metadata.
    """
    first, last = span or (0, 0)
    count = sum(topic.count for topic in topics)
    begin = {"nanoseconds_since_epoch": first}
    duration = {"nanoseconds": last - first}
    return {
        "version": 9,
        "storage_identifier": storage,
        "relative_file_paths": [file],
        "duration": duration,
        "starting_time": begin,
        "message_count": count,
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic.name,
                    "type": topic.type,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": qos(latched=topic.latched),
                    "type_description_hash": topic.hash,
                },
                "message_count": topic.count,
            }
            for topic in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "files": [
            {
                "path": file,
                "starting_time": begin,
                "duration": duration,
                "message_count": count,
            }
        ],
        "custom_data": dict(notes) or None,
        "ros_distro": "jazzy",
    }


def as_yaml(data: Any) -> str:
    """YAML without anchors and aliases."""
    import yaml

    class Dumper(yaml.SafeDumper):
        def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
            return True

    return str(yaml.dump(data, Dumper=Dumper, sort_keys=False))
