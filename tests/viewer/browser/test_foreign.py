"""What a real browser can do with the page: foreign sites, foreign servers, the token."""

from __future__ import annotations

import http.server
import re
import socket
import threading
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from tests.viewer.conftest import eventually, new_page

from cartwheel.description.model import WorldDescription
from cartwheel.gate.access import Access
from cartwheel.session import Session
from cartwheel.viewer import Viewer

TRY = """url => new Promise(done => {
  const link = new WebSocket(url, ["viser-v%s"]);
  link.onopen = () => done("open");
  link.onerror = () => done("refused");
})"""


class Shown:
    """An empty world with its page."""

    def __init__(self, access: Access) -> None:
        self.session = Session(WorldDescription(name="empty"))
        self.refused: list[str] = []
        self.viewer = Viewer(self.session, access=access, port=0, refused=self.refused.append)
        pacer = self.session.pacer()
        self.viewer.start(pacer)
        self._thread = threading.Thread(target=pacer.run, daemon=True)
        self._thread.start()
        self.url = self.viewer.url

    def clients(self) -> frozenset[int]:
        page = self.viewer._page
        assert page is not None
        return page.clients

    def close(self) -> None:
        self.viewer.close()
        self.session.simulation.stop()
        self._thread.join(60)


@pytest.fixture
def shown() -> Iterator[Shown]:
    made = Shown(Access.of("127.0.0.1"))
    yield made
    made.close()


class Site(http.server.BaseHTTPRequestHandler):
    """A site of somebody else's."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<html>evil</html>")

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def site() -> Iterator[str]:
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()


def test_a_foreign_site_reaches_nothing(browser, shown: Shown, site: str, tmp_path) -> None:
    import viser

    attempt = TRY % viser.__version__
    page = new_page(browser)
    page.goto(site)
    port = urlsplit(shown.url).port
    for host in ("127.0.0.1", "localhost"):
        assert page.evaluate(attempt, f"ws://{host}:{port}") == "refused"
    assert site in shown.refused
    # A frame without an origin, and a file that was saved.
    page.set_content("<iframe sandbox='allow-scripts'></iframe>")
    assert page.frames[1].evaluate(attempt, f"ws://127.0.0.1:{port}") == "refused"
    file = tmp_path / "saved.html"
    file.write_text("saved")
    page.goto(f"file://{file}")
    assert page.evaluate(attempt, f"ws://127.0.0.1:{port}") == "refused"
    # Both are "null"; only the desktop programs have the origin file://.
    assert shown.refused[1:] == ["null"]
    # The frame of a foreign site does not show the page either: it could be clicked through.
    page.goto(site)
    page.set_content(f"<iframe src='{shown.url}'></iframe>")
    eventually(lambda: page.frames[1].url.startswith("chrome-error"), what="the refusal")
    page.close()


def test_a_notebook_shows_the_page_in_a_frame(browser, shown: Shown, site: str) -> None:
    """A notebook's server has a different port, and its page may have a different host name."""
    framed = shown.viewer._access.framed(shown.url)
    for notebook in (site, site.replace("127.0.0.1", "localhost")):
        page = new_page(browser)
        page.goto(notebook)
        page.set_content(f"<iframe src='{framed}' width=900 height=600></iframe>")
        eventually(lambda page=page: page.evaluate("1") and shown.clients(), what="the browser")
        page.frames[1].get_by_text("Cartwheel").first.wait_for()
        page.close()
        eventually(lambda: not shown.clients(), what="the end")
    assert shown.refused == []


def test_a_link_cannot_lead_the_page_to_a_foreign_server(browser, shown: Shown) -> None:
    """viser's client runs the scripts of the server that the address names."""
    with socket.create_server(("127.0.0.1", 0)) as foreign:
        port = foreign.getsockname()[1]
        foreign.settimeout(0.0)
        page = new_page(browser)
        said: list[str] = []
        page.on("console", lambda message: said.append(message.text))
        tried = re.compile("Content Security Policy|websocket is not connected")
        for query in (f"websocket=ws://127.0.0.1:{port}", f"playbackPath=http://127.0.0.1:{port}/"):
            said.clear()
            page.goto(f"{shown.url}/?{query}")
            # What it says once it has tried, of files and of servers.
            eventually(
                lambda: page.evaluate("1") and any(map(tried.search, said)), what="the attempt"
            )
        page.close()
        with pytest.raises(BlockingIOError):
            foreign.accept()
    assert not shown.clients()


def test_the_address_with_the_token_opens_the_page(browser) -> None:
    shown = Shown(Access.of("0.0.0.0"))
    plain = shown.url.partition("?")[0]
    page = new_page(browser)
    answer = page.goto(plain)
    assert answer is not None and answer.status == 403
    assert "token" in page.content()
    page.goto(shown.url)
    # The token leaves the address, and the websocket has the cookie.
    page.wait_for_url(plain)
    eventually(lambda: page.evaluate("1") and shown.clients(), what="the browser")
    assert page.evaluate("document.cookie") == ""
    page.close()
    shown.close()
