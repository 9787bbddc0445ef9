"""A run with all wires beside busy processes: every wire still delivers at its rate at the end.

python -m tests.campaign.load --minutes 5

It prints what it sees in each window, and its verdict as one line of JSON at the end. The exit
status is 1 where a wire fell silent or did not deliver at its rate. How often a topic was published
is read from the recording, which loses nothing; how far the simulation came in a window says how
many messages a reader must have had in it. So the verdict does not depend on how fast the machine
is.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import xmlrpc.client
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.campaign.live import PROGRAM
from tests.reserved import dds_domains, free_port

from benchmarks import wire_readers
from cartwheel.control import ControlClient, running
from cartwheel.errors import CartwheelError

BUSY = 8
"""Processes that take what the processor has."""
_START = 180.0
_END = 180.0
_LEAST_TIME = 1.0
"""s of simulated time, of which something must arrive."""
IMAGE = "/rosbots/camera1/image_raw"
TOPICS = {
    "/odom": "nav_msgs/msg/Odometry",
    "/imu/data": "sensor_msgs/msg/Imu",
    "/joint_states": "sensor_msgs/msg/JointState",
    IMAGE: "sensor_msgs/msg/Image",
}
SENSORS = ("/imu/data", IMAGE)
"""Which are not reliable."""
SHARES = {IMAGE: 0.3}
"""Of the published messages that must arrive in the last window. Images may be dropped where a
reader has no time for them."""
_SHARE = 0.9


@dataclass(frozen=True, kw_only=True, slots=True)
class Window:
    """What came in a window."""

    simulated: float
    """s of simulated time."""
    counts: dict[str, dict[str, int]]
    """Messages by wire and topic."""


class Reader:
    """A process that counts the messages of one wire."""

    def __init__(self, wire: str, address: str, environment: dict[str, str]) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.campaign.load", "--read", wire, address],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def counts(self) -> dict[str, int]:
        """Messages by topic since the last call."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        found: dict[str, int] = json.loads(self._process.stdout.readline())
        return found

    def close(self) -> None:
        """Ends it."""
        self._process.kill()
        self._process.communicate()


def _count(wire: str, address: str) -> None:
    """The program of a reader."""
    found: Counter[str] = Counter()
    wire_readers.TYPES.clear()
    wire_readers.TYPES.update(TOPICS)
    wire_readers.SENSORS = SENSORS

    def read() -> None:
        wire_readers.READERS[wire](address, lambda topic, _: found.update((topic,)))

    threading.Thread(target=read, daemon=True).start()
    for _ in sys.stdin:
        now = {topic: found[topic] for topic in TOPICS}
        found.subtract(now)
        print(json.dumps(now), flush=True)


@contextlib.contextmanager
def _busy(count: int) -> Iterator[None]:
    processes = [subprocess.Popen([sys.executable, "-c", "while 1: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


class Run:
    """A simulation with all wires.

    Args:
        folder: For the recording and the control socket.
        wires: Of `wire_readers.READERS`.
    """

    def __init__(self, folder: Path, wires: list[str]) -> None:
        self.file = folder / "load.mcap"
        self.environment = {
            **os.environ,
            "XDG_RUNTIME_DIR": str(folder),
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}",
            "ROS_HOSTNAME": "127.0.0.1",
            "ROS_DOMAIN_ID": str(dds_domains()),
        }
        os.environ.update(self.environment)
        self.foxglove = free_port()
        options = {
            "ros1": ["--ros1"],
            "ros2": ["--ros2"],
            "foxglove": ["--foxglove", "--foxglove-port", str(self.foxglove)],
        }
        self.process = subprocess.Popen(
            [
                *(PROGRAM, "run", "--headless", "--record", str(self.file)),
                *("--record-topics", "!*image_raw/*"),
                *(word for wire in wires for word in options[wire]),
            ],
            stdout=subprocess.DEVNULL,
        )

    def client(self) -> ControlClient:
        """To its control socket; waits until it is there."""
        while True:
            found = [one for one in running() if one.pid == self.process.pid]
            if found:
                return ControlClient(found[0])
            self.check()
            time.sleep(0.1)

    def check(self) -> None:
        """Raises an error if it has ended."""
        if self.process.poll() is not None:
            raise CartwheelError(f"the run ended with status {self.process.returncode}")

    def address(self, wire: str) -> str:
        """Of a wire, as its reader takes it."""
        if wire == "foxglove":
            socket.create_connection(("127.0.0.1", self.foxglove)).close()
            return f"ws://127.0.0.1:{self.foxglove}"
        if wire != "ros1":
            return ""
        master: Any = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])
        publishers = dict(master.getSystemState("/load")[2][0])
        return str(master.lookupNode("/load", publishers["/odom"][0])[2])

    def recorded(self) -> tuple[float, dict[str, int]]:
        """Ends the run; the recording's s and its messages by topic."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(_END)
        done = subprocess.run(
            [PROGRAM, "info", "--json", str(self.file)],
            stdout=subprocess.PIPE,
            check=True,
            text=True,
        )
        found = json.loads(done.stdout)
        counts = {each["name"]: each["messages"] for each in found["topics"]}
        return (found["end_ns"] - found["start_ns"]) / 1e9, counts

    def close(self) -> None:
        """Ends it, if it has not ended."""
        self.process.kill()
        self.process.wait()


def faults_of(windows: list[Window], rates: dict[str, float]) -> list[str]:
    """What is wrong with what came.

    Args:
        windows: In their order.
        rates: Messages by topic that were published in a simulated second.
    """
    found = []
    for number, window in enumerate(windows):
        is_last = number == len(windows) - 1
        for wire, counts in window.counts.items():
            for topic, count in counts.items():
                expected = rates.get(topic, 0.0) * window.simulated
                if window.simulated > _LEAST_TIME and not count:
                    found.append(f"{wire}: {topic} fell silent in window {number + 1}")
                elif is_last and count < SHARES.get(topic, _SHARE) * expected:
                    found.append(
                        f"{wire}: {count} of {expected:.0f} messages of {topic} at the end"
                    )
        if window.simulated <= 0:
            found.append(f"the simulation stood still in window {number + 1}")
    return found


def measure(minutes: float, wires: list[str], busy: int, seconds: float) -> dict[str, Any]:
    """Runs it with windows of some seconds; the verdict."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="load")))
        run = Run(folder, wires)
        stack.callback(run.close)
        client = stack.enter_context(run.client())
        readers = {}
        begin = time.monotonic()
        for wire in wires:
            while wire not in readers:
                try:
                    readers[wire] = Reader(wire, run.address(wire), run.environment)
                except (OSError, KeyError):
                    # It is not there yet.
                    run.check()
                    if time.monotonic() > begin + _START:
                        raise
                    time.sleep(0.5)
            stack.callback(readers[wire].close)
        missing = {(wire, topic) for wire in wires for topic in TOPICS}
        while missing:
            run.check()
            if time.monotonic() > begin + _START:
                return {"ok": False, "faults": [f"never came: {sorted(missing)}"]}
            time.sleep(0.5)
            for wire, reader in readers.items():
                missing -= {(wire, topic) for topic, count in reader.counts().items() if count}
        stack.enter_context(_busy(busy))
        windows: list[Window] = []
        end = time.monotonic() + 60 * minutes
        simulated = client.request("status")["time"]
        while not windows or time.monotonic() < end:
            time.sleep(seconds)
            now = client.request("status")["time"]
            counts = {wire: reader.counts() for wire, reader in readers.items()}
            windows.append(Window(simulated=now - simulated, counts=counts))
            simulated = now
            print(f"{windows[-1].simulated:.1f} s simulated: {counts}", file=sys.stderr)
        simulated, recorded = run.recorded()
        rates = {topic: recorded.get(topic, 0) / simulated for topic in TOPICS}
        faults = faults_of(windows, rates)
        faults += [f"record: no messages of {topic}" for topic, rate in rates.items() if not rate]
        return {
            "ok": not faults,
            "faults": faults,
            "windows": len(windows),
            "simulated": round(simulated, 1),
            "rates": {topic: round(rate, 1) for topic, rate in rates.items()},
            "last": windows[-1].counts,
        }


def main() -> int:
    """The exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaign.load", description=__doc__)
    parser.add_argument("--minutes", type=float, default=5.0, help="wall time (default: 5)")
    parser.add_argument("--wires", default="ros1,ros2,foxglove", help="beside the recording")
    parser.add_argument("--busy", type=int, default=BUSY, help="processes (default: 8)")
    parser.add_argument("--window", type=float, default=20.0, help="s of wall time (default: 20)")
    parser.add_argument("--read", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.read:
        _count(*given.read)
        return 0
    try:
        verdict = measure(given.minutes, given.wires.split(","), given.busy, given.window)
    except (OSError, CartwheelError, subprocess.SubprocessError) as error:
        verdict = {"ok": False, "faults": [f"{type(error).__name__}: {error}"]}
    print(json.dumps(verdict))
    return 0 if verdict["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
