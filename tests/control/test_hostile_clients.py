"""Garbage, half-open and greedy clients do not disturb a simulation."""

import contextlib
import gc
import random
import socket
import struct
import tracemalloc

import pytest
from tests.coded import raises

from cartwheel.codes.command import CONTROL_LIMIT, CONTROL_MISMATCH
from cartwheel.control import ControlClient, protocol
from cartwheel.control.protocol import pack
from cartwheel.control.server import MAX_CLIENTS


def connect(server):
    sock = socket.socket(socket.AF_UNIX)
    sock.connect(str(server.entry.path))
    sock.settimeout(60)
    return sock


def alive(session):
    """The simulation answers, and its time goes on."""
    with ControlClient() as client:
        client.request("resume")
        before = client.request("status")["time_ns"]
        client.request("step", count=3)
        assert client.request("status")["time_ns"] > before
        client.request("resume")


def test_random_bytes(server, session):
    random.seed(1)
    for _ in range(200):
        with connect(server) as sock, contextlib.suppress(OSError):
            sock.sendall(random.randbytes(random.randrange(1, 300)))
    alive(session)


def test_frames_with_damage(server, session):
    good = pack({"request": "status"}, b"payload")
    random.seed(2)
    for _ in range(300):
        damaged = bytearray(good)
        for _ in range(random.randrange(1, 4)):
            damaged[random.randrange(len(damaged))] = random.randrange(256)
        with connect(server) as sock, contextlib.suppress(OSError):
            sock.sendall(bytes(damaged[: random.randrange(1, len(damaged) + 1)]))
    alive(session)


def test_random_requests(server, session):
    """Well-formed frames with parameters of every wrong kind are refused, one by one."""
    random.seed(3)
    names = ["status", "spawn", "delete", "topic", "publish", "call", "speed", "step", "subscribe"]
    values = [None, True, -1, 1.5, 1e308, "", "x", "/a b", [], {}, [[]], {"a": 1}, "\0", "é" * 50]
    keys = ["topic", "type", "message", "service", "request_", "file", "model", "x", "count"]
    keys += ["arguments", "queue", "data"]
    with connect(server) as sock:
        connection = protocol.Connection(sock)
        for _ in range(400):
            parameters = {key: random.choice(values) for key in random.sample(keys, 4)}
            connection.send({"parameters": parameters, "request": random.choice([*names, *values])})
            answer = connection.receive(5)
            assert set(answer.header) <= {"ok", "error", "diagnostic"}
            assert "Traceback" not in str(answer.header)
    alive(session)


def test_half_frames_and_silence_hold_up_nobody(server, session, monkeypatch):
    good = pack({"request": "status"})

    def half_frames():
        halves = [connect(server) for _ in range(10)]
        for index, sock in enumerate(halves):
            sock.sendall(good[: index + 1])
        return halves

    silent = [connect(server) for _ in range(10)]
    waiting = half_frames()
    alive(session)
    # Only while nobody else sends a frame: a busy machine may take longer than this for a good one.
    with monkeypatch.context() as patch:
        patch.setattr(protocol, "FRAME_SECONDS", 0.3)
        halves = half_frames()
        for sock in halves:
            # The frame was not finished in time: the simulation hangs up.
            assert sock.recv(1) == b""
    for sock in (*silent, *waiting, *halves):
        sock.close()
    alive(session)


@pytest.mark.parametrize("sizes", [(0xFFFFFFFF, 0), (2, 0xFFFFFFFF), (5 << 20, 5), (2, 65 << 20)])
def test_sizes_beyond_the_limits_are_refused_unread(server, session, sizes):
    with connect(server) as sock:
        sock.sendall(struct.pack(">2sBxII", b"CW", 1, *sizes))
        assert CONTROL_LIMIT.number.encode() in sock.recv(1000)
        assert sock.recv(1) == b""
    alive(session)


def test_another_version_is_said(server):
    with connect(server) as sock:
        sock.sendall(struct.pack(">2sBxII", b"CW", 2, 2, 0) + b"{}")
        assert CONTROL_MISMATCH.number.encode() in sock.recv(1000)


def test_a_promise_of_bytes_takes_no_memory(server, session):
    tracemalloc.start()
    clients = []
    for _ in range(20):
        sock = connect(server)
        sock.sendall(struct.pack(">2sBxII", b"CW", 1, 2, 60 << 20) + b"{}" + b"x" * 1000)
        clients.append(sock)
    alive(session)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20 << 20
    for sock in clients:
        sock.close()


def test_a_reader_that_stops_reading_takes_no_memory(server, session, eventually):
    """At full speed, with a queue of two hundred messages, for five thousand messages."""
    sock = connect(server)
    sock.sendall(pack({"request": "subscribe", "parameters": {"topic": "/twist"}}))
    with ControlClient() as client:

        def run_for(seconds):
            start = client.request("status")["time"]
            eventually(lambda: client.request("status")["time"] > start + seconds)

        client.request("speed", speed=None)
        # Fills the queue, and imports what the messages need.
        run_for(20)
        gc.collect()
        tracemalloc.start()
        run_for(100)
        gc.collect()
        current, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        client.request("speed", speed=1.0)
    # 5000 kept messages would take at least their 100 bytes.
    assert current < 5000 * 100
    sock.close()


def test_clients_that_never_ask_keep_nobody_out(server, session, eventually):
    with ControlClient() as first:
        first.request("status")
        crowd = [connect(server) for _ in range(2 * MAX_CLIENTS)]
        alive(session)
        # One that has asked for something is kept as long as there are others.
        first.request("status")
    for sock in crowd:
        sock.close()
    eventually(lambda: not server._clients)


def test_too_many_readers_are_sent_away_and_room_comes_back(server, session, eventually):
    ask = pack({"request": "subscribe", "parameters": {"topic": "/twist"}})
    crowd = [connect(server) for _ in range(MAX_CLIENTS)]
    for sock in crowd:
        sock.sendall(ask)
        assert sock.recv(1)
    with raises(CONTROL_LIMIT), ControlClient() as client:
        client.request("status")
    for sock in crowd:
        sock.close()
    eventually(lambda: not server._clients)
    alive(session)


def test_clients_that_never_read_are_sent_away(server, session, eventually, monkeypatch):
    """They take every place, and give it back when a send has taken too long."""
    monkeypatch.setattr(protocol, "SEND_SECONDS", 0.2)
    # More than the system holds for them.
    answers = pack({"request": "topics"}) * 5_000
    crowd = [connect(server) for _ in range(4)]
    for sock in crowd[:2]:
        sock.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            sock.send(answers)
    for sock in crowd[2:]:
        sock.sendall(pack({"request": "subscribe", "parameters": {"topic": "/twist"}}))
    eventually(lambda: [use.busy for use in server._clients.values()] == [True] * 4)
    session.simulation.post(lambda: session.simulation.set_speed(None))
    eventually(lambda: not server._clients)
    session.simulation.post(lambda: session.simulation.set_speed(1.0))
    for sock in crowd:
        sock.close()
    alive(session)


def test_disconnects_in_the_middle_of_answers(server, session, eventually):
    for _ in range(100):
        sock = connect(server)
        sock.sendall(pack({"request": "subscribe", "parameters": {"topic": "/clock"}}) * 3)
        sock.close()
    eventually(lambda: not server._clients)
    assert session.graph.topic("/clock").subscribers == ()
    alive(session)
