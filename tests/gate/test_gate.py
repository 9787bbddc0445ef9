"""Attacks on the gate over real connections: nothing of them reaches the server behind."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest
from tests.coded import raises
from tests.gate.behind import PAGE, Gated, eventually, gated, rest, status

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE, ORIGIN_INVALID
from cartwheel.gate import gate as gate_module
from cartwheel.gate.access import Access
from cartwheel.gate.listening import hidden_host
from cartwheel.options import PORT


@pytest.fixture
def local() -> Iterator[Gated]:
    with gated() as made:
        yield made


@pytest.fixture
def opened() -> Iterator[Gated]:
    """On all addresses, so that a token is needed."""
    with gated(Access.of("0.0.0.0")) as made:
        yield made


def test_a_page_of_its_own_passes(local: Gated) -> None:
    for name in ("localhost", "127.0.0.1", "[::1]", "LOCALHOST"):
        answer = local.get(host=f"{name}:{local.port}")
        assert status(answer) == 200 and answer.endswith(PAGE), name
        origin = f"http://{name.lower()}:{local.port}"
        assert status(local.get(f"Origin: {origin}", host=f"{name}:{local.port}")) == 200, name


def test_a_websocket_passes_bytes_both_ways(local: Gated) -> None:
    data = bytes(range(256)) * 40_000
    with local.connect() as sock:
        # What comes with the handshake waits until the server behind has agreed.
        sock.sendall(local.handshake() + b"early")
        sender = threading.Thread(target=sock.sendall, args=(data,))
        sender.start()
        found = bytearray()
        while b"\r\n\r\n" not in found:
            found += sock.recv(65536)
        head, _, echo = bytes(found).partition(b"\r\n\r\n")
        assert status(head) == 101 and b"sec-websocket-accept" in head.lower()
        while len(echo) < len(data) + 5:
            piece = sock.recv(1 << 20)
            assert piece
            echo += piece
        sender.join()
        assert echo == b"early" + data
        sock.shutdown(socket.SHUT_WR)
        assert rest(sock) == b""


@pytest.mark.parametrize("kind", ["page", "websocket"])
@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "http://localhost.evil.example:{port}", "http://localhost:1",
     "https://localhost", "file://", "http://127.0.0.1:{port}@evil.example", "",
     "http://localhost:{port} http://evil.example", "chrome-extension://abc"],
)  # fmt: skip
def test_a_foreign_origin_is_refused(local: Gated, kind: str, origin: str) -> None:
    origin = origin.format(port=local.port)
    make = local.head if kind == "page" else local.handshake
    answer = local.ask(make(f"Origin: {origin}"))
    assert status(answer) == 403
    assert (b"allow_origin=" in answer) == (origin not in ("null", ""))
    assert local.behind.heard == []
    assert local.refused == [origin.lower()]


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{port}", "localhost.evil.example", "evil.example.:{port}",
     "192.168.0.7:{port}", "0.0.0.0:{port}", "localhost:{port}@evil.example", "127.0.0.1.nip.io",
     "[::ffff:8.8.8.8]", "2130706433", "localhost:80:80", ""],
)  # fmt: skip
def test_a_rebound_name_is_refused(local: Gated, host: str) -> None:
    host = host.format(port=local.port)
    head = local.handshake().replace(f"localhost:{local.port}".encode(), host.encode())
    for origin in ("", f"Origin: http://{host}\r\n"):
        answer = local.ask(head.replace(b"\r\n\r\n", f"\r\n{origin}\r\n".encode()))
        assert status(answer) == 403, answer
    assert local.behind.heard == []


MALFORMED = {
    "an address in full": b"GET http://localhost:{port}/ HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "a tunnel": b"CONNECT localhost:{port} HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "no server named": b"GET / HTTP/1.1\r\n\r\n",
    "two servers": b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n",
    "two servers, one folded": b"GET / HTTP/1.1\r\nHost: localhost\r\n Host: evil\r\n\r\n",
    "two origins": b"GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n"
    b"Origin: http://evil.example\r\n\r\n",
    "two lengths": b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n"
    b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
    "a body": b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nGET /",
    "a strange coding": b"GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: xchunked\r\n\r\n",
    "a space in a name": b"GET / HTTP/1.1\r\nHost : evil.example\r\nHost: localhost\r\n\r\n",
    "a zero byte": b"GET / HTTP/1.1\r\nHost: localhost\x00.evil.example\r\n\r\n",
    "another method": b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "noise": bytes(range(256)) + b"\r\n\r\n",
    "TLS": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(600) + b"\r\n\r\n",
    "a head of one packet": b"GET / HTTP/1.1\r\nHost: localhost\r\nX: "
    + b"x" * 20_000
    + b"\r\n\r\n",
    "a later version": b"GET / HTTP/2.0\r\nHost: localhost\r\n\r\n",
    "a bomb of one header": b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"x" * 9_000_000,
    "a bomb of many": b"GET / HTTP/1.1\r\nHost: localhost\r\n" + b"X: y\r\n" * 1_000_000,
}


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_request_is_answered_and_goes_no_further(local: Gated, name: str) -> None:
    request = MALFORMED[name].replace(b"{port}", str(local.port).encode())
    with local.connect() as sock:
        try:
            sock.sendall(request)
        except OSError:
            # It need not read a bomb to its end.
            assert name.startswith("a bomb")
        answer = rest(sock)
    if answer or not name.startswith("a bomb"):
        assert status(answer) in (400, 403, 405, 431, 501, 505), answer
    assert local.behind.heard == []
    assert status(local.get()) == 200


def test_a_second_request_on_a_connection_is_not_read(local: Gated) -> None:
    second = b"GET /second HTTP/1.1\r\nHost: evil.example\r\n\r\n"
    answer = local.ask(local.head() + second)
    assert answer.count(b"HTTP/1.1") == 1 and b"connection: close" in answer.lower()
    assert local.behind.heard and b"second" not in local.behind.heard[0]


def test_what_follows_a_refused_handshake_is_not_sent_on() -> None:
    """Else it would be a request of its own to a server that keeps the connection."""
    with gated(agrees=False) as made:
        answer = made.ask(made.handshake() + b"GET /second HTTP/1.1\r\nHost: evil\r\n\r\n")
        assert status(answer) == 200
        assert b"second" not in made.behind.heard[0]


def test_what_a_server_need_not_know_stays_here(local: Gated) -> None:
    local.get("X-Forwarded-For: 1.2.3.4", "Cookie: a=b", "Upgrade: h2c", "Connection: Upgrade")
    heard = bytes(local.behind.heard[0]).lower()
    for name in (b"x-forwarded", b"cookie", b"upgrade"):
        assert name not in heard


def test_what_a_browser_may_do_with_the_page_is_said(local: Gated) -> None:
    """viser's client connects to any server that a link names, and runs its scripts."""
    head = local.get().partition(b"\r\n\r\n")[0].decode().lower()
    assert f"connect-src 'self' ws://localhost:{local.port} " in head
    assert "frame-ancestors 'self'" in head
    assert "own=1" not in head


def test_only_who_knows_the_key_may_show_the_page_in_a_frame(local: Gated) -> None:
    def policy(target: str) -> str:
        return local.get(target=target).partition(b"\r\n\r\n")[0].decode()

    for guess in ("/", "/?frame=", "/?frame=None"):
        assert "frame-ancestors 'self'" in policy(guess)
    framed = local.access.framed(local.access.url("http", local.port))
    assert framed is not None
    target = framed.partition(str(local.port))[2]
    assert "frame-ancestors" not in policy(target) and "connect-src 'self'" in policy(target)
    assert "frame-ancestors 'self'" in policy(target[:-1])
    # Nobody else needs to know it.
    key = target.partition("=")[2].encode()
    assert len(key) >= 32 and not any(key in heard for heard in local.behind.heard)
    origin = "Origin: http://evil.example"
    assert status(local.ask(local.handshake(origin, target=target))) == 403


def test_a_page_that_needs_a_token_has_no_address_for_frames(opened: Gated) -> None:
    assert opened.access.framed(opened.access.url("http", opened.port)) is None


# -- tokens


def test_on_loopback_no_token_is_needed(local: Gated) -> None:
    assert local.access.token is None
    assert local.access.url("http", 8080) == "http://127.0.0.1:8080"


def test_elsewhere_a_token_is_needed(opened: Gated) -> None:
    token = opened.access.token
    assert token is not None and len(token) >= 32
    assert Access.of("0.0.0.0").token != token
    wrong = [token[:-1], f"{token}x", token.swapcase(), ""]
    for request in (opened.head, opened.handshake):
        for target in ("/", *(f"/?token={each}" for each in wrong)):
            answer = opened.ask(request(target=target))
            assert status(answer) == 403 and b"token" in answer, target
        for each in wrong:
            answer = opened.ask(request(f"Cookie: cartwheel-{opened.port}={each}"))
            assert status(answer) == 403
    assert opened.behind.heard == []
    with opened.connect() as sock:
        sock.sendall(opened.handshake(target=f"/?token={token}&a=b"))
        assert b"101" in sock.recv(4096)
    # Nobody else needs to know it.
    assert token.encode() not in opened.behind.heard[0] and b"/?a=b" in opened.behind.heard[0]


def test_a_token_does_not_make_a_foreign_page_welcome(opened: Gated) -> None:
    target = f"/?token={opened.access.token}"
    assert status(opened.ask(opened.handshake("Origin: http://evil.example", target=target))) == 403
    assert status(opened.ask(opened.handshake(host="evil.example", target=target))) == 403
    assert opened.behind.heard == []


def test_a_browser_keeps_the_token_as_a_cookie(opened: Gated) -> None:
    answer = opened.get(target=f"/?token={opened.access.token}").decode()
    assert status(answer.encode()) == 200 and "url=/" in answer
    line = next(line for line in answer.split("\r\n") if line.lower().startswith("set-cookie"))
    assert "HttpOnly" in line and "SameSite=Strict" in line and "Path=/" in line
    assert opened.behind.heard == []
    cookie = line.partition(": ")[2].partition(";")[0]
    assert opened.get(f"Cookie: other=1; {cookie}").endswith(PAGE)
    with opened.connect() as sock:
        sock.sendall(
            opened.handshake(f"Cookie: {cookie}", f"Origin: http://localhost:{opened.port}")
        )
        assert b"101" in sock.recv(4096)


def test_behind_a_token_addresses_and_own_names_pass(opened: Gated) -> None:
    target = f"/?token={opened.access.token}"
    for host in ("192.168.0.7", "[fe80::1]", socket.gethostname()):
        assert status(opened.get(target=target, host=f"{host}:{opened.port}")) == 200, host


# -- what the user allows


def test_an_allowed_origin_passes_and_so_does_its_name() -> None:
    access = Access.of("127.0.0.1", ["https://Robots.example.org:443/", "http://lab:9000"])
    with gated(access) as made:
        assert status(made.get("Origin: https://robots.example.org")) == 200
        assert status(made.get("Origin: http://lab:9000")) == 200
        assert status(made.get(host="robots.example.org")) == 200
        assert status(made.get("Origin: http://robots.example.org")) == 403
        assert status(made.get("Origin: http://lab")) == 403
        assert status(made.get(host="example.org")) == 403


@pytest.mark.parametrize(
    "origin", ["null", "*", "example.org", "http://", "https://a/b", "a b", ""]
)
def test_an_origin_that_is_malformed_is_refused(origin: str) -> None:
    with raises(ORIGIN_INVALID):
        Access.of("127.0.0.1", [origin])


def test_programs_pass_only_where_they_are_named(local: Gated) -> None:
    with gated(apps=("https://app.example", "file://")) as made:
        assert status(made.get("Origin: https://app.example")) == 200
        assert status(made.get("Origin: file://")) == 200
        assert status(made.get("Origin: null")) == 403
    assert status(local.get("Origin: https://app.example")) == 403


# -- bounds


def test_who_sends_no_request_is_sent_away(monkeypatch: pytest.MonkeyPatch, local: Gated) -> None:
    monkeypatch.setattr(gate_module, "_HEAD_SECONDS", 0.3)
    with local.connect() as silent, local.connect() as slow:
        stop = threading.Event()

        def drip() -> None:
            slow.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n")
            while not stop.wait(0.05):
                try:
                    slow.sendall(b"X: y\r\n")
                except OSError:
                    return

        thread = threading.Thread(target=drip)
        thread.start()
        assert rest(silent) == b"" and rest(slow) == b""
        stop.set()
        thread.join()
    assert local.behind.heard == []


def test_the_silent_make_room_for_others(monkeypatch: pytest.MonkeyPatch, local: Gated) -> None:
    monkeypatch.setattr(gate_module, "_HEAD_SECONDS", 1000.0)
    idle = [local.connect() for _ in range(3 * gate_module.MOST_WAITING)]
    assert status(local.get()) == 200
    # The oldest have gone; as many as may wait are still there.
    assert rest(idle[0]) == b""
    for sock in idle:
        sock.close()


def test_connections_have_a_number(monkeypatch: pytest.MonkeyPatch, local: Gated) -> None:
    monkeypatch.setattr(gate_module, "MOST_ADMITTED", 3)
    held = []
    for _ in range(3):
        sock = local.connect()
        sock.sendall(local.handshake())
        assert b"101" in sock.recv(4096)
        held.append(sock)
    assert status(local.get()) == 503
    held.pop().close()
    eventually(lambda: status(local.get()) == 200, "room")
    for sock in held:
        sock.close()


def test_a_reader_that_reads_nothing_holds_up_the_sender() -> None:
    """What is not taken stays with the server behind, which knows what may be dropped."""
    host = hidden_host()
    server = socket.create_server((host, 0))
    listener = socket.create_server(("127.0.0.1", 0))
    listener.setblocking(False)
    port = listener.getsockname()[1]
    gate = gate_module.Gate(listener, Access.of("127.0.0.1"), server.getsockname())
    gate.start()
    with socket.create_connection(("127.0.0.1", port), timeout=60) as client:
        client.sendall(
            f"GET / HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: a\r\n\r\n".encode()
        )
        inner, _ = server.accept()
        with inner:
            inner.recv(65536)
            inner.sendall(
                b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                b"Connection: Upgrade\r\n\r\n"
            )
            inner.settimeout(1.0)
            sent = 0
            with pytest.raises(TimeoutError):
                while sent < 1 << 30:
                    sent += inner.send(bytes(1 << 20))
            # Buffers of the system's, and no other.
            assert sent < 40 << 20
    gate.close()
    server.close()


def test_origins_that_are_refused_are_reported_once_and_not_for_ever(local: Gated) -> None:
    for number in range(60):
        local.get(f"Origin: http://evil-{number // 2}.example")
    assert local.refused == [f"http://evil-{number}.example" for number in range(20)]
    assert len(local.refused) == len(set(local.refused))


def test_an_origin_that_is_no_text_for_a_terminal() -> None:
    with gated() as made:
        made.get("Origin: http://\xe9\x9b" + "x" * 3000)
        assert len(made.refused) == 1
        assert made.refused[0].isascii() and made.refused[0].isprintable()
        assert len(made.refused[0]) <= 100


def test_a_closed_gate_leaves_nothing_open(local: Gated) -> None:
    sock = local.connect()
    sock.sendall(local.handshake())
    assert b"101" in sock.recv(4096)
    local.gate.close()
    assert rest(sock) == b""
    with pytest.raises(OSError, match="refused"):
        local.connect()


def test_a_taken_port_is_an_error_with_the_option() -> None:
    from cartwheel.gate.listening import listen

    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with raises(ADDRESS_UNAVAILABLE, server="the page", port=port):
            listen("127.0.0.1", port, title="the page", option=PORT)


def test_servers_behind_cannot_be_guessed() -> None:
    found = {hidden_host() for _ in range(50)}
    assert len(found) > 45
    assert all(each.startswith("127.") and each != "127.0.0.1" for each in found)
