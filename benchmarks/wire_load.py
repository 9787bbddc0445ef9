"""One simulation with some of the bridges, and a subscriber of each.

python -m benchmarks.wire_load WIRE... [--pairs N] [--turn SECONDS]
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from benchmarks.carts import READ, Listener, driving
from benchmarks.wire_readers import IMAGE, SENSORS, TYPES, Reader
from cartwheel.messages import header, zero
from cartwheel.simulation import RunState

WIRES = ("ros1", "ros2", "foxglove", "record", "zenoh")
_RATES = {topic: 30.0 if topic == IMAGE else 100.0 for topic in TYPES}
"""Publish rates in wall time, Hz."""
_PATIENCE = 30.0
_TRANSFORMS = 10
_TURN, _TURNS = 0.25, 4
"""Seconds at full speed per turn, and turns per pair. Short turns let changes of the machine's
speed affect both sides of a pair."""


class Load:
    """Publishes typical messages of a robot at fixed wall-time rates, on the simulation's thread.

    Images are made in advance: the benchmark measures the transport, not the renderer.

    Attributes:
        loud: Whether it publishes on the topics of the bridges, or on similar topics with
            subscribers in the same process only.
    """

    def __init__(self, world: Any) -> None:
        graph = world.session.graph
        self._post = world.session.simulation.post
        self.loud = False
        self._publishers = {
            (topic, loud): graph.advertise(
                topic if loud else f"/quiet{topic}",
                kind,
                rate=_RATES[topic],
                qos="sensor" if topic in SENSORS else "default",
            )
            for topic, kind in TYPES.items()
            for loud in (False, True)
        }
        for publisher in self._publishers.values():
            graph.subscribe(publisher.topic, lambda _: None)
        self._pixels = _picture().ravel()
        self._ended = threading.Event()
        self._late = dict.fromkeys(TYPES, False)
        threading.Thread(target=self._tick, daemon=True).start()

    def close(self) -> None:
        """Stops publishing."""
        self._ended.set()

    def _tick(self) -> None:
        due = dict.fromkeys(TYPES, time.monotonic())
        while not self._ended.wait(max(0.0, min(due.values()) - time.monotonic())):
            for topic, when in due.items():
                if when <= time.monotonic():
                    due[topic] = when + 1 / _RATES[topic]
                    if not self._late[topic]:
                        self._late[topic] = True
                        self._post(lambda topic=topic: self._publish(topic))

    def _publish(self, topic: str) -> None:
        self._late[topic] = False
        message = zero(TYPES[topic])
        stamped = header(time.time_ns(), "frame")
        if TYPES[topic].endswith("TFMessage"):
            message.transforms = [
                zero("geometry_msgs/msg/TransformStamped") for _ in range(_TRANSFORMS)
            ]
            message.transforms[0].header = stamped
        else:
            message.header = stamped
        if topic == IMAGE:
            message.width, message.height, message.step = 640, 480, 1920
            message.encoding, message.data = "rgb8", self._pixels
        self._publishers[topic, self.loud].publish(message)


def _waited() -> float:
    """Time that this thread was ready to run but had no core, s."""
    return int(Path("/proc/thread-self/schedstat").read_text().split()[1]) / 1e9


def _used(processes: Iterable[int]) -> float:
    """CPU seconds of some processes, from their Linux clocks (clock_getcpuclockid)."""
    return sum(time.clock_gettime((~pid << 3) | 2) for pid in processes)


def _picture() -> Any:
    """Boxes in front of a sky: it compresses as well as a rendered image."""
    generator = np.random.default_rng(0)
    picture = np.empty((480, 640, 3), np.uint8)
    picture[:] = np.linspace(250, 120, 480).astype(np.uint8)[:, None, None]
    for _ in range(200):
        x, y = generator.integers(0, 600), generator.integers(150, 460)
        shade = np.linspace(0.6, 1.0, 60)[: 640 - x, None] * generator.integers(20, 255, 3)
        picture[y : y + 40, x : x + 60] = shade.astype(np.uint8)
    return picture


def run(wires: list[str], pairs: int, turn: float) -> dict[str, Any]:
    """Publishes within the process and to the bridges, in turns.

    Args:
        wires: The bridges.
        pairs: Number of turns in real time.
        turn: Wall time of each turn in real time, s. There are fewer turns at full speed if it is
            short.

    Returns:
        Under `real` (real time) and `full` (full speed), three numbers for both turns of each
        pair: CPU seconds per second, including the bridges' processes; simulated seconds per
        second, not counting time that the simulation's thread waited for a core; and simulated
        seconds per second of wall time. Under `ages`, the latency of messages.
    """
    with contextlib.ExitStack() as stack:
        world = driving()
        stack.callback(world.close)
        session, simulation = world.session, world.session.simulation
        # The usual work of a simulation's thread.
        Listener(world, READ)
        load = Load(world)
        stack.callback(load.close)
        processes = [os.getpid()]
        gc.collect()
        gc.freeze()

        def go(speed: float | None, seconds: float, *, loud: bool = True) -> list[float]:
            """Runs for a wall time; returns the three numbers of one turn."""
            load.loud = loud
            simulation.set_speed(speed)
            simulation.run_state = RunState.RUNNING
            threading.Timer(seconds, lambda: simulation.post(simulation.stop)).start()
            before = simulation.time_ns
            cpu, wall, waited = _used(processes), time.perf_counter(), _waited()
            session.pacer().run()
            wall = time.perf_counter() - wall
            cpu, waited = _used(processes) - cpu, _waited() - waited
            passed = (simulation.time_ns - before) / 1e9
            return [cpu / wall, passed / (wall - waited), passed / wall]

        def compare(speed: float | None, seconds: float, count: int) -> list[list[list[float]]]:
            return [[go(speed, seconds, loud=loud) for loud in (False, True)] for _ in range(count)]

        def go_until(condition: Callable[[], bool]) -> None:
            deadline = time.monotonic() + _PATIENCE
            while not condition():
                if time.monotonic() > deadline:
                    sys.exit("the subscribers did not connect")
                go(1.0, 0.2)

        readers = _attach(world, wires, stack, processes)
        names = {"record": "recorder", "zenoh": "ros2"}
        expected = {names.get(wire, wire) for wire in wires}
        graph = session.graph
        go_until(lambda: all(expected <= set(graph.topic(t).subscribers) for t in TYPES))
        go(1.0, turn)
        for reader in readers.values():
            reader.ages()
        real = compare(1.0, turn, pairs)
        return {
            "real": real,
            "ages": {wire: reader.ages() for wire, reader in readers.items()},
            "full": compare(None, _TURN, max(1, round(_TURNS * pairs * turn))),
        }


@contextlib.contextmanager
def _master(uri: str) -> Iterator[None]:
    """A ROS master without ``rosout``, which may or may not subscribe to ``/clock``."""
    program = ["rosmaster", "--core", "-p", str(urlsplit(uri).port)]
    process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + _PATIENCE
    try:
        while not _answers(uri):
            if process.poll() is not None or time.monotonic() > deadline:
                sys.exit(f"cannot start a ROS master at {uri}")
            time.sleep(0.05)
        yield
    finally:
        process.terminate()
        process.wait()


def _answers(uri: str) -> bool:
    with contextlib.suppress(OSError):
        return bool(xmlrpc.client.ServerProxy(uri).getPid("/benchmark"))
    return False


def _attach(
    world: Any, wires: list[str], stack: contextlib.ExitStack, processes: list[int]
) -> dict[str, Reader]:
    """Starts each bridge with a subscriber, and adds the bridges' processes to `processes`."""
    from cartwheel.assembly.foxglove import SimulationControls
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.ros1.address import master_uri

    graph, simulation = world.session.graph, world.session.simulation
    readers: dict[str, Reader] = {}

    def show(diagnostic: Any) -> None:
        print(diagnostic.message, file=sys.stderr)

    for wire in wires:
        options: dict[str, Any] = {}
        handlers: dict[str, Any] = {}
        if wire == "ros1":
            stack.enter_context(_master(master_uri({})))
        elif wire == "foxglove":
            options = {"name": "load", "port": 0}
            handlers = {"state": (SimulationControls(simulation).state, False)}
        elif wire == "record":
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            options = {"path": f"{folder}/load.mcap", "topics": ["/load/*"]}
        else:
            options = {"rmw": "zenoh" if wire == "zenoh" else "dds", "parameters": []}
        kind = {"record": "recording", "zenoh": "ros2"}.get(wire, wire)
        bridge = BridgeProcess(kind, wire, patient=wire == "record")
        stack.callback(bridge.close)
        processes.append(bridge.pid)
        opened = bridge.open(
            graph,
            options,
            time_ns=lambda: simulation.time_ns,
            echo=wire == "foxglove",
            report=show,
            handlers=handlers,
        )
        started = bridge.call("start")
        if wire != "record":
            address = {"foxglove": started, "ros1": opened and opened[-1]}.get(wire, "")
            readers[wire] = Reader(wire, address)
            stack.callback(readers[wire].close)
    return readers


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wires", nargs="+", choices=WIRES)
    parser.add_argument("--pairs", type=int, default=8)
    parser.add_argument("--turn", type=float, default=1.0, help="wall time in s")
    given = parser.parse_args()
    print(json.dumps(run(given.wires, given.pairs, given.turn)))
