"""Runs the real program, in a folder of sockets of its own."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from tests import launching

PROGRAM = Path(sys.executable).with_name("cartwheel")
CART_TOPIC = "/part2_cmr/cmd_vel"


@dataclass
class Program:
    """The command line, as a user has it."""

    environment: dict[str, str]
    folder: Path
    started: list[subprocess.Popen[str]] = field(default_factory=list)

    def __call__(
        self, *arguments: str | Path, stdin: str = "", timeout: float = 200, status: int | None = 0
    ) -> subprocess.CompletedProcess[str]:
        """Runs a command to its end and expects its status."""
        done = launching.run(
            [PROGRAM, *map(str, arguments)],
            input=stdin,
            capture_output=True,
            text=True,
            timeout=timeout,
            env=self.environment,
            cwd=self.folder,
            check=False,
        )
        assert "Traceback" not in done.stderr + done.stdout, done.stderr
        if status is not None:
            assert done.returncode == status, f"{done.stdout}\n{done.stderr}"
        return done

    def start(self, *arguments: str | Path, **options: object) -> subprocess.Popen[str]:
        """Starts a command and leaves it running."""
        process = launching.Popen(
            [PROGRAM, *map(str, arguments)],
            stdin=options.pop("stdin", subprocess.DEVNULL),
            stdout=options.pop("stdout", subprocess.PIPE),
            stderr=options.pop("stderr", subprocess.PIPE),
            text=True,
            env=self.environment,
            cwd=self.folder,
            **options,
        )
        self.started.append(process)
        return process

    def close(self) -> None:
        """Kills what a test that failed left running."""
        for process in self.started:
            if process.poll() is None:
                process.kill()
                process.wait()

    def wait_until_up(self, process: subprocess.Popen[str]) -> None:
        """Waits for a started simulation."""
        entry = Path(self.environment["XDG_RUNTIME_DIR"], "cartwheel", f"{process.pid}.json")
        deadline = time.monotonic() + 120
        while not entry.exists():
            assert process.poll() is None, process.stderr.read()
            assert time.monotonic() < deadline
            time.sleep(0.01)


def make_program() -> Iterator[Program]:
    # Short, for the paths of sockets have a limit.
    folder = Path(tempfile.mkdtemp(prefix="cw"))
    environment = {**os.environ, "XDG_RUNTIME_DIR": str(folder)}
    environment.pop("CARTWHEEL_SIM", None)
    made = Program(environment, folder)
    yield made
    made.close()
    shutil.rmtree(folder)


@pytest.fixture
def program() -> Iterator[Program]:
    yield from make_program()


@pytest.fixture(scope="module")
def shared() -> Iterator[Program]:
    """For the tests of a module that share a running cart: see `cart`."""
    yield from make_program()


@pytest.fixture(scope="module")
def cart(shared: Program) -> Iterator[Program]:
    """The shipped cart before its post, running without a viewer."""
    process = shared.start("run", "--headless")
    shared.wait_until_up(process)
    yield shared
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    assert "Traceback" not in errors


@pytest.fixture
def ends() -> Callable[[subprocess.Popen[str], int], float]:
    """Sends a signal and says how long the process took to end."""

    def send(process: subprocess.Popen[str], number: int) -> float:
        start = time.monotonic()
        process.send_signal(number)
        process.wait(timeout=120)
        return time.monotonic() - start

    return send
