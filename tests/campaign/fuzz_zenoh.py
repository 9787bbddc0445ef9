"""What others send over Zenoh: attachments of calls, keys of tokens."""

from __future__ import annotations

import struct
from typing import Any

from tests.campaign.target import FaultError, Target

from cartwheel.bridges.ros2.middleware import Served
from cartwheel.bridges.ros2.names import published
from cartwheel.bridges.ros2.zenoh import take_query
from cartwheel.errors import GraphError
from cartwheel.messages import decode_cdr, encode_cdr, zero
from cartwheel.messages.ros2.types import ros2_service

_TYPE = ros2_service("std_srvs/srv/SetBool")
_KEY = (
    "@ros2_lv/0/a1b2c3/3/14/MP/%/%robot/talker/%chatter/std_msgs::msg::dds_::String_/"
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,10:,:,:,,"
)


class Query:
    """As much of Zenoh's as is used."""

    key_expr = "0/pause"

    def __init__(self) -> None:
        self.replies: list[bytes] = []
        self.dropped = 0

    def reply(self, _key: str, _payload: bytes, *, attachment: bytes) -> None:
        self.replies.append(attachment)

    def drop(self) -> None:
        self.dropped += 1


def seeds() -> list[bytes]:
    """Attachment and request, behind the length of the first; keys."""
    stamp = struct.pack("<qqB", 41, 5, 16) + b"who asks for it."
    request = encode_cdr(zero(_TYPE.request))
    keys = (_KEY, _KEY.replace("MP", "SS"), "@ros2_lv/0/a1b2c3/0/0/NN/%/%/talker")
    return [bytes([len(stamp)]) + stamp + request, *(b"\0" + key.encode() for key in keys)]


def run_one(data: bytes) -> None:
    """Answers a call, or reads a key."""
    length = data[0] if data else 0
    if not length:
        published(data[1:].decode("utf-8", "replace"))
        return

    def answer(request: bytes, reply: Any) -> None:
        try:
            decode_cdr(request, _TYPE.request)
        except GraphError:
            return
        reply(encode_cdr(zero(_TYPE.response)))

    query = Query()
    stamp = data[1 : 1 + length]
    take_query(Served(_TYPE, answer).answer, query, data[1 + length :], stamp)
    if query.dropped > 1 or any(len(each) > len(stamp) for each in query.replies):
        raise FaultError(f"{query.dropped} ends, replies {query.replies}")


TARGETS = (Target(name="zenoh", seeds=seeds, run_one=run_one),)
