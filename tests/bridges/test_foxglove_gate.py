"""Which programs and web pages reach Foxglove's server."""

from __future__ import annotations

import pytest
from tests.bridges.test_foxglove import serving
from tests.coded import coded
from websockets.exceptions import ConnectionClosedOK, InvalidStatus
from websockets.sync.client import connect

from cartwheel.bridges.foxglove.bridge import APPS
from cartwheel.codes.wires import PAGE_REFUSED
from cartwheel.gate.access import Access

PROTOCOL = "foxglove.sdk.v1"


def greeting(url: str, **options: object) -> str:
    """What the server says first."""
    with connect(url, subprotocols=[PROTOCOL], open_timeout=60, **options) as link:
        return str(link.recv(timeout=60))


def test_its_own_programs_pass_and_foreign_pages_do_not() -> None:
    with serving() as served:
        url = served.bridge.url
        for origin in (None, *APPS, url.replace("ws", "http")):
            assert "serverInfo" in greeting(url, origin=origin), origin
        for origin in ("http://evil.example", "null", "https://app.foxglove.dev.evil.example",
                       "http://app.foxglove.dev", "http://localhost:8080"):  # fmt: skip
            with pytest.raises(InvalidStatus) as caught:
                greeting(url, origin=origin)
            assert caught.value.response.status_code == 403
        with pytest.raises(InvalidStatus):
            greeting(url, additional_headers={"Host": "evil.example"})
        assert coded(served.reports, PAGE_REFUSED, origin="http://evil.example")


def test_elsewhere_it_wants_the_token_in_its_address() -> None:
    access = Access.of("0.0.0.0", ["http://lab"])
    with serving(access=access) as served:
        port = served.bridge.port
        assert served.bridge.url == f"ws://127.0.0.1:{port}/?token={access.token}"
        for origin in (None, *APPS, "http://lab"):
            assert "serverInfo" in greeting(served.bridge.url, origin=origin)
        for target in ("", "/?token=", f"/?token={'x' * 32}"):
            with pytest.raises(InvalidStatus) as caught:
                greeting(f"ws://127.0.0.1:{port}{target}")
            assert caught.value.response.status_code == 403
        with pytest.raises(InvalidStatus):
            greeting(served.bridge.url, origin="http://evil.example")


def test_the_end_of_a_run_says_farewell_through_the_gate() -> None:
    with serving() as served:
        link = connect(served.bridge.url, subprotocols=[PROTOCOL], open_timeout=60)
        link.recv(timeout=60)
    with pytest.raises(ConnectionClosedOK):
        while True:
            link.recv(timeout=60)
