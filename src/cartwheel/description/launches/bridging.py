"""Topics in the arguments of ros_gz_bridge."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.spawning import resolved

BRIDGES = frozenset({"ros_gz_bridge", "ros_ign_bridge"})
"""Packages that bridge topics of gz-sim."""
_BRIDGED = re.compile(r"(?P<topic>[^@\[\]\s]+)@(?P<type>\w+(?:/msg)?/\w+)[@\[\]][\w.]+")
"""A topic in the arguments of a bridge, with its types in ROS and in gz-sim."""
_REMAPS = frozenset({"-r", "--remap"})
"""Options of ROS before a new name, as in ``--ros-args -r old:=new``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RenamedTopic:
    """A topic of gz-sim that a bridge has under another name in ROS."""

    gz: str
    ros: str
    type: str
    """Message type in ROS, such as ``geometry_msgs/msg/Twist``."""
    file: Path
    """The launch file."""


def renamed_topics(
    words: Sequence[str], space: str, remappings: Mapping[str, str], file: Path
) -> Iterator[RenamedTopic]:
    """The topics in a bridge's arguments that have another name in ROS.

    Args:
        words: Its arguments, such as ``/a@pkg/msg/T@gz.msgs.T``, and those of ROS.
        space: Its namespace.
        remappings: New names of its topics, by their old names.
        file: The launch file.
    """
    pairs = dict(remappings)
    for flag, word in pairwise(words):
        old, sign, new = word.partition(":=")
        if flag in _REMAPS and sign and not old.startswith("__"):
            pairs[old] = new
    names = {resolved(space, old): resolved(space, new) for old, new in pairs.items()}
    for word in words:
        found = _BRIDGED.fullmatch(word)
        if found is None or UNKNOWN in word:
            continue
        topic = found["topic"]
        old = resolved(space, topic)
        new = names.get(old, old)
        if new != resolved("", topic) and re.fullmatch(r"[\w/]+", new, re.ASCII):
            yield RenamedTopic(gz=topic, ros=f"/{new}", type=found["type"], file=file)
