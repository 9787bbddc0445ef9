"""Two simulations of the same robot at once: each command reaches the one that it means."""

import re
import signal
import socket
import subprocess
import time
from collections.abc import Iterator

import pytest
from tests.cli.conftest import CART_TOPIC, Program
from tests.reserved import dds_domains

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE

_PATIENCE = 60.0


@pytest.fixture
def pair(program: Program) -> Iterator[tuple[Program, int, int]]:
    """Two runs in one ROS 2 domain; the second one's time is behind."""
    program.environment["ROS_DOMAIN_ID"] = str(dds_domains())
    options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    first = program.start("run", "--headless", "--ros2", **options)
    program.wait_until_up(first)
    deadline = time.monotonic() + _PATIENCE
    while _stamps(program, first.pid, 1)[0] < 1_000_000_000:
        assert time.monotonic() < deadline
    second = program.start("run", "--headless", "--ros2", **options)
    program.wait_until_up(second)
    yield program, first.pid, second.pid
    for process in (first, second):
        process.send_signal(signal.SIGINT)
    for process in (first, second):
        assert process.wait(timeout=_PATIENCE) == 0


def _echoed(program: Program, pid: int, count: int) -> str:
    return program("topic", "echo", "/odom", "-n", str(count), "--sim", str(pid)).stdout


def _stamps(program: Program, pid: int, count: int) -> list[int]:
    """Stamps of odometry, in ns."""
    text = _echoed(program, pid, count)
    found = re.findall(r"\bsec: (\d+)\s+nanosec: (\d+)", text)
    assert len(found) == count, text
    return [int(seconds) * 10**9 + int(rest) for seconds, rest in found]


def _x(program: Program, pid: int) -> float:
    found = re.search(r"position:\s+x: (\S+)", _echoed(program, pid, 1))
    assert found is not None
    return float(found[1])


def test_two_runs_of_one_ros2_domain_stay_apart(pair: tuple[Program, int, int]) -> None:
    program, first, second = pair
    command = ("geometry_msgs/Twist", "{linear: {x: 0.5}}", "-r", "20", "--sim", str(first))
    driver = program.start("topic", "pub", CART_TOPIC, *command, stdout=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + _PATIENCE
        while _x(program, first) < 0.3:
            assert time.monotonic() < deadline
    finally:
        driver.send_signal(signal.SIGINT)
        driver.communicate(timeout=_PATIENCE)
    assert abs(_x(program, second)) < 0.01
    for pid in (first, second):
        stamps = _stamps(program, pid, 50)
        assert stamps == sorted(stamps)
    program("pause", "--sim", str(second))
    before = _stamps(program, first, 1)[0]
    assert "paused" in program("status", "--sim", str(second)).stdout
    assert _stamps(program, first, 20)[-1] > before


@pytest.fixture
def refused(program: Program) -> tuple[str, str]:
    """A port that is in use, and what a run says that is to use it for Foxglove."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        options = ("--headless", "--foxglove", "--foxglove-port", port)
        return port, program("run", "empty.world", *options, status=2).stderr


def test_a_port_of_foxglove_that_another_run_uses_is_refused(refused: tuple[str, str]) -> None:
    assert f"[{ADDRESS_UNAVAILABLE}]" in refused[1]


@pytest.mark.wording
def test_a_port_of_foxglove_that_another_run_uses_is_named(refused: tuple[str, str]) -> None:
    port, said = refused
    assert port in said and "--foxglove-port" in said
