"""ROS 1 beside the simulation: a real master, real tools, and a subscriber made of sockets."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import struct
import subprocess
import sys
import time
import xmlrpc.client
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tests import launching
from tests.reserved import free_port

PROGRAM = Path(sys.executable).with_name("cartwheel")
PYTHON = launching.ROS1_PYTHON
PATIENCE = 120.0

NEEDED = ("rosmaster", "rostopic", "rosservice", "rosnode", "rosbag", "rosparam")
_missing = [name for name in NEEDED if shutil.which(name) is None]
_rospy = Path("/usr/lib/python3/dist-packages/rospy").is_dir()
REASON = f"not installed: {', '.join(_missing)}" if _missing else "" if _rospy else "Debian's rospy"


def wait_for(condition: Callable[[], Any], what: str, patience: float = PATIENCE) -> Any:
    deadline = time.monotonic() + patience
    while not (found := condition()):
        assert time.monotonic() < deadline, f"in vain: {what}"
        time.sleep(0.02)
    return found


class Master:
    """A rosmaster on a port of its own."""

    def __init__(self, folder: Path, port: int | None = None) -> None:
        self.port = port or free_port()
        self.uri = f"http://127.0.0.1:{self.port}"
        self.environment = {
            **{key: value for key, value in os.environ.items() if not key.startswith("ROS")},
            "PATH": f"{os.environ['PATH']}:/usr/bin",
            "ROS_MASTER_URI": self.uri,
            "ROS_HOSTNAME": "127.0.0.1",
            "ROS_HOME": str(folder),
            "XDG_RUNTIME_DIR": str(folder),
        }
        launching.admit_ros1(self.environment)
        self._process: subprocess.Popen[bytes] | None = None
        self.start()

    @property
    def api(self) -> Any:
        return xmlrpc.client.ServerProxy(self.uri)

    def start(self) -> None:
        self._process = launching.Popen(
            ["rosmaster", "--core", "-p", str(self.port)],
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        wait_for(self.answers, "the master")

    def answers(self) -> bool:
        with contextlib.suppress(OSError):
            return bool(self.api.getPid("/test")[0] == 1)
        return False

    def kill(self) -> None:
        assert self._process is not None
        self._process.kill()
        self._process.wait()

    def run(self, *command: str, timeout: float = PATIENCE, check: bool = True) -> str:
        """The output of a tool."""
        done = launching.run(
            command,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )
        assert done.returncode == 0 or not check, done.stdout + done.stderr
        return done.stdout

    def python(self, script: str, *arguments: str) -> subprocess.Popen[str]:
        """A rospy script of Debian's Python, running."""
        return launching.Popen(
            [PYTHON, "-c", script, *arguments],
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def types(self) -> dict[str, str]:
        return dict(self.api.getTopicTypes("/test")[2])

    def state(self) -> tuple[dict[str, list[str]], ...]:
        """Publishers, subscribers and services with their nodes."""
        return tuple(dict(part) for part in self.api.getSystemState("/test")[2])

    def node(self, name: str) -> Any:
        """The XML-RPC interface of a node, as soon as the master knows it."""

        def known() -> str:
            code, _, uri = self.api.lookupNode("/test", name)
            return uri if code == 1 else ""

        return xmlrpc.client.ServerProxy(wait_for(known, f"node {name}"))


@contextlib.contextmanager
def simulation(master: Master, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """``cartwheel run --headless --ros1``, registered."""
    process = launching.Popen(
        [str(PROGRAM), "run", *arguments, "--headless", "--ros1"],
        env=master.environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        yield process
    finally:
        process.terminate()
        output, _ = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in output, output


def registered(master: Master, topic: str = "/clock") -> None:
    wait_for(lambda: topic in master.types(), f"{topic} on the master")


class Subscriber:
    """A connection to a publisher of a topic, byte by byte."""

    def __init__(self, master: Master, topic: str, node: str = "/gazebo", **fields: str) -> None:
        answer = master.node(node).requestTopic("/test", topic, [["TCPROS"]])
        assert answer[0] == 1, answer
        self.socket = socket.create_connection(tuple(answer[2][1:]), timeout=PATIENCE)
        self.send({"topic": topic, "type": "*", "md5sum": "*", "callerid": "/test", **fields})
        self.header = self.read_header()

    def send(self, fields: dict[str, str]) -> None:
        send_header(self.socket, fields)

    def read_header(self) -> dict[str, str]:
        return read_header(self.socket)

    def read(self) -> bytes:
        return read_block(self.socket)

    def close(self) -> None:
        self.socket.close()


def send_header(sock: socket.socket, fields: dict[str, str]) -> None:
    parts = [f"{name}={value}".encode() for name, value in fields.items()]
    body = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    sock.sendall(struct.pack("<I", len(body)) + body)


def read_block(sock: socket.socket) -> bytes:
    (length,) = struct.unpack("<I", _exactly(sock, 4))
    return _exactly(sock, length)


def read_header(sock: socket.socket) -> dict[str, str]:
    body, fields = read_block(sock), {}
    while body:
        (length,) = struct.unpack_from("<I", body)
        name, _, value = body[4 : 4 + length].decode().partition("=")
        fields[name] = value
        body = body[4 + length :]
    return fields


def _exactly(sock: socket.socket, count: int) -> bytes:
    data = b""
    while len(data) < count:
        more = sock.recv(count - len(data))
        if not more:
            raise ConnectionError("the connection has ended")
        data += more
    return data
