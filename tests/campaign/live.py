"""A ``cartwheel run`` with all wires, attacked from outside and looked after."""

from __future__ import annotations

import atexit
import contextlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

from tests.campaign.target import FaultError

PROGRAM = Path(sys.executable).with_name("cartwheel")
PATIENCE_S = 120.0
_MARK = "CAMPAIGN_RUN"
_MOST_GROWTH = 600 << 20
"""Bytes that all processes of a run may grow by."""
_TROUBLE = ("Traceback (most recent call last)", "Cartwheel has a fault", "Exception ignored in")
HAS_MASTER = shutil.which("rosmaster") is not None


class LiveRun:
    """A simulation in a process of its own, with its page, Foxglove, ROS 1 and ROS 2.

    Args:
        arguments: Further ones of ``cartwheel run``.
        wait: Until it simulates.
    """

    def __init__(self, *arguments: str, wait: bool = True) -> None:
        # Sockets' paths are short; the name says whose it is, see `watching.sweep`.
        self.folder = Path(tempfile.mkdtemp(prefix=f"cw{os.getpid()}-", dir="/tmp"))
        self.mark = uuid.uuid4().hex
        ports = random.Random(self.mark).sample(range(20_000, 60_000), 3)
        self.page, self.foxglove, self.master = ports
        self.domain = random.Random(self.mark).randrange(100, 200)
        self.environment = {
            **os.environ,
            "XDG_RUNTIME_DIR": str(self.folder),
            "ROS_MASTER_URI": f"http://127.0.0.1:{self.master}",
            "ROS_HOSTNAME": "127.0.0.1",
            "ROS_DOMAIN_ID": str(self.domain),
            _MARK: self.mark,
        }
        self._output = (self.folder / "output").open("w+b")
        self._read = 0
        self.process = subprocess.Popen(
            [
                *(PROGRAM, "run", "--no-open", "--port", str(self.page)),
                *("--foxglove", "--foxglove-port", str(self.foxglove), "--ros2"),
                *(["--ros1"] if HAS_MASTER else []),
                *arguments,
            ],
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            preexec_fn=_unlimited,  # noqa: PLW1509 - the worker has one thread here
        )
        atexit.register(self.close)
        if wait:
            self._wait_until_up()
        self._memory = self.memory()

    def _wait_until_up(self) -> None:
        entry = self.folder / "cartwheel" / f"{self.process.pid}.json"
        deadline = time.monotonic() + PATIENCE_S
        while not entry.exists() or "running" not in self.state():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise FaultError(f"the run did not start: {self.output()}")
            time.sleep(0.05)

    def state(self) -> str:
        """What ``cartwheel status`` would say; empty where nothing answers."""
        try:
            with self.client() as client:
                return str(client.request("status")["state"])
        except (OSError, FaultError):
            return ""

    @contextlib.contextmanager
    def client(self) -> Iterator[object]:
        """One of the control socket."""
        from cartwheel.control import ControlClient
        from cartwheel.control.registry import Running
        from cartwheel.errors import ControlError

        path = self.folder / "cartwheel" / f"{self.process.pid}.sock"
        try:
            with ControlClient(
                Running(pid=self.process.pid, title="", world="", path=path)
            ) as client:
                yield client
        except ControlError as error:
            raise FaultError(f"the control socket refuses: {error}") from error

    def processes(self) -> list[int]:
        """All that came of it, wherever their parents are."""
        return processes_of(self.mark)

    def memory(self) -> int:
        """Resident bytes of all its processes."""
        total = 0
        for pid in self.processes():
            with contextlib.suppress(OSError):
                total += int(Path(f"/proc/{pid}/statm").read_text().split()[1])
        return total * resource.getpagesize()

    def output(self) -> str:
        """What it printed so far."""
        return (self.folder / "output").read_text(errors="replace")[-20_000:]

    def entries(self) -> list[Path]:
        """What it has in its folder of control sockets."""
        return sorted((self.folder / "cartwheel").glob("*"))

    def check_output(self) -> None:
        """Looks at what was printed since the last time, and whether the run lives.

        Raises:
            FaultError: A traceback, or it ended.
        """
        with (self.folder / "output").open("rb") as file:
            file.seek(self._read)
            new = file.read()
        self._read += len(new)
        if any(word in new.decode(errors="replace") for word in _TROUBLE):
            raise FaultError(f"the run printed:\n{new.decode(errors='replace')[-8000:]}")
        if self.process.poll() is not None:
            raise FaultError(f"the run ended with {self.process.returncode}:\n{self.output()}")

    def check(self) -> None:
        """Looks whether time goes on, all processes live, and memory is bounded.

        Raises:
            FaultError: Not so.
        """
        self.check_output()
        with self.client() as client:
            client.request("resume")
            client.request("speed", speed=1.0)
            before = client.request("status")["time_ns"]
            deadline = time.monotonic() + PATIENCE_S
            # A reset, which an input may have asked for, goes back.
            while client.request("status")["time_ns"] == before:
                if time.monotonic() > deadline:
                    raise FaultError(f"time stands still:\n{self.output()}")
                time.sleep(0.02)
        grown = self.memory() - self._memory
        if grown > _MOST_GROWTH:
            raise FaultError(f"its processes grew by {grown >> 20} MB")

    def close(self) -> None:
        """Kills all of it."""
        for pid in self.processes():
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        self.process.wait()
        self._output.close()
        shutil.rmtree(self.folder, ignore_errors=True)
        atexit.unregister(self.close)


def processes_of(mark: str) -> list[int]:
    """Living processes whose environment has a mark."""
    word = f"{_MARK}={mark}".encode()
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdecimal():
            with contextlib.suppress(OSError):
                dead = (folder / "stat").read_text().rpartition(")")[2].split()[0] in "ZX"
                if not dead and word in (folder / "environ").read_bytes().split(b"\0"):
                    found.append(int(folder.name))
    return found


def _unlimited() -> None:
    """In the child: none of the worker's limits, and an end with the worker."""
    import ctypes

    ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
