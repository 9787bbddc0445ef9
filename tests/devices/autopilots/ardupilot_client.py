"""A small client of ArduPilot's protocols, which stands in for SITL."""

from __future__ import annotations

import json
import socket
import struct
import threading

import numpy as np
from tests.devices.autopilots.quadcopter import Motion, outputs

PATIENCE = 0.2
"""Time after which the client repeats its packet, s."""
REPEATS = 100


def pulses(speeds):
    """Returns pulse widths in µs for outputs from 0 to 1."""
    return [round(1100 + 800 * speed) for speed in speeds]


def servo_packet(frame, widths, *, count=16, magic=None):
    """Returns a packet of the JSON interface."""
    magic = {16: 18458, 32: 29569}[count] if magic is None else magic
    widths = [*widths, *[0] * (count - len(widths))]
    return struct.pack(f"<HHI{count}H", magic, 500, frame, *widths)


def motion_of(reply):
    """Decodes a state in either format."""
    if reply.startswith(b"\n{"):
        state = json.loads(reply)
        return Motion(
            state["timestamp"],
            np.array(state["imu"]["gyro"]),
            np.array(state["quaternion"]),
            np.array(state["position"]),
            np.array(state["velocity"]),
        )
    values = np.array(struct.unpack("<17d", reply))
    return Motion(float(values[0]), values[1:4], values[7:11], values[14:17], values[11:14])


class Client:
    """A socket on which a test sends packets and receives states."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(PATIENCE)

    def send(self, data):
        self.socket.send(data)

    def receive(self):
        """Returns the next datagram, or None if none arrives in time."""
        try:
            return self.socket.recv(4096)
        except TimeoutError:
            return None

    def close(self):
        self.socket.close()


class Pilot(threading.Thread):
    """Flies the quadcopter in lock step.

    Args:
        port: UDP port of the simulation.
        binary: Uses the binary interface instead of the JSON interface.
        lost: Numbers of frames whose first packets are not sent, as if they were lost.
    """

    def __init__(self, port, *, binary=False, lost=()):
        super().__init__(daemon=True)
        self.client = Client(port)
        self.binary = binary
        self.lost = set(lost)
        self.began, self.ended = threading.Event(), threading.Event()
        self.motions = []

    def packet(self, frame, speeds):
        if self.binary:
            return struct.pack("<16f", *speeds, *[0.0] * 12)
        return servo_packet(frame, pulses(speeds))

    def run(self):
        frame, speeds = 0, [0.0] * 4
        while not self.ended.is_set():
            data = self.packet(frame, speeds)
            for _ in range(REPEATS):
                # On the loopback interface, a packet has arrived as soon as it is sent.
                if frame in self.lost:
                    self.lost.remove(frame)
                else:
                    self.client.send(data)
                self.began.set()
                reply = self.client.receive()
                if reply is not None or self.ended.is_set():
                    break
            if reply is None:
                break
            motion = motion_of(reply)
            self.motions.append(motion)
            speeds = outputs(motion)
            frame += 1

    def stop(self):
        self.ended.set()
        self.join(timeout=30)
        self.client.close()
        assert not self.is_alive()
