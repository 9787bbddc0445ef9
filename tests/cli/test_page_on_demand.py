"""The page of a run without one, and the program that asks for it."""

import re
import signal
import socket
import time
import urllib.request

import pytest

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


def test_the_client_tells_the_address_where_there_is_no_display(program, headless):
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


def test_a_client_that_is_early_waits(program):
    program.environment.pop("DISPLAY", None)
    program.environment["ROS_MASTER_URI"] = "http://localhost:1"
    client = program.start("gzclient")
    assert "waiting for a simulation" in client.stderr.readline()
    simulation = program.start("run", "--headless")
    assert url_of(client)
    client.send_signal(signal.SIGTERM)
    assert client.wait(timeout=120) == 0
    simulation.kill()


def test_without_a_simulation_there_is_nothing_to_show(program):
    program.environment.pop("ROS_MASTER_URI", None)
    done = program("gzclient", status=2)
    assert "no simulation is running" in done.stderr


@pytest.mark.parametrize("command", ["gzserver", "gzclient", "gazebo", "debug", "perf"])
def test_help_and_version(program, command):
    assert f"usage: {command}" in program(command, "--help").stdout
    assert program(command, "-v").stdout.startswith("cartwheel ")


def test_a_wrong_option_is_refused(program):
    done = program("gzserver", "--nonsense", status=2)
    assert "--nonsense" in done.stderr
