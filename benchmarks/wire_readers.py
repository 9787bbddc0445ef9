"""Subscribers of each bridge, in separate processes: they count messages and measure latency.

The stamp of each message is the wall time at which it was published. Subscribers read only the
stamp, so the transport alone is measured.

    python -m benchmarks.wire_readers WIRE ADDRESS
"""

from __future__ import annotations

import json
import selectors
import socket
import struct
import subprocess
import sys
import threading
import time
import xmlrpc.client
from collections.abc import Callable
from typing import Any

IMAGE, ODOM, TF, IMU = "/load/image", "/load/odom", "/load/tf", "/load/imu"
TYPES = {
    IMAGE: "sensor_msgs/msg/Image",
    ODOM: "nav_msgs/msg/Odometry",
    TF: "tf2_msgs/msg/TFMessage",
    IMU: "sensor_msgs/msg/Imu",
}
SENSORS: tuple[str, ...] = (IMAGE, IMU)
_STAMP_AT = {TF: 8}
"""Byte offset of the stamp: after the CDR header or ROS 1's sequence number, both of 4 bytes, and
after the number of transforms."""


class Ages:
    """The latencies of messages, in ms."""

    def __init__(self) -> None:
        self._found: dict[str, list[float]] = {topic: [] for topic in TYPES}

    def take(self, topic: str, data: bytes | bytearray | memoryview) -> None:
        """Adds the latency of a message that has just arrived."""
        now = time.time_ns()
        seconds, nanoseconds = struct.unpack_from("<II", data, _STAMP_AT.get(topic, 4))
        self._found[topic].append((now - seconds * 10**9 - nanoseconds) / 1e6)

    def answer(self) -> None:
        """For each line on standard input, prints the latencies since the previous line."""
        for _ in sys.stdin:
            print(json.dumps(self._found), flush=True)
            self._found = {topic: [] for topic in TYPES}


def _read_ros1(uri: str, take: Callable[[str, bytearray], None]) -> None:
    node = xmlrpc.client.ServerProxy(uri)
    selector = selectors.DefaultSelector()
    for topic in TYPES:
        answer: Any = node.requestTopic("/reader", topic, [["TCPROS"]])
        sock = socket.create_connection(tuple(answer[2][1:]))
        fields = [f"topic={topic}", "type=*", "md5sum=*", "callerid=/reader", "tcp_nodelay=1"]
        body = b"".join(struct.pack("<I", len(f)) + f.encode() for f in fields)
        sock.sendall(struct.pack("<I", len(body)) + body)
        (length,) = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))
        sock.recv(length, socket.MSG_WAITALL)
        selector.register(sock, selectors.EVENT_READ, (topic, bytearray()))
    while True:
        for key, _ in selector.select():
            topic, held = key.data
            held += key.fileobj.recv(1 << 20)  # type: ignore[union-attr]
            while len(held) >= 4 and len(held) >= 4 + int.from_bytes(held[:4], "little"):
                end = 4 + int.from_bytes(held[:4], "little")
                take(topic, held[4:end])
                del held[:end]


def _read_ros2(_: str, take: Callable[[str, bytes], None]) -> None:
    from cartwheel.bridges.loop import Loop
    from cartwheel.bridges.ros2.environment import discovery_range, domain_id
    from cartwheel.messages.ros2.types import ros2_type
    from rtps_lite.discovery import EndpointQos
    from rtps_lite.participant import Participant

    loop = Loop(lambda error: print(error, file=sys.stderr), name="reader")
    participant = Participant(
        loop, domain=domain_id(), reach=discovery_range(), name="reader", user_data=b"", warn=print
    )

    def begin() -> None:
        participant.start()
        for topic, kind in TYPES.items():
            participant.reader(
                f"rt{topic}",
                ros2_type(kind).dds,
                EndpointQos(reliable=topic not in SENSORS),
                lambda taken, topic=topic: take(topic, taken.payload),  # type: ignore[misc]
            )

    loop.start()
    loop.call(begin).result()
    threading.Event().wait()


def _read_zenoh(_: str, take: Callable[[str, bytes], None]) -> None:
    import zenoh

    from cartwheel.bridges.ros2.zenoh_session import PORT
    from cartwheel.messages.ros2.types import ros2_type

    configuration = zenoh.Config()
    configuration.insert_json5("mode", '"peer"')
    configuration.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{PORT}"]')
    configuration.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(configuration) as session:
        for topic, kind in TYPES.items():
            session.declare_subscriber(
                f"*{topic}/{ros2_type(kind).dds}/*",
                lambda sample, topic=topic: take(topic, sample.payload.to_bytes()),  # type: ignore[misc]
            )
        threading.Event().wait()


def _read_foxglove(url: str, take: Callable[[str, memoryview], None]) -> None:
    from websockets.sync.client import connect

    with connect(
        url,
        subprotocols=["foxglove.sdk.v1"],  # type: ignore[list-item]
        compression=None,
        max_size=None,
    ) as link:
        topics: dict[int, str] = {}
        for message in link:
            if isinstance(message, str):
                body = json.loads(message)
                if body["op"] == "advertise":
                    wanted = [one for one in body["channels"] if one["topic"] in TYPES]
                    topics.update({one["id"]: one["topic"] for one in wanted})
                    asked = [{"id": one["id"], "channelId": one["id"]} for one in wanted]
                    link.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
            elif message[0] == 1:
                (subscription,) = struct.unpack_from("<I", message, 1)
                take(topics[subscription], memoryview(message)[13:])


READERS: dict[str, Callable[[str, Any], None]] = {
    "ros1": _read_ros1,
    "ros2": _read_ros2,
    "zenoh": _read_zenoh,
    "foxglove": _read_foxglove,
}


class Reader:
    """The process of a subscriber.

    Args:
        wire: The bridge that it subscribes to.
        address: Address of the bridge, if it needs one.
    """

    def __init__(self, wire: str, address: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.wire_readers", wire, address],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def ages(self) -> dict[str, list[float]]:
        """The latency of each message since the last call, in ms, by topic."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        found: dict[str, list[float]] = json.loads(self._process.stdout.readline())
        return found

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.communicate()


if __name__ == "__main__":
    ages = Ages()
    read = READERS[sys.argv[1]]
    threading.Thread(target=read, args=(sys.argv[2], ages.take), daemon=True).start()
    ages.answer()
