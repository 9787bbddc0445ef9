"""Nonsense on our ports: neither an end nor growth, and everybody else is served."""

import os
import random
import socket
import struct
from pathlib import Path

import pytest
from tests.bridges.conftest import Bridge, Bridged
from tests.bridges.ros1_peers import Master, Subscriber, read_block, send_header, wait_for

pytestmark = pytest.mark.timeout(300)

HEADS = [
    b"",
    b"\0",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f" + b"a" * 100,
    struct.pack("<I", 100) + b"half a header",
    struct.pack("<II", 8, 0xFFFFFFFF) + b"abcd",
    struct.pack("<II", 8, 4) + b"abcd",
    struct.pack("<II", 16, 12) + b"topic=/clock",
    b"GET / HTTP/1.1\r\n\r\n",
]
CALLS = [
    b"\0" * 100,
    b"GET / HTTP/1.1\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 900000000\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 7\r\n\r\n<a><b/>",
    b"POST / HTTP/1.1\r\n" + b"X: y\r\n" * 5000,
    b"POST / HTTP/1.1\r\nContent-Length: 300\r\n\r\nhalf",
]
METHODS = [
    ("requestTopic", ("/x",)),
    ("requestTopic", ("/x", 5, 6)),
    ("requestTopic", ("/x", "/clock", [["UDPROS", 1]])),
    ("publisherUpdate", ("/x", "/part2_cmr/cmd_vel", ["nonsense", "http://127.0.0.1:1/"])),
    ("publisherUpdate", ("/x", "/part2_cmr/cmd_vel", 7)),
    ("getNothing", ()),
    ("system.listMethods", ()),
]


def address(run: Bridged) -> tuple[str, int]:
    return "127.0.0.1", run.bridge._node._streams.port


def memory() -> int:
    """Bytes that this process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def serves(master: Master) -> None:
    subscriber = Subscriber(master, "/clock")
    assert len(subscriber.read()) == 8
    subscriber.close()


def test_nonsense_on_the_stream_port(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    before = memory()
    generator = random.Random(1)
    for _ in range(40):
        for head in [*HEADS, generator.randbytes(generator.randint(1, 5000))]:
            with socket.create_connection(address(run), timeout=60) as sock:
                sock.sendall(head)
    serves(master)
    assert memory() - before < 20 << 20
    assert not run.told("a fault of the bridge")
    wait_for(lambda: not run.bridge._node._unknown, "their ends")


def test_nonsense_on_the_call_port(bridge: Bridge, master: Master) -> None:
    run = bridge()
    before = memory()
    port = int(run.bridge.uri.rsplit(":", 1)[1].strip("/"))
    generator = random.Random(2)
    for _ in range(20):
        for call in [*CALLS, generator.randbytes(generator.randint(1, 5000))]:
            with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
                sock.sendall(call)
    node = master.node("/gazebo")
    for method, arguments in METHODS:
        try:
            answer = getattr(node, method)(*arguments)
        except Exception as fault:  # noqa: BLE001 - a fault is an answer too
            assert type(fault).__name__ == "Fault"
        else:
            assert answer[0] in (0, 1)
    assert node.getPid("/test") == [1, "", os.getpid()]
    serves(master)
    assert memory() - before < 20 << 20
    assert not run.told("a fault of the bridge")


def test_connections_that_say_nothing_are_limited(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    silent = [socket.create_connection(address(run), timeout=60) for _ in range(300)]
    serves(master)
    wait_for(lambda: len(run.bridge._node._unknown) <= 100, "the limit")
    for sock in silent:
        sock.close()


def test_a_publisher_of_nonsense_is_left(bridge: Bridge, master: Master) -> None:
    run = bridge()
    with socket.create_server(("127.0.0.1", 0)) as server:
        talker = master.python(FALSE_NODE, str(server.getsockname()[1]))
        try:
            connection, _ = server.accept()
            read_block(connection)
            send_header(connection, {"md5sum": "9f195f881246fdfa2798d1d3eebca84a"})
            connection.sendall(struct.pack("<I", 5) + b"short")
            wait_for(lambda: run.told("sends nonsense"), "the report")
            connection.settimeout(60)
            assert connection.recv(1) == b""
            connection.close()
        finally:
            talker.kill()
            talker.communicate()
    serves(master)


FALSE_NODE = """
import sys, os, xmlrpc.client
from xmlrpc.server import SimpleXMLRPCServer
server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
port = int(sys.argv[1])
server.register_function(
    lambda caller, topic, protocols: [1, "", ["TCPROS", "127.0.0.1", port]], "requestTopic"
)
master = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])
uri = "http://127.0.0.1:%d/" % server.server_address[1]
master.registerPublisher("/false", "/part2_cmr/cmd_vel", "geometry_msgs/Twist", uri)
server.serve_forever()
"""


def test_half_requests_of_services_are_survived(bridge: Bridge, master: Master) -> None:
    run = bridge()
    wait_for(lambda: "/imu/service" in master.state()[2], "the service")
    for tail in (b"", b"\xff\xff\xff\xff", struct.pack("<I", 3) + b"abc"):
        sock = socket.create_connection(address(run), timeout=60)
        send_header(sock, {"service": "/imu/service", "md5sum": "*", "callerid": "/test"})
        read_block(sock)
        sock.sendall(tail)
        if tail.endswith(b"abc"):
            # An Empty request has no bytes.
            assert sock.recv(1) == b"\0"
            assert b"too many" in read_block(sock)
        sock.close()
    assert master.run("rosservice", "call", "/imu/service").strip() == ""
