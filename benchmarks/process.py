"""The ``cartwheel run`` process: time to the first clock and the first image, and memory.

The benchmark waits for the control socket of the new process, subscribes through it as
``cartwheel topic echo`` does, and takes the time when it receives the first message.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.carts import READ
from benchmarks.figure import Effort, Figure
from cartwheel.control.client import ControlClient, Subscription
from cartwheel.control.registry import find
from cartwheel.errors import ControlError

IMAGE = "/rosbots/camera1/image_raw"
_PATIENCE = 60.0
"""s."""


def figures(effort: Effort) -> Iterator[Figure]:
    """Time from the start to the first clock and image, and memory after some seconds."""
    goals = {"/clock": 1.0, IMAGE: 1.5}
    for topic, goal in goals.items():
        times, used = zip(*(_until(topic) for _ in range(effort.starts)), strict=True)
        name = f"to the first {'image' if topic == IMAGE else 'clock'}"
        yield Figure(
            group="cartwheel run --headless",
            name=name,
            value=statistics.median(times),
            unit="s",
            goal=goal,
            note=f"{min(times):.2f} to {max(times):.2f}, files in the cache; "
            + ("Gazebo 11: spawn alone 1.8" if topic == IMAGE else "Gazebo 11: 2.0"),
        )
        yield Figure(
            group="cartwheel run --headless",
            name=f"{name}, CPU time",
            value=statistics.median(used),
            unit="CPU s",
            note="all threads",
        )
    for topics, name, gazebo in ((READ, "without camera", 237), ((*READ, IMAGE), "with", 355)):
        yield Figure(
            group="Memory of cartwheel run --headless",
            name=name if name == "without camera" else "with camera",
            value=_memory(topics, min(3.0, effort.seconds)),
            unit="MB resident",
            goal=gazebo,
            note=f"Gazebo 11: {gazebo}",
        )


@contextlib.contextmanager
def _command(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """Starts a simulation with a private folder for its control socket."""
    script = shutil.which("cartwheel", path=str(Path(sys.executable).parent))
    command = [script] if script else [sys.executable, "-m", "cartwheel.cli.main"]
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        before = os.environ.get("XDG_RUNTIME_DIR")
        os.environ["XDG_RUNTIME_DIR"] = folder
        process = subprocess.Popen(
            [*command, "run", "--headless", *arguments],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        stack.callback(_restore, before)
        try:
            yield process
        finally:
            process.terminate()
            process.communicate(timeout=_PATIENCE)


def _restore(folder: str | None) -> None:
    if folder is None:
        del os.environ["XDG_RUNTIME_DIR"]
    else:
        os.environ["XDG_RUNTIME_DIR"] = folder


def _client(process: subprocess.Popen[bytes], topic: str) -> Subscription:
    """Subscribes as soon as the process accepts connections."""
    deadline = time.monotonic() + _PATIENCE
    while time.monotonic() < deadline:
        if process.poll() is not None:
            text = process.stderr.read().decode() if process.stderr else ""
            raise RuntimeError(f"cartwheel run ended early: {text}")
        # Look only at the folder until the process has registered.
        if any(Path(os.environ["XDG_RUNTIME_DIR"]).glob("cartwheel/*.json")):
            with contextlib.suppress(ControlError):
                return ControlClient(find(str(process.pid))).subscribe(topic)
        time.sleep(0.002)
    raise TimeoutError("cartwheel run did not answer")


def _until(topic: str) -> tuple[float, float]:
    """Time until the first message, s: wall time, and CPU time of the new process."""
    start = time.perf_counter()
    with _command() as process, _client(process, topic) as subscription:
        subscription.get(_PATIENCE)
        wall = time.perf_counter() - start
        # The fields after the name in parentheses, which may contain any character.
        fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        return wall, (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _memory(topics: tuple[str, ...], seconds: float) -> float:
    with _command() as process, contextlib.ExitStack() as stack:
        for topic in topics:
            subscription = stack.enter_context(_client(process, topic))
            subscription.get(_PATIENCE)
        time.sleep(seconds)
        pages = int(Path(f"/proc/{process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
