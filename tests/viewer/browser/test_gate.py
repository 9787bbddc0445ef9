"""Who reaches the page's server, and what a foreign web page cannot do."""

from __future__ import annotations

import contextlib
import socket
import subprocess
from pathlib import Path

import pytest
from tests.viewer.browsing import Browser, browsing
from tests.viewer.running import Running, running
from websockets.exceptions import InvalidStatus

from cartwheel.codes.wires import PAGE_REFUSED
from cartwheel.control.registry import running as registered

BALL = b"""<robot name="ball"><link name="ball">
  <inertial><mass value="1"/>
    <inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision>
</link></robot>"""


@pytest.fixture
def simulation(tmp_path: Path):
    with running(tmp_path) as started:
        yield started


def upload(browser: Browser) -> None:
    """What "Open a file" sends."""
    browser.look()
    button = browser.control("Open a file")
    transfer = {"source_component_uuid": button, "transfer_uuid": "x"}
    browser.send(
        {"type": "FileTransferStartUpload", **transfer, "filename": "ball.urdf", "mime_type": "",
         "part_count": 1, "size_bytes": len(BALL)}
    )  # fmt: skip
    browser.send({"type": "FileTransferPart", **transfer, "part_index": 0, "content": BALL})
    browser.hear(lambda m: "Notification" in m["type"] and "was added to the world" in str(m))


def test_a_foreign_page_cannot_upload_a_file(simulation: Running) -> None:
    port = simulation.port
    for options in (
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"origin": f"http://127.0.0.1:{port + 1}"},
        {"additional_headers": {"Host": f"evil.example:{port}"}},
    ):
        with pytest.raises(InvalidStatus) as caught, browsing(port, **options) as browser:
            upload(browser)
        assert caught.value.response.status_code in (400, 403)
    # The page itself can, and so can a program that is no browser.
    for options in ({"origin": f"http://127.0.0.1:{port}"}, {}):
        with browsing(port, **options) as browser:
            upload(browser)
    simulation.process.terminate()
    out, _ = simulation.process.communicate(timeout=60)
    assert out.count(f"[{PAGE_REFUSED}]") == 3


@pytest.mark.wording
def test_a_foreign_page_is_named_with_the_option_that_allows_it(simulation: Running) -> None:
    with pytest.raises(InvalidStatus), browsing(simulation.port, origin="http://evil.example"):
        pass
    simulation.process.terminate()
    out, _ = simulation.process.communicate(timeout=60)
    assert "the web interface rejected a web page from the origin http://evil.example" in out
    assert "--allow-origin http://evil.example" in out


def listening(process: subprocess.Popen[str]) -> list[tuple[str, int]]:
    """Addresses on which a process listens by TCP."""
    files = {
        entry.readlink().name.removeprefix("socket:[").removesuffix("]")
        for entry in Path(f"/proc/{process.pid}/fd").iterdir()
        if entry.readlink().name.startswith("socket:")
    }
    found = []
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
        fields = line.split()
        if fields[3] == "0A" and fields[9] in files:
            host, port = fields[1].split(":")
            found.append((socket.inet_ntoa(bytes.fromhex(host)[::-1]), int(port, 16)))
    return found


def test_the_server_behind_is_not_where_web_pages_look(simulation: Running) -> None:
    with browsing(simulation.port) as browser:
        browser.look()
        found = listening(simulation.process)
    assert ("127.0.0.1", simulation.port) in found
    hidden = [each for each in found if each != ("127.0.0.1", simulation.port)]
    assert len(hidden) == 1
    host, port = hidden[0]
    assert host.startswith("127.") and host != "127.0.0.1"
    with contextlib.closing(socket.socket()) as sock:
        assert sock.connect_ex(("127.0.0.1", port)) != 0


def test_on_all_addresses_the_page_wants_its_token(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with running(tmp_path, "--host", "0.0.0.0", "--allow-origin", "http://lab") as started:
        port = started.port
        assert started.process.stdout is not None
        reported = started.process.stdout.readline()
        assert f"open to other computers with the token: http://{socket.gethostname()}:" in reported
        monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
        (entry,) = registered()
        assert entry.port == port and entry.url is not None
        _, _, token = entry.url.partition("?token=")
        assert len(token) == 32
        with pytest.raises(InvalidStatus), browsing(port):
            pass
        cookie = {"Cookie": f"cartwheel-{port}={token}"}
        for origin in (None, f"http://127.0.0.1:{port}", "http://lab"):
            with browsing(port, additional_headers=cookie, origin=origin) as browser:
                upload(browser)
