"""Nonsense on our ports: neither an end nor growth, and everybody else is served."""

import contextlib
import gzip
import os
import random
import select
import socket
import struct
import threading
import time
import xmlrpc.client
from pathlib import Path

import pytest
from tests.bridges.conftest import Bridge, Bridged
from tests.bridges.ros1_peers import Master, Subscriber, read_block, send_header, wait_for

from cartwheel.bridges.ros1.attempts import THREADS, Attempts
from cartwheel.bridges.ros1.connection import BLOCK
from cartwheel.bridges.ros1.http import BUSY
from cartwheel.bridges.ros1.master import MasterParameters
from cartwheel.bridges.ros1.registrar import Registrar
from cartwheel.bridges.ros1.rpc import Peer, RpcError
from cartwheel.bridges.ros1.subscription import MOST
from cartwheel.codes.wires import BRIDGE_FAULT, MALFORMED_MESSAGE, PEER_LIMIT, PEER_TYPE_MISMATCH

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


def test_malformed_data_on_the_stream_port(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    before = memory()
    generator = random.Random(1)
    for _ in range(40):
        for head in [*HEADS, generator.randbytes(generator.randint(1, 5000))]:
            with socket.create_connection(address(run), timeout=60) as sock:
                sock.sendall(head)
    serves(master)
    assert memory() - before < 20 << 20
    assert not run.reported(BRIDGE_FAULT)
    wait_for(lambda: not run.bridge._node._unknown, "their ends")


def test_malformed_data_on_the_call_port(bridge: Bridge, master: Master) -> None:
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
    assert not run.reported(BRIDGE_FAULT)


def test_connections_that_say_nothing_are_limited(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    silent = [socket.create_connection(address(run), timeout=60) for _ in range(300)]
    serves(master)
    wait_for(lambda: len(run.bridge._node._unknown) <= 100, "the limit")
    for sock in silent:
        sock.close()


def test_a_publisher_of_malformed_data_is_left(bridge: Bridge, master: Master) -> None:
    run = bridge()
    with socket.create_server(("127.0.0.1", 0)) as server:
        talker = master.python(FALSE_NODE, str(server.getsockname()[1]))
        try:
            connection, _ = server.accept()
            read_block(connection)
            send_header(connection, {"md5sum": "9f195f881246fdfa2798d1d3eebca84a"})
            connection.sendall(struct.pack("<I", 5) + b"short")
            wait_for(lambda: run.reported(MALFORMED_MESSAGE), "the report")
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
            assert read_block(sock)  # the reason: ROS 1 has no place for a code
        sock.close()
    assert master.run("rosservice", "call", "/imu/service").strip() == ""


def call(method: str, *arguments: object, head: str = "") -> bytes:
    """A request of XML-RPC."""
    body = xmlrpc.client.dumps(arguments, method).encode()
    return f"POST / HTTP/1.1\r\n{head}Content-Length: {len(body)}\r\n\r\n".encode() + body


def caller(run: Bridged) -> socket.socket:
    return socket.create_connection(("127.0.0.1", run.bridge._node.ports[0]), timeout=60)


def test_a_caller_that_reads_no_answers_holds_up_nobody(bridge: Bridge, master: Master) -> None:
    run = bridge()
    requests = memoryview(call("getPublications", "/test") * 50_000)
    sock = caller(run)
    sock.setblocking(False)
    callers = run.bridge._node._callers

    def unsent() -> list[int]:
        """Bytes that the loop could not send in a whole turn."""
        return run.bridge._loop.call(lambda: [len(one._unsent) for one in callers]).result(60)

    # So much that the buffers of neither side hold it: the node stops to read.
    while select.select([], [sock], [], 0.2)[1] or not any(left := unsent()) or left != unsent():
        with contextlib.suppress(BlockingIOError):
            requests = requests[sock.send(requests) :]
            assert requests
    before = time.monotonic()
    assert master.node("/gazebo").getPid("/test") == [1, "", os.getpid()]
    assert time.monotonic() - before < 5
    serves(master)
    (stuck,) = (one for one in callers if one._unsent)
    assert len(stuck._received) < 1 << 20
    assert len(stuck._unsent) < 1 << 16
    assert not stuck.overdue(time.monotonic() + BUSY - 5)
    assert stuck.overdue(time.monotonic() + BUSY + 1)
    sock.close()


def test_pipelined_requests_are_answered_in_turn(bridge: Bridge) -> None:
    run = bridge(robot=False)
    sock = caller(run)
    sock.sendall(call("getPid", "/a") * 50 + call("getName", "/a", head="Connection: close\r\n"))
    answer = b""
    while data := sock.recv(1 << 16):
        answer += data
    assert answer.count(b"HTTP/1.1 200 OK") == 51
    assert answer.count(f"<int>{os.getpid()}</int>".encode()) == 50
    assert b"method getName is unknown" in answer
    sock.close()


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (call("getPid", "/a", head="Origin: http://evil.example\r\n"), b"403"),
        (call("getPid", "/a", head="ORIGIN: null\r\n"), b"403"),
        (b"POST / HTTP/1.1\r\nContent-Length: 300000\r\n\r\n", b"413"),
        (b"POST / HTTP/1.1\r\nX: " + b"y" * 20_000, b"431"),
        (b"GET / HTTP/1.1\r\nContent-Length: 0\r\n\r\n", b"400"),
    ],
)
def test_requests_that_are_refused(bridge: Bridge, request_: bytes, status: bytes) -> None:
    """A page in a browser can send a POST to any port, but never without its origin."""
    run = bridge(robot=False)
    with caller(run) as sock:
        sock.sendall(request_)
        assert sock.recv(1000).startswith(b"HTTP/1.1 " + status)
        assert sock.recv(1) == b""


def test_entities_are_refused(bridge: Bridge) -> None:
    run = bridge(robot=False)
    entities = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 9))
    body = (
        f'<!DOCTYPE a [<!ENTITY e0 "aaaaaaaaaa">{entities}]><methodCall><methodName>&e8;'
        "</methodName></methodCall>"
    ).encode()
    deep = b"<methodCall>" + b"<value><array><data>" * 5000
    for hostile, reason in ((body, b"document type"), (deep, b"elements are nested")):
        with caller(run) as sock:
            head = f"POST / HTTP/1.1\r\nContent-Length: {len(hostile)}\r\n\r\n"
            sock.sendall(head.encode() + hostile)
            assert reason in sock.recv(10_000)


def test_thousands_of_publishers_take_few_threads(bridge: Bridge, master: Master) -> None:
    """Hosts that do not answer keep a subscription from none that does."""
    run = bridge()
    wait_for(lambda: "/part2_cmr/cmd_vel" in run.bridge._node.subscriptions, "the subscription")
    topic = run.bridge._node.subscriptions["/part2_cmr/cmd_vel"]
    with contextlib.ExitStack() as stack:
        # Each listens, and says nothing.
        silent = [
            stack.enter_context(socket.create_server(("127.0.0.1", 0), backlog=8))
            for _ in range(40)
        ]
        ports = [server.getsockname()[1] for server in silent]
        dead = [f"http://127.0.{i}.1:{port}/" for i in range(75) for port in ports]
        assert len(dead) == 3000
        node = master.node("/gazebo")
        threads = threading.active_count()
        assert node.publisherUpdate("/test", "/part2_cmr/cmd_vel", dead)[0] == 1
        assert len(topic._links) == MOST
        assert run.reported(PEER_LIMIT, most=MOST) == 1
        # Duplicates count once, and an update takes the place of the one before.
        assert node.publisherUpdate("/test", "/part2_cmr/cmd_vel", [*dead[:200], *dead[:200]])[0]
        assert set(topic._links) == set(dead[:200])
        assert threading.active_count() - threads <= THREADS + 1
        master_ = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        talker = master.python(FALSE_NODE, str(master_.getsockname()[1]))
        stack.callback(talker.communicate)
        stack.callback(talker.kill)
        wait_for(lambda: "/false" in str(master.state()), "the publisher")
        uri = master.api.lookupNode("/test", "/false")[2]
        node.publisherUpdate("/test", "/part2_cmr/cmd_vel", [*dead[:200], uri])
        master_.settimeout(60)
        connection, _ = master_.accept()
        connection.close()
        node.publisherUpdate("/test", "/part2_cmr/cmd_vel", [])


def test_hosts_have_their_turns() -> None:
    attempts, go, order = Attempts(), threading.Event(), list[str]()
    running = threading.Semaphore(0)

    def attempt(name: str) -> None:
        order.append(name)
        running.release()
        go.wait(60)

    for i in range(500):
        attempts.add("dead", lambda: attempt("dead"), hopeless=i % 2 == 0)
    for i in range(3):
        attempts.add(f"good {i}", lambda i=i: attempt(f"good {i}"), hopeless=False)  # type: ignore[misc]
    for _ in range(7):
        assert running.acquire(timeout=60)
    assert {"good 0", "good 1", "good 2"} <= set(order)
    assert order.count("dead") == 4
    attempts.close()
    go.set()


@pytest.mark.parametrize("way", ["slow", "long", "gzip", "endless head", "entities"])
def test_answers_have_an_end(way: str) -> None:
    """A master or node that lies, trickles or floods is left after the time of a call."""
    value = xmlrpc.client.dumps(((1, "", "x"),), methodresponse=True).encode()
    head = b"HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\n"

    def serve(sock: socket.socket) -> None:
        with sock, contextlib.suppress(OSError):
            sock.recv(1 << 16)
            if way == "slow":
                sock.sendall(head + b"Content-Length: 1000\r\n\r\n")
                while True:
                    sock.sendall(b" ")
                    time.sleep(0.05)
            if way == "endless head":
                while True:
                    sock.sendall(b"X: " + b"y" * 60_000 + b"\r\n")
            if way == "long":
                sock.sendall(head + b"Content-Length: 100000000\r\n\r\n")
                while True:
                    sock.sendall(b" " * 100_000)
            body = value
            if way == "gzip":
                body = gzip.compress(value)
                sock.sendall(head + b"Content-Encoding: gzip\r\n")
            if way == "entities":
                body = b'<!DOCTYPE a [<!ENTITY e "a">]>' + value
            sock.sendall(head + f"Content-Length: {len(body)}\r\n\r\n".encode() + body)

    with socket.create_server(("127.0.0.1", 0)) as server:

        def accept() -> None:
            with contextlib.suppress(OSError):
                while True:
                    threading.Thread(target=serve, args=server.accept()[:1], daemon=True).start()

        threading.Thread(target=accept, daemon=True).start()
        peer = Peer(f"http://127.0.0.1:{server.getsockname()[1]}", timeout=1.0, largest=1 << 20)
        began = time.monotonic()
        with pytest.raises(RpcError):
            peer.call("getPid", "/test")
        assert time.monotonic() - began < 30


def test_a_client_waits_for_its_answer_before_its_next_call(bridge: Bridge, master: Master) -> None:
    run = bridge()
    wait_for(lambda: "/imu/service" in master.state()[2], "the service")
    calls = run.bridge._node.calls
    most = 0

    def count(_: object) -> None:
        nonlocal most
        most = max(most, calls.running)

    service = run.bridge._node.services["/imu/service"]
    answer = service._answer
    service._answer = lambda request: (count(request), answer(request))[1]
    with socket.create_connection(address(run), timeout=60) as sock:
        send_header(
            sock,
            {"service": "/imu/service", "md5sum": "*", "callerid": "/test", "persistent": "1"},
        )
        read_block(sock)
        sock.sendall(struct.pack("<I", 0) * 300)
        for _ in range(300):
            assert sock.recv(1) == b"\1"
            assert read_block(sock) == b""
    assert most == 1


def test_all_connections_share_their_bounds(bridge: Bridge, master: Master) -> None:
    run = bridge()
    traffic = run.bridge._node.traffic
    traffic.received_most = 1 << 20
    topic = {"topic": "/clock", "md5sum": "*", "type": "*", "callerid": "/\x1b[2Jx"}
    with contextlib.ExitStack() as stack:
        flooding = []
        for _ in range(20):
            sock = stack.enter_context(socket.create_connection(address(run), timeout=60))
            send_header(sock, topic)
            read_block(sock)
            flooding.append(sock)
        for sock in flooding:
            with contextlib.suppress(OSError):
                # The length of a block that never ends.
                sock.sendall(struct.pack("<I", 50 << 20) + b"x" * 200_000)
        wait_for(lambda: len(traffic.connections) < 10, "the end of those beyond the bound")
        assert traffic.received <= 1 << 20
        left = list(traffic.connections)
        assert any(one.overdue(time.monotonic() + BLOCK + 1) for one in left)
        assert not any(one.overdue(time.monotonic() + BLOCK / 2) for one in left)
    wait_for(lambda: not traffic.connections, "their ends")
    assert (traffic.received, traffic.queued) == (0, 0)
    traffic.most = 3
    with contextlib.ExitStack() as stack:
        for _ in range(3):
            sock = stack.enter_context(socket.create_connection(address(run), timeout=60))
            send_header(sock, topic)
            read_block(sock)
        late = stack.enter_context(socket.create_connection(address(run), timeout=60))
        assert late.recv(1) == b""
        wait_for(lambda: run.reported(PEER_LIMIT), "the report")
    wait_for(lambda: not traffic.connections, "their ends")
    serves(master)


@pytest.mark.wording
def test_what_strangers_call_themselves_moves_no_cursor(bridge: Bridge) -> None:
    run = bridge()
    with socket.create_connection(address(run), timeout=60) as sock:
        send_header(sock, {"topic": "/odom", "md5sum": "1", "type": "a", "callerid": "/\x1b[2J"})
        assert b"has type" in read_block(sock)
    wait_for(
        lambda: run.reported(PEER_TYPE_MISMATCH, topic="/odom", type="a", md5="1"), "the report"
    )
    assert not [report for report in run.reports if "\x1b" in report.message]
    assert [report for report in run.reports if "/?[2J" in report.message]


def test_a_master_that_answers_malformed_data_takes_no_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    taken: list[str] = []
    found: list[bool] = []
    registrar = Registrar(
        master_uri="http://localhost:1",
        node="/gazebo",
        uri="http://localhost:2/",
        service_uri="rosrpc://localhost:3",
        parameters=MasterParameters(
            "http://localhost:1", node="/gazebo", outer=str, wake=lambda: None
        ),
        survey=list,
        on_publishers=lambda _topic, _uris: None,
        on_lost=lambda _: None,
        on_found=lambda: found.append(True),
        on_taken=taken.append,
        on_fault=lambda _: None,
    )
    for answer in (["http://x"] * 3, [], {"a": 1}, 5, True, b"http://x"):
        monkeypatch.setattr(registrar._peer, "call", lambda *_, answer=answer: answer)
        registrar._look()
        assert taken == []
        assert not registrar._stopped
    monkeypatch.setattr(registrar._peer, "call", lambda *_: "http://elsewhere:4/")
    registrar._look()
    assert taken == ["http://elsewhere:4/"]
