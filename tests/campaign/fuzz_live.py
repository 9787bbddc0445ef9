"""Every socket of a live run: control, page, Foxglove, ROS 1's master, node and TCPROS, RTPS.

The first byte of an input says which; the run is the same for all inputs of a worker.
"""

from __future__ import annotations

import contextlib
import json
import logging
import socket
import struct
from collections.abc import Callable, Sequence
from functools import lru_cache
from random import Random

from tests.campaign import mutating
from tests.campaign.live import HAS_MASTER, LiveRun
from tests.campaign.target import Target

_EVERY = 20
"""Inputs between two looks at time and memory."""
_QUICK_S = 0.2
"""For an answer: none is due to most inputs."""
_count = 0


@lru_cache
def _run() -> LiveRun:
    # The client's own complaints about connections that ended are none of the run's.
    logging.getLogger("websockets").setLevel(logging.CRITICAL + 1)
    return LiveRun()


def _control(run: LiveRun, data: bytes) -> None:
    with socket.socket(socket.AF_UNIX) as sock:
        sock.settimeout(10)
        sock.connect(str(run.folder / "cartwheel" / f"{run.process.pid}.sock"))
        _exchange(sock, data)


def _exchange(sock: socket.socket, data: bytes) -> None:
    """Sends, ends the sending, and takes what comes for a moment."""
    sock.sendall(data)
    sock.shutdown(socket.SHUT_WR)
    sock.settimeout(_QUICK_S)
    for _ in range(20):
        if not sock.recv(1 << 16):
            break


def _port(port: int, data: bytes) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=10) as sock:
        _exchange(sock, data)


def _page(run: LiveRun, data: bytes) -> None:
    import viser
    from websockets.sync.client import connect

    with connect(
        f"ws://127.0.0.1:{run.page}",
        subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
        max_size=None,
        open_timeout=60,
        close_timeout=_QUICK_S,
    ) as link:
        for part in data.split(_RULE):
            link.send(part)
        with contextlib.suppress(TimeoutError):
            link.recv(timeout=_QUICK_S)


def _foxglove(run: LiveRun, data: bytes) -> None:
    from websockets.sync.client import connect

    with connect(
        f"ws://127.0.0.1:{run.foxglove}",
        subprotocols=["foxglove.sdk.v1"],  # type: ignore[list-item]
        max_size=None,
        open_timeout=60,
        close_timeout=_QUICK_S,
    ) as link:
        for part in data.split(_RULE):
            text = part[:1] == b"{"
            link.send(part.decode(errors="replace") if text else part)
        with contextlib.suppress(TimeoutError):
            for _ in range(5):
                link.recv(timeout=_QUICK_S)


def _rtps(run: LiveRun, data: bytes) -> None:
    base = 7400 + 250 * run.domain
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for port in (base, base + 1, base + 10, base + 11):
            sock.sendto(data[:60_000], ("127.0.0.1", port))


@lru_cache
def _node(run: LiveRun) -> tuple[int, int]:
    """Ports of the node's XML-RPC and TCPROS servers."""
    import xmlrpc.client

    master = xmlrpc.client.ServerProxy(f"http://127.0.0.1:{run.master}")
    uri = master.lookupNode("/campaign", "/gazebo")[2]
    protocol = xmlrpc.client.ServerProxy(uri).requestTopic("/campaign", "/clock", [["TCPROS"]])[2]
    return int(uri.rstrip("/").rpartition(":")[2]), int(protocol[2])


_RULE = b"\xff--next--\xff"
"""Between two messages of an input."""
_WIRES: dict[bytes, Callable[[LiveRun, bytes], None]] = {
    b"C": _control,
    b"P": _page,
    b"F": _foxglove,
    b"D": _rtps,
    # What is no websocket at all.
    b"p": lambda run, data: _port(run.page, data),
    b"f": lambda run, data: _port(run.foxglove, data),
}
if HAS_MASTER:
    _WIRES[b"X"] = lambda run, data: _port(_node(run)[0], data)
    _WIRES[b"T"] = lambda run, data: _port(_node(run)[1], data)


def _seeds() -> list[bytes]:
    return [
        wire + seed
        for wire, seeds in {
            b"C": _control_seeds(),
            b"P": _page_seeds(),
            b"F": _foxglove_seeds(),
            b"D": _rtps_seeds(),
            b"p": [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", _UPGRADE],
            b"f": [_UPGRADE],
            b"X": _xmlrpc_seeds(),
            b"T": _tcpros_seeds(),
        }.items()
        if wire in _WIRES
        for seed in seeds
    ]


_UPGRADE = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n\x82\x84abcd\0\0\0\0"
)
_BALL = """<robot name="ball"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1"
 izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><sphere radius=".1"/></geometry>
</collision></link></robot>"""


def _control_seeds() -> list[bytes]:
    from cartwheel.control.protocol import pack

    requests = (
        ("status", {}),
        ("pause", {}),
        ("resume", {}),
        ("reset", {}),
        ("step", {"count": 3}),
        ("speed", {"speed": 2.0}),
        ("models", {}),
        ("topics", {}),
        ("services", {}),
        ("page", {}),
        ("topic", {"topic": "/odom"}),
        ("subscribe", {"topic": "/clock", "data": True, "queue": 5}),
        ("publish", {"topic": "/cmd_vel", "type": "geometry_msgs/msg/Twist", "message": {}}),
        ("call", {"service": "/gazebo/pause_physics", "request": {}}),
        ("spawn", {"file": "post.urdf", "model": "post", "x": 5.0}),
        ("delete", {"model": "post"}),
        ("models", {"text": _BALL}),
    )
    return [pack({"request": name, "parameters": values}, b"data") for name, values in requests]


def _page_seeds() -> list[bytes]:
    import msgspec

    camera = {
        "type": "ViewerCameraMessage",
        "wxyz": [1.0, 0.0, 0.0, 0.0],
        "position": [1.0, 2.0, 3.0],
        "fov": 0.8,
        "near": 0.01,
        "far": 1000.0,
        "image_height": 480,
        "image_width": 640,
        "look_at": [0.0, 0.0, 0.0],
        "up_direction": [0.0, 0.0, 1.0],
    }
    messages = (
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": 1.0}},
        {"type": "SceneNodeClickMessage", "name": "/models/rosbots", "instance_index": None},
        {"type": "FileTransferStartUpload", "source_component_uuid": "x", "transfer_uuid": "y",
         "filename": "a.urdf", "mime_type": "", "part_count": 1, "size_bytes": len(_BALL)},
        {"type": "FileTransferPart", "source_component_uuid": "x", "transfer_uuid": "y",
         "part_index": 0, "content": _BALL.encode()},
        {"type": "TransformControlsUpdateMessage", "name": "/gizmo", "owner": "",
         "wxyz": [1.0, 0.0, 0.0, 0.0], "position": [0.0, 0.0, 0.0]},
    )  # fmt: skip
    pack = msgspec.msgpack.encode
    return [pack(camera), *(pack(camera) + _RULE + pack(message) for message in messages)]


def _foxglove_seeds() -> list[bytes]:
    def op(name: str, **values: object) -> bytes:
        return json.dumps({"op": name, **values}).encode()

    channel = {"id": 1, "topic": "/cmd_vel", "encoding": "cdr", "schemaName": "geometry_msgs/Twist"}
    speed = {"name": "/cartwheel/speed", "value": 2.0, "type": "float64"}
    call = struct.pack("<BIII", 2, 1, 7, 4) + b"json{}"
    return [
        op("subscribe", subscriptions=[{"id": 1, "channelId": 1}, {"id": 2, "channelId": 5}]),
        op("unsubscribe", subscriptionIds=[1]),
        op("advertise", channels=[channel]) + _RULE + struct.pack("<BI", 1, 1) + bytes(52),
        op("unadvertise", channelIds=[1]),
        op("getParameters", parameterNames=[], id="a"),
        op("setParameters", parameters=[speed], id="b"),
        op("subscribeParameterUpdates", parameterNames=["/cartwheel/speed"]),
        op("subscribeConnectionGraph"),
        op("fetchAsset", uri="package://rosbots_description/urdf/rosbots.xacro", requestId=1),
        *(struct.pack("<BIII", 2, service, 7, 4) + b"json{}" for service in range(1, 8)),
        call + _RULE + call,
    ]


def _rtps_seeds() -> list[bytes]:
    head = b"RTPS\x02\x03\x01\x0f" + bytes(range(12))

    def sub(kind: int, body: bytes) -> bytes:
        return struct.pack("<BBH", kind, 5, len(body)) + body

    writers = bytes.fromhex("000100c7000100c2")
    locator = struct.pack("<iI", 1, 7410) + bytes(12) + b"\x7f\0\0\1"
    parameters = b"".join(
        struct.pack("<HH", number, len(value)) + value
        for number, value in (
            (0x15, b"\2\3\0\0"),
            (0x16, b"\1\x0f\0\0"),
            (0x50, bytes(range(12)) + b"\0\0\1\xc1"),
            (0x32, locator),
            (0x31, locator),
            (0x58, b"\x3f\x0c\0\0"),
            (0x02, struct.pack("<II", 20, 0)),
            (0x01, b""),
        )
    )
    data = struct.pack("<HH", 0, 16) + writers + struct.pack("<iI", 0, 1) + b"\0\3\0\0" + parameters
    heartbeat = writers + struct.pack("<iIiIi", 0, 1, 0, 5, 1)
    acknack = writers + struct.pack("<iIII", 0, 1, 32, 0xFFFFFFFF) + struct.pack("<i", 1)
    fragment = struct.pack("<HH", 0, 28) + writers
    fragment += struct.pack("<iIIHHI", 0, 1, 1, 1, 1, 1 << 26) + b"x"
    gap = writers + struct.pack("<iIiII", 0, 1, 0, 5, 32) + b"\xff" * 4
    info = struct.pack("<iI", 1, 2)
    return [
        head + sub(0x15, data),
        head + sub(0x09, info) + sub(0x07, heartbeat),
        head + sub(0x06, acknack),
        head + sub(0x16, fragment),
        head + sub(0x08, gap) + sub(0x0E, bytes(12)),
    ]


def _xmlrpc_seeds() -> list[bytes]:
    import xmlrpc.client

    calls = (
        ("requestTopic", ("/c", "/clock", [["TCPROS"]])),
        ("publisherUpdate", ("/c", "/cmd_vel", ["http://127.0.0.1:1/"])),
        ("paramUpdate", ("/c", "/a", 5)),
        ("getBusInfo", ("/c",)),
        ("getPublications", ("/c",)),
        ("getPid", ("/c",)),
    )
    found = []
    for name, arguments in calls:
        body = xmlrpc.client.dumps(arguments, name).encode()
        head = f"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: {len(body)}\r\n\r\n"
        found.append(head.encode() + body)
    return found


def _tcpros_seeds() -> list[bytes]:
    def header(**fields: str) -> bytes:
        lines = [f"{key}={value}".encode() for key, value in fields.items()]
        body = b"".join(struct.pack("<I", len(line)) + line for line in lines)
        return struct.pack("<I", len(body)) + body

    topic = {"callerid": "/c", "topic": "/clock", "type": "rosgraph_msgs/Clock", "md5sum": "*"}
    service = {"callerid": "/c", "service": "/gazebo/pause_physics", "md5sum": "*"}
    state = {**service, "service": "/gazebo/get_model_state"}
    return [
        header(**topic),
        header(**topic, tcp_nodelay="1"),
        header(**service) + struct.pack("<I", 0),
        header(**service, persistent="1") + struct.pack("<I", 0) * 3,
        header(**state) + struct.pack("<II", 8, 4) + b"ball" + struct.pack("<I", 0),
    ]


def _mutate(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """The wire stays; pieces come from inputs of the same wire."""
    same = [other[1:] for other in others if other[:1] == data[:1]]
    change = mutating.text if data[:1] in b"FX" and random.random() < 0.6 else mutating.binary
    return data[:1] + change(data[1:], same, random)


def _run_one(data: bytes) -> None:
    from websockets.exceptions import WebSocketException

    global _count
    run = _run()
    wire = _WIRES.get(data[:1])
    if wire is not None:
        with contextlib.suppress(OSError, WebSocketException):
            wire(run, data[1:])
    run.check_output()
    _count += 1
    if _count % _EVERY == 0:
        try:
            run.check()
        except Exception:
            _run.cache_clear()
            _node.cache_clear()
            run.close()
            raise


TARGETS = (
    Target(
        name="live",
        seeds=_seeds,
        run_one=_run_one,
        mutate=_mutate,
        memory_mb=None,
        seconds=30.0,
        history=_EVERY,
        share=3.0,
    ),
)
