"""What a Foxglove client costs a simulation that runs in real time, and how late messages come.

The cart with an image of 640x480 at 30 Hz, odometry, transforms and IMU, first read in process
and then by a client over the socket, which is a process of its own that throws away what it
reads. The images are made beforehand, so that what is measured is the way out.

    python -m benchmarks.foxglove_load
"""

from __future__ import annotations

import argparse
import gc
import json
import struct
import subprocess
import sys
import threading
import time
from typing import Any

WIDTH, HEIGHT = 640, 480
IMAGE = "/camera/image_raw"
TOPICS = (IMAGE, "/odom", "/tf", "/imu/data")
FRAME_AT = 4 + 8 + 4
"""Where the frame id is in an image's bytes; here it is the time at which it was published."""


def read(url: str) -> None:
    """Reads for ever; at a line on standard input prints what came since the last."""
    from websockets.sync.client import connect

    counts = dict.fromkeys(TOPICS, 0)
    late: list[float] = []

    def answer() -> None:
        for _ in sys.stdin:
            found = sorted(late) or [0.0]
            print(
                json.dumps(
                    {
                        "counts": counts,
                        "median": found[len(found) // 2],
                        "worst": found[-1],
                    }
                ),
                flush=True,
            )

    threading.Thread(target=answer, daemon=True).start()
    topics: dict[int, str] = {}
    with connect(url, subprotocols=["foxglove.sdk.v1"], max_size=None) as link:  # type: ignore[list-item]
        for message in link:
            if isinstance(message, str):
                body = json.loads(message)
                if body["op"] != "advertise":
                    continue
                wanted = [c for c in body["channels"] if c["topic"] in TOPICS]
                topics.update({c["id"]: c["topic"] for c in wanted})
                asked = [{"id": c["id"], "channelId": c["id"]} for c in wanted]
                link.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
            elif message[0] == 1:
                (subscription,) = struct.unpack_from("<I", message, 1)
                topic = topics[subscription]
                counts[topic] += 1
                if topic == IMAGE:
                    frame = message[13 + FRAME_AT : 13 + FRAME_AT + 19]
                    late.append((time.time_ns() - int(frame)) / 1e6)


def run(seconds: float) -> None:
    import numpy as np

    from cartwheel.bridges.foxglove import FoxgloveBridge
    from cartwheel.cli.commands.foxglove import SimulationControls
    from cartwheel.description import load_robot, load_world
    from cartwheel.messages import header, message_class
    from cartwheel.session import Session

    session = Session(load_world("empty"))
    simulation, graph = session.simulation, session.graph
    session.spawn(load_robot("rosbots.xacro"))
    publisher = graph.advertise(IMAGE, "sensor_msgs/msg/Image", rate=30.0)
    pixels = np.random.default_rng(0).integers(0, 255, WIDTH * HEIGHT * 3, dtype=np.uint8)

    def publish() -> None:
        publisher.publish(
            message_class("sensor_msgs/msg/Image")(
                header=header(simulation.time_ns, str(time.time_ns())),
                height=HEIGHT,
                width=WIDTH,
                encoding="rgb8",
                is_bigendian=0,
                step=3 * WIDTH,
                data=pixels,
            )
        )

    simulation.schedule(30.0, after=publish, active=lambda: publisher.wanted)
    bridge = FoxgloveBridge(
        graph, name="benchmark", port=0, controls=SimulationControls(simulation)
    )
    bridge.start()
    gc.freeze()
    pacer = session.pacer()

    def go(title: str) -> None:
        """Runs for some seconds of wall time, and says what that cost."""
        timer = threading.Timer(seconds, lambda: simulation.post(simulation.stop))
        simulation.run_state = type(simulation.run_state).RUNNING
        process, owner, wall = time.process_time(), time.thread_time(), time.perf_counter()
        timer.start()
        pacer.run()
        wall = time.perf_counter() - wall
        print(
            f"{title:10s} process {100 * (time.process_time() - process) / wall:5.1f} % of a core,"
            f" simulation's thread {100 * (time.thread_time() - owner) / wall:5.1f} %,"
            f" {simulation.real_time_factor:.2f} times real time"
        )

    taps = [graph.subscribe(topic, lambda _: None) for topic in TOPICS]
    go("in process")
    for tap in taps:
        tap.close()
    reader = subprocess.Popen(
        [sys.executable, "-m", "benchmarks.foxglove_load", "--read", bridge.url],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert reader.stdin is not None and reader.stdout is not None
    while not publisher.wanted:
        time.sleep(0.05)
    go("a client")
    reader.stdin.write("\n")
    reader.stdin.flush()
    found: dict[str, Any] = json.loads(reader.stdout.readline())
    rates = ", ".join(f"{name} {count / seconds:.0f} Hz" for name, count in found["counts"].items())
    print(f"received   {rates}")
    print(f"images     {found['median']:.1f} ms late, at worst {found['worst']:.1f} ms")
    reader.kill()
    reader.wait()
    bridge.close()
    session.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--read", metavar="URL", help="be the client")
    given = parser.parse_args()
    if given.read:
        read(given.read)
    else:
        run(given.seconds)


if __name__ == "__main__":
    main()
