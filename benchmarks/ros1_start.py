"""The time from a command to the first message that a waiting ROS 1 node receives.

With ``--launch``, the commands are ``roslaunch gazebo_ros empty_world.launch``, to the first
/clock, and ``rosrun gazebo_ros spawn_model``, to the cart's first image (goals: 1.0 s each;
Gazebo 11: 1.35 and 1.8 s). Without it, the command is ``cartwheel run --ros1``. The master is
running already. The listener implements the protocol itself and does not use Cartwheel's code.
"""

from __future__ import annotations

import argparse
import os
import signal
import socket
import statistics
import struct
import subprocess
import sys
import threading
import time
import xmlrpc.client
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

CLOCK = ("/clock", "rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47")
IMAGE = ("/rosbots/camera1/image_raw", "sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743")
ROOT = Path(__file__).parents[1]


class _Handler(SimpleXMLRPCRequestHandler):
    rpc_paths = ("/", "/RPC2")


class Listener:
    """A node that waits for the first message of a topic, given its type and md5 sum."""

    def __init__(self, master: str, topic: tuple[str, str, str]) -> None:
        self._topic, self._type, self._md5 = topic
        self._master = xmlrpc.client.ServerProxy(master)
        self._server = SimpleXMLRPCServer(
            ("127.0.0.1", 0), requestHandler=_Handler, logRequests=False, allow_none=True
        )
        self._uri = f"http://127.0.0.1:{self._server.server_address[1]}/"
        self._server.register_function(self._update, "publisherUpdate")  # type: ignore[arg-type]
        self.received: float | None = None
        self.came = threading.Event()
        threading.Thread(target=self._server.serve_forever, args=(0.01,), daemon=True).start()
        self._call("registerSubscriber", self._topic, self._type, self._uri)

    def close(self) -> None:
        self._call("unregisterSubscriber", self._topic, self._uri)
        self._server.shutdown()
        self._server.server_close()

    def _call(self, method: str, *arguments: str) -> None:
        getattr(self._master, method)("/clock_listener", *arguments)

    def _update(self, _caller: str, _topic: str, publishers: list[str]) -> tuple[int, str, int]:
        for uri in publishers:
            threading.Thread(target=self._connect, args=(uri,), daemon=True).start()
        return 1, "", 0

    def _connect(self, uri: str) -> None:
        proxy = xmlrpc.client.ServerProxy(uri)
        answer: list = proxy.requestTopic("/clock_listener", self._topic, [["TCPROS"]])  # type: ignore[assignment, type-arg]
        _, host, port = answer[2]
        fields = [f"topic={self._topic}", f"type={self._type}", f"md5sum={self._md5}"]
        fields.append("callerid=/clock_listener")
        body = b"".join(struct.pack("<I", len(f)) + f.encode() for f in fields)
        with socket.create_connection((host, port)) as sock:
            sock.sendall(struct.pack("<I", len(body)) + body)
            for _ in range(2):
                (length,) = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))
                sock.recv(length, socket.MSG_WAITALL)
            self.received = time.perf_counter()
            self.came.set()


def first(listener: Listener) -> float:
    """The time at which the listener received its first message."""
    if not listener.came.wait(30) or listener.received is None:
        sys.exit("no message within 30 s")
    listener.close()
    return listener.received


def measure(command: list[str], master: str) -> float:
    """The time from starting a command to the first /clock, s."""
    listener = Listener(master, CLOCK)
    began = time.perf_counter()
    child = subprocess.Popen(
        command,
        env={**os.environ, "ROS_MASTER_URI": master},
        stdout=subprocess.DEVNULL,
    )
    try:
        return first(listener) - began
    finally:
        child.send_signal(signal.SIGINT)
        child.wait(10)


def sourced(master: str) -> dict[str, str]:
    """The environment of a terminal that has sourced the workspace."""
    shell = subprocess.run(
        ["bash", "-c", "source ros1/devel/setup.bash && env -0"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    pairs = (entry.partition("=") for entry in shell.stdout.split("\0") if entry)
    return {name: value for name, _, value in pairs} | {"ROS_MASTER_URI": master}


def measure_launch(master: str) -> tuple[float, float]:
    """The times from roslaunch to the first /clock and from spawn_model to the first image, s."""
    environment = sourced(master)
    listener = Listener(master, CLOCK)
    began = time.perf_counter()
    launched = subprocess.Popen(
        ["roslaunch", "gazebo_ros", "empty_world.launch", "gui:=false"],
        env=environment,
        stdout=subprocess.DEVNULL,
    )
    try:
        to_clock = first(listener) - began
        listener = Listener(master, IMAGE)
        robot = ROOT / "robots" / "rosbots_description" / "urdf" / "rosbots.xacro"
        urdf = subprocess.run(
            ["rosrun", "xacro", "xacro", str(robot)],
            env=environment,
            capture_output=True,
            check=True,
        ).stdout
        words = ["spawn_model", "-urdf", "-stdin", "-model", "rosbots"]
        began = time.perf_counter()
        subprocess.run(
            ["rosrun", "gazebo_ros", *words],
            env=environment,
            input=urdf,
            stdout=subprocess.DEVNULL,
            check=True,
        )
        return to_clock, first(listener) - began
    finally:
        launched.send_signal(signal.SIGINT)
        launched.wait(20)


def summary(what: str, times: list[float]) -> str:
    """The median, minimum and maximum as text."""
    return (
        f"{what} after {statistics.median(times):.3f} s"
        f" ({min(times):.3f} to {max(times):.3f} s, {len(times)} runs)"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--port", type=int, default=11731, help="Port of the master to start.")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--launch", action="store_true", help="Measure roslaunch and rosrun.")
    parser.add_argument("words", nargs="*", default=["empty.world"])
    arguments = parser.parse_args()
    uri = f"http://127.0.0.1:{arguments.port}"
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(arguments.port)])
    try:
        while True:
            try:
                xmlrpc.client.ServerProxy(uri).getPid("/benchmark")
                break
            except OSError:
                time.sleep(0.05)
        if arguments.launch:
            pairs = [measure_launch(uri) for _ in range(arguments.runs)]
            print(summary("roslaunch: first /clock", [clock for clock, _ in pairs]))
            print(summary("spawn_model: first image", [image for _, image in pairs]))
        else:
            cartwheel = str(Path(sys.executable).with_name("cartwheel"))
            command = [cartwheel, "run", *arguments.words, "--headless", "--ros1"]
            print(summary("first /clock", [measure(command, uri) for _ in range(arguments.runs)]))
    finally:
        master.terminate()


if __name__ == "__main__":
    main()
