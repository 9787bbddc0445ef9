"""The MAVLink 2 frames that PX4 and a simulator exchange. Every function is pure.

Source: the message definitions in ``common.xml`` of MAVLink. A complete MAVLink library has about
300 message types and takes 90 MB; these are the six that are needed.
"""

from __future__ import annotations

import binascii
import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from cartwheel.geometry import Quat, Vec3, to_wxyz

STX = 0xFD
"""First byte of a frame."""
_HEAD = struct.Struct("<BBBBBBBHB")
"""STX, payload length, incompatibility flags, compatibility flags, sequence number, system,
component, and the message number in 24 bits."""
_SIGNED = 1
"""Incompatibility flag of a frame with a signature."""
_SIGNATURE = 13
"""Length of a signature, bytes."""
_CHECKSUM = 2
LONGEST = _HEAD.size + 255 + _CHECKSUM + _SIGNATURE
"""Length of the longest frame, bytes."""

HEARTBEAT: Final = 0
SYSTEM_TIME: Final = 2
ACTUATORS: Final = 93
SENSOR: Final = 107
GPS: Final = 113
STATE: Final = 115
_EXTRA = {HEARTBEAT: 50, SYSTEM_TIME: 137, ACTUATORS: 47, SENSOR: 108, GPS: 124, STATE: 4}
"""Checksum of each message's definition, which is part of a frame's checksum."""
_FORMATS = {
    HEARTBEAT: struct.Struct("<IBBBBB"),
    SYSTEM_TIME: struct.Struct("<QI"),
    ACTUATORS: struct.Struct("<QQ16fB"),
    SENSOR: struct.Struct("<Q13fIB"),
    GPS: struct.Struct("<QiiiHHHhhhHBBBH"),
    STATE: struct.Struct("<Q7fiii3h2H3h"),
}
_SYSTEM, _COMPONENT = 1, 200
"""Source of the simulator's messages, as in Gazebo."""
_ARMED = 128
"""``MAV_MODE_FLAG_SAFETY_ARMED``."""
_BIT_REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


@dataclass(frozen=True, slots=True)
class Frame:
    """A valid frame."""

    number: int
    """Number of the message."""
    payload: bytes


def checksum(data: bytes) -> int:
    """Returns the CRC-16/MCRF4XX of data.

    It is the CRC-16 of `binascii` with the bits of all bytes and of the result in reverse order.
    """
    crc = binascii.crc_hqx(data.translate(_BIT_REVERSED), 0xFFFF)
    return _BIT_REVERSED[crc >> 8] | _BIT_REVERSED[crc & 0xFF] << 8


def encode(number: int, sequence: int, *fields: float) -> bytes:
    """Encodes a message. Trailing zeros of the payload are omitted, as MAVLink 2 requires.

    Args:
        number: Number of the message.
        sequence: Number of the frame, from 0 to 255.
        fields: Values in the order of the payload.
    """
    payload = _FORMATS[number].pack(*fields).rstrip(b"\0") or b"\0"
    head = _HEAD.pack(
        STX, len(payload), 0, 0, sequence, _SYSTEM, _COMPONENT, number & 0xFFFF, number >> 16
    )
    crc = checksum(head[1:] + payload + bytes((_EXTRA[number],)))
    return head + payload + crc.to_bytes(_CHECKSUM, "little")


class FrameReader:
    """Finds the frames in a stream of bytes, and continues after bytes that belong to none."""

    def __init__(self) -> None:
        self._buffer = b""
        self.invalid = 0
        """Number of bytes that belong to no valid frame."""

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Adds bytes to the stream, and yields the valid frames that are complete now.

        Frames of messages that a simulator does not receive are skipped, because their checksum
        depends on their definition.
        """
        data = self._buffer + data
        at = 0
        while True:
            start = data.find(STX, at)
            if start < 0:
                self.invalid += len(data) - at
                at = len(data)
                break
            self.invalid += start - at
            at = start
            if len(data) - at < _HEAD.size:
                break
            _, length, flags, _, _, _, _, low, high = _HEAD.unpack_from(data, at)
            number = low | high << 16
            end = at + _HEAD.size + length + _CHECKSUM
            after = end + (_SIGNATURE if flags & _SIGNED else 0)
            if len(data) < after:
                break
            extra = _EXTRA.get(number)
            if extra is not None:
                body = data[at + 1 : end - _CHECKSUM]
                crc = int.from_bytes(data[end - _CHECKSUM : end], "little")
                if flags & ~_SIGNED or checksum(body + bytes((extra,))) != crc:
                    self.invalid += 1
                    at += 1
                    continue
                yield Frame(number, body[_HEAD.size - 1 :])
            at = after
        self._buffer = data[at:]


@dataclass(frozen=True, slots=True)
class Controls:
    """Outputs of PX4: message ``HIL_ACTUATOR_CONTROLS``."""

    outputs: tuple[float | None, ...]
    """Sixteen outputs from -1 to 1. None: the output is not a number."""
    armed: bool
    """Whether the motors may turn."""


def controls_of(payload: bytes) -> Controls:
    """Decodes ``HIL_ACTUATOR_CONTROLS``. A shorter payload ends with zeros that were omitted."""
    layout = _FORMATS[ACTUATORS]
    _, _, *outputs, mode = layout.unpack(payload[: layout.size].ljust(layout.size, b"\0"))
    return Controls(
        tuple(min(max(each, -1.0), 1.0) if math.isfinite(each) else None for each in outputs),
        bool(mode & _ARMED),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Measurements:
    """Measurements of the sensors. Axes are forward, right, down."""

    time_us: int
    """Simulation time, µs."""
    acceleration: Vec3 | None = None
    """Proper acceleration, m/s². None: not measured since the last message."""
    rates: Vec3 = (0.0, 0.0, 0.0)
    """Angular velocity, rad/s."""
    field: Vec3 | None = None
    """Magnetic field, Gauss. None: not measured since the last message."""
    pressure: float | None = None
    """Air pressure, hPa. None: not measured since the last message."""
    altitude: float = 0.0
    """Altitude that belongs to the pressure, m."""
    temperature: float = 0.0
    """Degrees Celsius."""


_NONE = (0.0, 0.0, 0.0)
_UPDATED = {"inertial": 0b111111, "field": 0b111 << 6, "pressure": 1 << 9 | 1 << 11 | 1 << 12}
"""Bits of ``fields_updated``."""


def encode_sensor(measured: Measurements, sequence: int) -> bytes:
    """Encodes ``HIL_SENSOR``."""
    updated = 0
    for name, value in (
        ("inertial", measured.acceleration),
        ("field", measured.field),
        ("pressure", measured.pressure),
    ):
        updated |= _UPDATED[name] if value is not None else 0
    return encode(
        SENSOR,
        sequence,
        measured.time_us,
        *(measured.acceleration or _NONE),
        *measured.rates,
        *(measured.field or _NONE),
        measured.pressure or 0.0,
        0.0,
        measured.altitude,
        measured.temperature,
        updated,
        0,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Fix:
    """Measurement of a satellite receiver."""

    time_us: int
    """Simulation time, µs."""
    place: Vec3
    """Latitude and longitude in degrees, altitude in m."""
    velocity: Vec3
    """North, east, down, m/s."""
    receiver: int = 0
    """Number of the receiver."""


def encode_gps(fix: Fix, sequence: int) -> bytes:
    """Encodes ``HIL_GPS`` with a 3D fix, ten satellites and an accuracy of 1 m."""
    north, east, down = fix.velocity
    course = round(math.degrees(math.atan2(east, north)) * 100) % 36000
    return encode(
        GPS,
        sequence,
        fix.time_us,
        *_geographic(fix.place),
        100,
        100,
        _short(100 * math.hypot(north, east), signed=False),
        *(_short(100 * each) for each in (north, east, down)),
        course,
        3,
        10,
        fix.receiver,
        0,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Truth:
    """True state of the vehicle.

    World axes are north, east, down. Body axes are forward, right, down.
    """

    time_us: int
    """Simulation time, µs."""
    orientation: Quat
    """Orientation of the body in the world."""
    rates: Vec3
    """Angular velocity in the body axes, rad/s."""
    place: Vec3
    """Latitude and longitude in degrees, altitude in m."""
    velocity: Vec3
    """Velocity in the world, m/s."""
    airspeed: float
    """Velocity along the body's x axis, m/s."""
    acceleration: Vec3
    """Acceleration in the world, m/s²."""


def encode_truth(truth: Truth, sequence: int) -> bytes:
    """Encodes ``HIL_STATE_QUATERNION``, with the acceleration in thousandths of g."""
    return encode(
        STATE,
        sequence,
        truth.time_us,
        *to_wxyz(truth.orientation),
        *truth.rates,
        *_geographic(truth.place),
        *(_short(100 * each) for each in truth.velocity),
        _short(100 * truth.airspeed, signed=False),
        _short(100 * math.hypot(*truth.velocity), signed=False),
        *(_short(1000 * each / 9.80665) for each in truth.acceleration),
    )


def encode_heartbeat(sequence: int) -> bytes:
    """Encodes ``HEARTBEAT`` of an active component other than an autopilot."""
    return encode(HEARTBEAT, sequence, 0, 0, 8, 0, 4, 3)


def encode_time(time_us: int, sequence: int) -> bytes:
    """Encodes ``SYSTEM_TIME`` for a simulation time in µs."""
    return encode(SYSTEM_TIME, sequence, time_us, time_us // 1000 & 0xFFFFFFFF)


def _geographic(place: Sequence[float]) -> tuple[int, int, int]:
    """Returns latitude and longitude in 1e-7 degrees and altitude in mm."""
    latitude, longitude, altitude = place
    most = 2**31 - 1
    return (
        round(latitude * 1e7),
        round(longitude * 1e7),
        round(min(max(altitude * 1000, -most), most)),
    )


def _short(value: float, *, signed: bool = True) -> int:
    """Returns a value as an integer with 16 bits, or the nearest one that has 16 bits."""
    low, high = (-(2**15), 2**15 - 1) if signed else (0, 2**16 - 1)
    return round(min(max(value, low), high))
