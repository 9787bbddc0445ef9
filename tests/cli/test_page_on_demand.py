"""The page of a run without one, and the program that asks for it."""

import re
import signal
import socket
import sys
import time
import urllib.request

import pytest

from cartwheel.codes.command import NO_PAGE, SIMULATION_NOT_RUNNING, USAGE
from cartwheel.control import ControlClient, running


@pytest.fixture
def headless(program, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", program.environment["XDG_RUNTIME_DIR"])
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "ROS_MASTER_URI"):
        program.environment.pop(name, None)
    process = program.start("run", "--headless")
    program.wait_until_up(process)
    yield process
    process.kill()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def url_of(client) -> str:
    line = client.stdout.readline()
    found = re.search(r"http://[\d.]+:\d+", line)
    assert found, line + client.stderr.read()
    return found[0]


def test_the_page_comes_up_when_it_is_asked_for_and_once(headless):
    (entry,) = running()
    assert entry.url is None
    with ControlClient(entry) as client:
        url = client.request("page")["url"]
        assert client.request("page")["url"] == url
    with urllib.request.urlopen(url, timeout=120) as page:
        assert page.status == 200
    assert running()[0].url == url


def test_a_taken_port_is_left_to_whoever_has_it(headless):
    with socket.socket() as other:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            other.bind(("127.0.0.1", 8080))
            other.listen()
        except OSError:
            pass  # Somebody else has it, which is as good.
        with ControlClient(running()[0]) as client:
            url = client.request("page")["url"]
    assert int(url.rsplit(":", 1)[1]) != 8080
    with urllib.request.urlopen(url, timeout=120) as page:
        assert page.status == 200


def test_the_client_prints_the_address_without_a_display(program, headless):
    client = program.start("gzclient")
    url = url_of(client)
    with urllib.request.urlopen(url, timeout=120) as page:
        assert page.status == 200
    assert client.poll() is None
    headless.send_signal(signal.SIGINT)
    assert client.wait(timeout=120) == 0


def test_the_client_opens_the_browser_where_there_is_a_display(program, headless):
    opened = program.folder / "opened"
    browser = program.folder / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {opened}.part; mv {opened}.part {opened}\n')
    browser.chmod(0o755)
    program.environment.pop("SSH_CONNECTION", None)
    program.environment |= {"DISPLAY": ":99", "BROWSER": f"{browser} %s"}
    client = program.start("gzclient", "--verbose", "__name:=gazebo_gui", "__log:=/dev/null")
    url = url_of(client)
    deadline = time.monotonic() + 120
    while not opened.exists():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    assert opened.read_text().strip() == url


def test_the_client_ends_by_a_signal_and_the_simulation_goes_on(program, headless):
    client = program.start("gzclient")
    url_of(client)
    client.send_signal(signal.SIGINT)
    assert client.wait(timeout=120) == 0
    assert headless.poll() is None
    assert client.stderr.read() == ""


def test_the_client_finds_the_page_of_a_run_that_has_one_from_its_start(program):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "ROS_MASTER_URI"):
        program.environment.pop(name, None)
    process = program.start("run", "--port", str(free_port()))
    try:
        # As soon as it is known, which is before its page is up.
        program.wait_until_up(process)
        client = program.start("gzclient")
        url = url_of(client)
        with urllib.request.urlopen(url, timeout=120) as page:
            assert page.status == 200
        client.kill()
        client.communicate()
    finally:
        process.kill()
        process.communicate()


def test_a_recording_without_a_page_is_refused(program, monkeypatch):
    program.environment.pop("ROS_MASTER_URI", None)
    monkeypatch.setenv("XDG_RUNTIME_DIR", program.environment["XDG_RUNTIME_DIR"])
    program("run", "--headless", "--for", "0.2", "--record", "a.mcap")
    process = program.start("play", "a.mcap", "--headless", "--speed", "0.001")
    try:
        program.wait_until_up(process)
        assert f"[{NO_PAGE}]" in program("gzclient", status=2).stderr
    finally:
        process.kill()
        process.communicate()


BROWSER = """#!{python}
import sys
import msgspec, viser
from websockets.sync.client import connect
with connect(
    sys.argv[1].replace("http", "ws"),
    subprotocols=["viser-v" + viser.__version__], max_size=None, compression=None,
) as page:
    # A browser counts from the moment it says how large its canvas is.
    page.send(msgspec.msgpack.encode(dict(
        type="ViewerCameraMessage", wxyz=(1.0, 0.0, 0.0, 0.0), position=(-2.0, 0.0, 1.0),
        fov=0.8, near=0.01, far=1000.0, image_height=600, image_width=800,
        look_at=(0.0, 0.0, 0.0), up_direction=(0.0, 0.0, 1.0),
    )))
    for _ in page:
        pass
"""


@pytest.mark.parametrize("shows", [True, False])
def test_shown_is_said_where_a_browser_has_come(program, headless, monkeypatch, shows):
    """A program that was started may be a browser that shows nothing."""
    browser = program.folder / "browser"
    browser.write_text(BROWSER.format(python=sys.executable) if shows else "#!/bin/sh\n")
    browser.chmod(0o755)
    program.environment.pop("SSH_CONNECTION", None)
    program.environment |= {"DISPLAY": ":99", "BROWSER": f"{browser} %s &"}
    client = program.start("gzclient")
    assert client.stdout.readline().startswith("web interface:")
    if shows:
        assert "shown in the browser" in client.stdout.readline()
    headless.send_signal(signal.SIGINT)
    assert client.wait(timeout=120) == 0
    assert client.stdout.read() == ""


def test_without_a_simulation_there_is_nothing_to_show(program):
    program.environment.pop("ROS_MASTER_URI", None)
    done = program("gzclient", status=2)
    assert f"[{SIMULATION_NOT_RUNNING}]" in done.stderr


@pytest.mark.parametrize("command", ["gzserver", "gzclient", "gazebo", "debug", "perf"])
def test_help_and_version(program, command):
    assert f"usage: {command}" in program(command, "--help").stdout
    assert program(command, "-v").stdout.startswith("cartwheel ")


def test_a_wrong_option_is_refused(program):
    done = program("gzserver", "--nonsense", status=2)
    assert f"[{USAGE}]" in done.stderr
