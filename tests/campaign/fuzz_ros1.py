"""What peers of the ROS 1 node send: HTTP, XML-RPC, connection headers and messages."""

from __future__ import annotations

import socket
import struct
import time
import xmlrpc.client
from collections.abc import Callable
from typing import Any

from tests.campaign import mutating
from tests.campaign.target import FaultError, Target

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros1.connection import Connection, Traffic
from cartwheel.bridges.ros1.header import HeaderError, decode_header, encode_header
from cartwheel.bridges.ros1.http import BODY_LIMIT, HEAD_LIMIT, RpcConnection
from cartwheel.bridges.ros1.marshalling import MalformedError, read_values
from cartwheel.bridges.ros1.rpc import RpcError, value_of
from cartwheel.errors import GraphError
from cartwheel.messages import zero
from cartwheel.messages.ros1 import decode_ros1, encode_ros1

_TYPES = (
    "geometry_msgs/msg/Twist",
    "trajectory_msgs/msg/JointTrajectory",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/PointCloud2",
    "tf2_msgs/msg/TFMessage",
    "control_msgs/msg/FollowJointTrajectoryActionGoal",
    "gazebo_msgs/msg/ContactsState",
    "gazebo_msgs/srv/SpawnModel_Request",
    "gazebo_msgs/srv/SetModelConfiguration_Request",
    "dynamic_reconfigure/srv/Reconfigure_Request",
    "controller_manager_msgs/srv/SwitchController_Request",
)
_ELEMENTS = 200_000


def _bodies() -> list[bytes]:
    values: list[tuple[str, tuple[Any, ...]]] = [
        ("requestTopic", ("/a", "/odom", [["TCPROS"]])),
        ("publisherUpdate", ("/a", "/cmd_vel", ["http://localhost:1/", "http://b:2/"])),
        ("shutdown", ("/a", "reason")),
        ("getBusInfo", ("/a",)),
        ("paramUpdate", ("/a", "/b", {"x": [1, 2.5, True, xmlrpc.client.Binary(b"abc")]})),
    ]
    calls = [xmlrpc.client.dumps(rest, name).encode() for name, rest in values]
    answer = xmlrpc.client.dumps(((1, "", ["TCPROS", "localhost", 5]),), methodresponse=True)
    fault = xmlrpc.client.dumps(xmlrpc.client.Fault(1, "no"), methodresponse=True)
    return [*calls, answer.encode(), fault.encode()]


def _requests() -> list[bytes]:
    made = []
    for number, body in enumerate(_bodies()):
        wish = ("keep-alive", "close", "")[number % 3]
        head = f"POST /RPC2 HTTP/1.{number % 2}\r\nHost: localhost\r\nConnection: {wish}\r\n"
        made.append(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
    return [*made, made[1] * 3, b"GET / HTTP/1.1\r\n\r\n"]


def _headers() -> list[bytes]:
    topic = {"topic": "/odom", "md5sum": "*", "type": "*", "callerid": "/a", "tcp_nodelay": "1"}
    service = {"service": "/reset", "md5sum": "*", "callerid": "/a", "persistent": "1"}
    return [encode_header(fields) for fields in (topic, service, {"error": "no"}, {})]


def _streams() -> list[bytes]:
    blocks = [struct.pack("<I", len(data)) + data for data in (b"", b"abc", b"x" * 500)]
    return [head + b"".join(blocks) for head in _headers()]


def _messages() -> list[bytes]:
    from cartwheel.messages import from_dict

    found = [bytes([i]) + encode_ros1(zero(name)) for i, name in enumerate(_TYPES)]
    point = {"positions": [0.5, 1.0], "time_from_start": {"sec": 1, "nanosec": 5}}
    full = {"joint_names": ["a", "b"], "points": [point, point]}
    return [*found, b"\1" + encode_ros1(from_dict(_TYPES[1], full))]


def _read_body(data: bytes) -> None:
    try:
        values, _ = read_values(data)
    except xmlrpc.client.Fault:
        return
    for value in values:
        try:
            value_of(value)
        except RpcError:
            continue


def _read_header(data: bytes) -> None:
    fields = decode_header(data[4:])
    if decode_header(encode_header(fields)[4:]) != fields:
        raise FaultError("a header that is read and written is another one")


def _read_message(data: bytes) -> None:
    if not data:
        return
    name = _TYPES[data[0] % len(_TYPES)]
    before = time.thread_time()
    message = decode_ros1(data[1:], name, elements=_ELEMENTS)
    if time.thread_time() - before > 2.0:
        raise FaultError("it takes too long")
    # What was read can be written, and is the same then.
    again = encode_ros1(decode_ros1(encode_ros1(message), name))
    if again != encode_ros1(message):
        raise FaultError(f"a {name} changes on its way")


class _Turns(Loop):
    """A loop that runs in the caller's thread as long as there is something to do."""

    def __init__(self) -> None:
        super().__init__(self._raise, name="fuzz")

    @staticmethod
    def _raise(error: Exception) -> None:
        raise FaultError(f"a callback raised {type(error).__name__}: {error}") from error

    def run(self) -> None:
        for _ in range(10_000):
            found = self._selector.select(0.0)
            if not found and not self._functions:
                return
            for key, events in found:
                key.data(events)
            for _ in range(len(self._functions)):
                self._functions.popleft()()
        raise FaultError("it never comes to rest")

    def shut(self) -> None:
        self._selector.close()
        self._inner.close()
        self._outer.close()


def _exchange(data: bytes, serve: Callable[[Loop, socket.socket], Callable[[], None]]) -> None:
    """Sends the data in pieces to what `serve` makes, and reads what it answers."""
    loop = _Turns()
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    check = serve(loop, theirs)
    size = max(1, len(data) // 3)
    try:
        for start in range(0, len(data), size):
            try:
                ours.send(data[start : start + size])
            except OSError:
                break
            loop.run()
            check()
            try:
                while ours.recv(1 << 16):
                    loop.run()
            except OSError:
                continue
        ours.close()
        loop.run()
    finally:
        ours.close()
        theirs.close()
        loop.shut()


def _serve_calls(loop: Loop, sock: socket.socket) -> Callable[[], None]:
    def handle(method: str, arguments: tuple[Any, ...]) -> Any:
        return 1, method, [str(each) for each in arguments]

    connection = RpcConnection(loop, sock, handle, lambda _: None)

    def check() -> None:
        if len(connection._received) > HEAD_LIMIT + BODY_LIMIT + (1 << 17):
            raise FaultError("more is kept than a request")

    return check


def _serve_streams(loop: Loop, sock: socket.socket) -> Callable[[], None]:
    traffic = Traffic()

    def later(link: Connection) -> None:
        link.hold()
        link.go_on()

    def begin(link: Connection, fields: dict[str, str]) -> None:
        if "service" in fields:
            link.on_block = lambda data: link.send(struct.pack("<I", len(data)) + data)
        elif "topic" in fields:
            link.on_block = lambda _: later(link)
        else:
            link.refuse("neither")

    connection = Connection(loop, sock, traffic, on_header=begin)

    def check() -> None:
        counted = traffic.received, traffic.queued
        if counted != (len(connection._received), connection._queued):
            raise FaultError(f"bytes are counted wrongly: {counted}")

    return check


TARGETS = (
    Target(
        name="xmlrpc",
        seeds=_bodies,
        run_one=_read_body,
        allowed=(MalformedError,),
        mutate=mutating.text,
    ),
    Target(
        name="http",
        seeds=_requests,
        run_one=lambda data: _exchange(data, _serve_calls),
        mutate=mutating.text,
    ),
    Target(name="tcpros_header", seeds=_headers, run_one=_read_header, allowed=(HeaderError,)),
    Target(name="tcpros", seeds=_streams, run_one=lambda data: _exchange(data, _serve_streams)),
    Target(name="ros1_message", seeds=_messages, run_one=_read_message, allowed=(GraphError,)),
)
