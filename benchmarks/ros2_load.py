"""What a ROS 2 reader over DDS costs a simulation that runs in real time.

A process reads images of 640x480 at 30 Hz, odometry, transforms and IMU at 100 Hz, and
tells how old each message was when it came. The images are made beforehand, so that what is
measured is the way out and not the renderer. Without the reader the same run is the baseline.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np

IMAGE, ODOM = ("/camera/image_raw", "sensor_msgs/msg/Image"), ("/odom", "nav_msgs/msg/Odometry")
TF, IMU = ("/tf", "tf2_msgs/msg/TFMessage"), ("/imu/data", "sensor_msgs/msg/Imu")
SENSORS = (IMAGE, IMU)
RATES = {IMAGE: 30.0, ODOM: 100.0, TF: 100.0, IMU: 100.0}


def read() -> None:
    """Reads until its standard input ends, then prints counts and ages in ms."""
    from cartwheel.bridges.loop import Loop
    from cartwheel.bridges.ros2.rtps.discovery import EndpointQos
    from cartwheel.bridges.ros2.rtps.network import Reach, domain_id
    from cartwheel.bridges.ros2.rtps.participant import Participant
    from cartwheel.messages import decode_cdr
    from cartwheel.messages.ros2_types import ros2_type

    loop = Loop(lambda error: print(error, file=sys.stderr), name="reader")
    participant = Participant(
        loop, domain=domain_id(), reach=Reach.of(), name="reader", user_data=b"", tell=print
    )
    ages: dict[str, list[float]] = {topic: [] for topic, _ in RATES}

    def reader(topic: str, type_name: str, *, reliable: bool) -> None:
        def take(taken: Any) -> None:
            now = time.time_ns()
            message = decode_cdr(taken.payload, type_name)
            header = message.transforms[0].header if topic == TF[0] else message.header
            ages[topic].append((now - header.stamp.sec * 10**9 - header.stamp.nanosec) / 1e6)

        participant.reader(
            f"rt{topic}", ros2_type(type_name).dds, EndpointQos(reliable=reliable), take
        )

    def begin() -> None:
        participant.start()
        for pair in RATES:
            reader(*pair, reliable=pair not in SENSORS)

    loop.start()
    loop.call(begin).result()
    print("ready", flush=True)
    sys.stdin.read()
    for topic, found in ages.items():
        half, most = np.percentile(found, [50, 99]) if found else (0.0, 0.0)
        print(f"{topic} {len(found)} {half:.2f} {most:.2f}", flush=True)
    loop.call(participant.close).result()


def run(seconds: float, *, with_reader: bool) -> dict[str, Any]:
    """One run; CPU seconds a second of the whole process and of the simulation's thread."""
    from cartwheel.bridges.ros2 import Ros2Bridge
    from cartwheel.description import load_world
    from cartwheel.messages import header, zero
    from cartwheel.session import Session

    session = Session(load_world("empty"))
    simulation, graph = session.simulation, session.graph
    pixels = np.zeros(640 * 480 * 3, np.uint8)

    def publish(pair: tuple[str, str], publisher: Any) -> None:
        message = zero(pair[1])
        stamped = header(time.time_ns(), "frame")
        if pair is TF:
            message.transforms = [zero("geometry_msgs/msg/TransformStamped") for _ in range(10)]
            message.transforms[0].header = stamped
        else:
            message.header = stamped
        if pair is IMAGE:
            message.width, message.height, message.step, message.data = 640, 480, 1920, pixels
        publisher.publish(message)

    for pair, rate in RATES.items():
        made = graph.advertise(*pair, rate=rate, qos="sensor" if pair in SENSORS else "default")
        simulation.schedule(
            rate,
            after=lambda pair=pair, made=made: publish(pair, made),  # type: ignore[misc]
            active=lambda made=made: made.wanted,  # type: ignore[misc]
        )
    bridge = Ros2Bridge(graph, time_ns=lambda: simulation.time_ns)
    bridge.start()
    used = {}

    def own() -> None:
        start = time.thread_time()
        session.pacer(until_ns=round(seconds * 1e9)).run()
        used["thread"] = (time.thread_time() - start) / seconds

    reader = None
    if with_reader:
        reader = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.ros2_load", "--read"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert reader.stdout is not None
        reader.stdout.readline()
        time.sleep(2.0)
    thread = threading.Thread(target=own)
    wall, cpu = time.perf_counter(), time.process_time()
    thread.start()
    thread.join()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    lines: list[str] = []
    if reader is not None:
        lines = reader.communicate()[0].splitlines()
    bridge.close()
    session.close()
    return {
        "cpu": cpu / seconds,
        "thread": used["thread"],
        "factor": seconds / wall,
        "dropped": bridge.dropped,
        "lines": lines,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--read", action="store_true")
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    if given.read:
        read()
        return
    os.environ.setdefault("ROS_DOMAIN_ID", "83")
    print("reader  CPU s/s  simulation's thread  real-time factor  dropped")
    for with_reader in (False, True):
        found = run(given.seconds, with_reader=with_reader)
        print(
            f"{'yes' if with_reader else 'no':6}  {found['cpu']:7.3f}  {found['thread']:19.3f}"
            f"  {found['factor']:16.3f}  {found['dropped']:7}"
        )
        for line in found["lines"]:
            topic, count, half, most = line.split()
            rate = RATES[next(pair for pair in RATES if pair[0] == topic)]
            expected = round(rate * given.seconds)
            print(f"  {topic}: {count} of {expected}, median {half} ms, p99 {most} ms")


if __name__ == "__main__":
    main()
