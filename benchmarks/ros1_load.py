"""What ROS 1 subscribers cost a simulation that runs in real time.

In one run and in turns: the same topics read in process, and read by nodes: images of 640x480
at 30 Hz by 3, odometry and transforms at 100 Hz by 20. The images are made beforehand, so
that what is measured is the way out and not the renderer. The subscribers are one process
that reads its sockets and throws away what it reads.
"""

from __future__ import annotations

import argparse
import gc
import os
import selectors
import socket
import struct
import subprocess
import sys
import threading
import time
import xmlrpc.client
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

IMAGES, ODOMETRIES = 3, 20
WIDTH, HEIGHT = 640, 480
IMAGE, ODOM, TF = "/camera/image_raw", "/odom", "/tf"


def subscribe(uri: str) -> None:
    """Reads until its standard input ends, then prints what came of each topic."""
    node = xmlrpc.client.ServerProxy(uri)
    selector = selectors.DefaultSelector()
    counts: dict[str, int] = {}
    for topic, count in ((IMAGE, IMAGES), (ODOM, ODOMETRIES), (TF, ODOMETRIES)):
        counts[topic] = 0
        for index in range(count):
            answer: Any = node.requestTopic(f"/reader_{index}", topic, [["TCPROS"]])
            sock = socket.create_connection(tuple(answer[2][1:]))
            fields = [f"topic={topic}", "type=*", "md5sum=*", f"callerid=/reader_{index}"]
            body = b"".join(struct.pack("<I", len(f)) + f.encode() for f in fields)
            sock.sendall(struct.pack("<I", len(body)) + body)
            (length,) = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))
            sock.recv(length, socket.MSG_WAITALL)
            selector.register(sock, selectors.EVENT_READ, topic)
    selector.register(sys.stdin, selectors.EVENT_READ, "")
    print("ready", flush=True)
    scratch = bytearray(1 << 20)
    while True:
        for key, _ in selector.select():
            if not key.data:
                print(" ".join(f"{topic}={count}" for topic, count in counts.items()), flush=True)
                return
            counts[key.data] += key.fileobj.recv_into(scratch)  # type: ignore[union-attr]


def _waited() -> float:
    """s that this thread was ready to run and another had its core."""
    return int(Path("/proc/thread-self/schedstat").read_text().split()[1]) / 1e9


class Phase:
    """A part of the run and what it cost."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.gap = 0.0
        self.waited = -_waited()
        self.process = -time.process_time()
        self.owner = -time.thread_time()
        self.wall = -time.perf_counter()

    def end(self) -> None:
        self.process += time.process_time()
        self.waited += _waited()
        self.owner += time.thread_time()
        self.wall += time.perf_counter()

    def __str__(self) -> str:
        return (
            f"{self.title:10s} process {100 * self.process / self.wall:5.1f} % of a core,"
            f" simulation's thread {100 * self.owner / self.wall:5.1f} %,"
            f" longest gap between steps {1e3 * self.gap:5.1f} ms, waited for a core"
            f" {1e3 * self.waited:5.1f} ms in all"
        )


def run(master: str, seconds: float, rounds: int) -> None:
    import numpy as np

    from cartwheel.bridges.ros1 import Ros1Bridge
    from cartwheel.description import load_robot, load_world
    from cartwheel.messages import header, message_class, zero
    from cartwheel.session import Session

    os.environ["ROS_MASTER_URI"] = master
    session = Session(load_world("empty"))
    simulation = session.simulation
    session.spawn(load_robot("rosbots.xacro"))
    graph = session.graph
    publisher = graph.advertise(IMAGE, "sensor_msgs/msg/Image", rate=30.0)
    picture: Any = zero("sensor_msgs/Image")
    pixels = np.random.default_rng(0).integers(0, 255, WIDTH * HEIGHT * 3, dtype=np.uint8)

    def publish() -> None:
        publisher.publish(
            message_class("sensor_msgs/msg/Image")(
                header=header(simulation.time_ns, "camera"),
                height=HEIGHT,
                width=WIDTH,
                encoding="rgb8",
                is_bigendian=picture.is_bigendian,
                step=3 * WIDTH,
                data=pixels,
            )
        )

    simulation.schedule(30.0, after=publish, active=lambda: publisher.wanted)
    bridge = Ros1Bridge(graph, report=lambda found: print(found, file=sys.stderr))
    bridge.start()
    phases: list[Phase] = []
    last = time.perf_counter()

    def look() -> None:
        nonlocal last
        now = time.perf_counter()
        if phases:
            phases[-1].gap = max(phases[-1].gap, now - last)
        last = now

    simulation.schedule(0.0, before=look)
    # As a run does: nothing of what was loaded is looked through for garbage.
    gc.freeze()
    pacer = session.pacer()

    def go(title: str) -> Phase:
        """Runs for some seconds of wall time."""
        timer = threading.Timer(seconds, lambda: simulation.post(simulation.pause))
        timer.start()
        simulation.resume()
        nonlocal last
        last = time.perf_counter()
        phase = Phase(title)
        phases.append(phase)
        pacer_until(pacer, simulation, lambda: simulation.run_state.name == "PAUSED")
        phase.end()
        return phase

    def wait_for(condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + 20
        pacer_until(pacer, simulation, lambda: condition() or time.monotonic() > deadline)
        if not condition():
            sys.exit("the subscribers do not come")

    found: dict[str, list[Phase]] = {"in process": [], "ROS 1": []}
    for _ in range(rounds):
        boxes = [graph.mailbox(topic, size=1) for topic in (IMAGE, ODOM, TF)]
        found["in process"].append(go("in process"))
        for box in boxes:
            box.close()
        simulation.resume()
        uri = bridge.uri
        child = subprocess.Popen(
            [sys.executable, __file__, "--reader", uri],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert child.stdout is not None
        wait_for(lambda: publisher.wanted)
        wait_for(_first_line(child.stdout).is_set)
        found["ROS 1"].append(go("ROS 1"))
        sent, _ = child.communicate()
        print("received bytes:", sent.strip())
        simulation.resume()
        wait_for(lambda: not publisher.wanted)
    for phase in phases:
        print(phase)
    cost = [
        100 * (loud.process / loud.wall - quiet.process / quiet.wall)
        for quiet, loud in zip(*found.values(), strict=True)
    ]
    print(f"cost of the subscribers: {sorted(cost)[len(cost) // 2]:.1f} % of a core (median)")
    bridge.close()
    session.close()


def _first_line(stream: IO[str]) -> threading.Event:
    """Set when a line has come."""
    came = threading.Event()

    def read() -> None:
        stream.readline()
        came.set()

    threading.Thread(target=read, daemon=True).start()
    return came


def pacer_until(pacer: Any, simulation: Any, ended: Callable[[], bool]) -> None:
    """Runs in real time until something holds."""
    while not ended():
        simulation.drain()
        if not ended():
            pacer._run_on()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reader", help=argparse.SUPPRESS)
    parser.add_argument("--port", type=int, default=11732, help="Of the master it starts.")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    if arguments.reader:
        subscribe(arguments.reader)
        return
    sys.path.insert(0, str(Path(__file__).parents[1]))
    run(f"http://127.0.0.1:{arguments.port}", arguments.seconds, arguments.rounds)


if __name__ == "__main__":
    main()
