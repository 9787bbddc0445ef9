"""A small client of the protocol by which PX4's SITL talks to a simulator."""

from __future__ import annotations

import math
import socket
import struct
import threading

import numpy as np
from tests.devices.autopilots.quadcopter import FASTEST, Motion, outputs

from cartwheel.devices.autopilots import mavlink
from cartwheel.devices.autopilots.mavlink import FrameReader

PATIENCE = 10.0
"""Time after which the client gives up, s."""
IDLE = 100.0
"""Speed of the motors at output 0 while armed, rad/s."""
HOME = (47.397742, 8.545594, 488.0)
ARMED = 128
_LAYOUTS = {
    mavlink.SENSOR: ("<Q13fIB", 65),
    mavlink.GPS: ("<QiiiHHHhhhHBBBH", 39),
    mavlink.STATE: ("<Q7fiii3h2H3h", 64),
}


def fields(frame):
    """Returns the values in a frame, in the order of the payload."""
    layout, size = _LAYOUTS[frame.number]
    return struct.unpack(layout, frame.payload.ljust(size, b"\0"))


def heartbeat(sequence=0):
    return mavlink.encode(mavlink.HEARTBEAT, sequence, 0, 2, 12, 0, 4, 3)


def controls(sequence, values, *, armed=True, time_us=0):
    values = [*values, *[0.0] * (16 - len(values))]
    mode = 1 | (ARMED if armed else 0)
    return mavlink.encode(mavlink.ACTUATORS, sequence % 256, time_us, 1, *values, mode)


class Client:
    """A socket on which a test sends messages and receives frames."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.reader = FrameReader()
        self.frames = []

    def send(self, data):
        self.socket.sendall(data)

    def receive(self):
        """Returns the next frame, or None if the connection has ended."""
        while not self.frames:
            try:
                data = self.socket.recv(4096)
            except OSError:
                return None
            if not data:
                return None
            self.frames = list(self.reader.feed(data))
        return self.frames.pop(0)

    def close(self):
        self.socket.close()


def motion_of(state, sensor):
    """Returns the motion in HIL_STATE_QUATERNION, with the rates that the gyroscope measured."""
    radius = 6371000.0
    latitude, longitude, altitude = state[8] * 1e-7, state[9] * 1e-7, state[10] * 1e-3
    north = math.radians(latitude - HOME[0]) * radius
    east = math.radians(longitude - HOME[1]) * radius * math.cos(math.radians(HOME[0]))
    return Motion(
        state[0] * 1e-6,
        np.array(sensor[4:7]),
        np.array(state[1:5]),
        np.array([north, east, HOME[2] - altitude]),
        np.array(state[11:14]) * 0.01,
    )


class Pilot(threading.Thread):
    """Flies the quadcopter: for each HIL_SENSOR it sends HIL_ACTUATOR_CONTROLS.

    Args:
        port: TCP port of the simulation.
    """

    def __init__(self, port):
        super().__init__(daemon=True)
        self.client = Client(port)
        self.motions, self.sensors, self.fixes = [], [], []
        self.numbers = set()

    def run(self):
        self.client.send(heartbeat())
        sensor = None
        while (frame := self.client.receive()) is not None:
            self.numbers.add(frame.number)
            if frame.number == mavlink.SENSOR:
                sensor = fields(frame)
                self.sensors.append(sensor)
            elif frame.number == mavlink.GPS:
                self.fixes.append(fields(frame))
            elif frame.number == mavlink.STATE:
                # It follows the HIL_SENSOR of the same time.
                motion = motion_of(fields(frame), sensor)
                self.motions.append(motion)
                speeds = [(each * FASTEST - IDLE) / (FASTEST - IDLE) for each in outputs(motion)]
                data = controls(len(self.motions), [max(0.0, each) for each in speeds])
                try:
                    self.client.send(data)
                except OSError:
                    return

    def stop(self):
        self.client.socket.shutdown(socket.SHUT_RDWR)
        self.join(timeout=30)
        self.client.close()
        assert not self.is_alive()
