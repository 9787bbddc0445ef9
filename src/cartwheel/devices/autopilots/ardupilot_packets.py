"""Packets that ArduPilot's SITL and a simulator exchange. Every function is pure.

Sources: ``libraries/SITL/SIM_JSON.cpp`` and ``SIM_Gazebo.cpp`` in ArduPilot.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.geometry import Pose, Quat, Vec3, to_wxyz

LONGEST = 72
"""Length of the longest packet, bytes."""
_MAGIC = {16: 18458, 32: 29569}
"""First number of a packet of the JSON interface, by the number of channels."""
_LENGTHS = {struct.calcsize(f"<HHI{count}H"): count for count in _MAGIC}
"""Number of channels by the length of the packet."""
_BINARY = struct.Struct("<16f")
_BINARY_STATE = struct.Struct("<17d")

Protocol = Literal["json", "binary"]


@dataclass(frozen=True, slots=True)
class ServoPacket:
    """Outputs of the autopilot."""

    protocol: Protocol
    """The interface, in which the state is sent back."""
    frame: int | None
    """Number of the packet; None: the packets of the binary interface have no number."""
    outputs: tuple[float, ...]
    """Output of each channel: pulse width in µs, or a number from -1 to 1 (binary)."""


Fault = Literal["length", "magic", "number"]
"""Reason why a packet is invalid."""


def decode(data: bytes) -> ServoPacket | Fault:
    """Decodes a packet from the autopilot, whose length determines the interface.

    Returns:
        The packet, or the reason why it is invalid.
    """
    if len(data) == _BINARY.size:
        speeds = _BINARY.unpack(data)
        if not all(map(math.isfinite, speeds)):
            return "number"
        return ServoPacket("binary", None, tuple(min(max(s, -1.0), 1.0) for s in speeds))
    count = _LENGTHS.get(len(data))
    if count is None:
        return "length"
    magic, _, frame, *widths = struct.unpack(f"<HHI{count}H", data)
    if magic != _MAGIC[count]:
        return "magic"
    return ServoPacket("json", frame, tuple(map(float, widths)))


@dataclass(frozen=True, kw_only=True, slots=True)
class VehicleState:
    """State of the vehicle that the autopilot's simulated sensors measure.

    World axes are north, east, down. Body axes are forward, right, down.
    """

    seconds: float
    """Simulation time, s."""
    rates: Sequence[float]
    """Angular velocity in the axes of the IMU, rad/s."""
    acceleration: Sequence[float]
    """Proper acceleration in the axes of the IMU, m/s²."""
    pose: Pose
    """Pose of the body in the world."""
    velocity: Vec3
    """Velocity in the world, m/s."""
    ranges: Sequence[float] = ()
    """Distances that up to six rangefinders measure, m."""


def encode_json(state: VehicleState, *, time_sync: bool, lock_step: bool) -> bytes:
    """Encodes the state for the JSON interface: one line of text.

    Args:
        state: The state.
        time_sync: Whether SITL synchronises itself with the wall clock.
        lock_step: Whether SITL waits for each state.
    """
    document = {
        "timestamp": state.seconds,
        "imu": {"gyro": list(state.rates), "accel_body": list(state.acceleration)},
        "position": list(state.pose.position),
        "quaternion": list(to_wxyz(state.pose.orientation)),
        "velocity": list(state.velocity),
        **{f"rng_{number}": value for number, value in enumerate(state.ranges, start=1)},
        "no_time_sync": not time_sync,
        "no_lockstep": not lock_step,
    }
    return f"\n{json.dumps(document, separators=(',', ':'))}\n".encode()


def encode_binary(state: VehicleState) -> bytes:
    """Encodes the state for the interface that Gazebo Classic's plugin uses: 17 numbers."""
    quaternion: Quat = to_wxyz(state.pose.orientation)
    return _BINARY_STATE.pack(
        state.seconds,
        *state.rates,
        *state.acceleration,
        *quaternion,
        *state.velocity,
        *state.pose.position,
    )
