"""ArduPilot's packets, and what is made of invalid ones."""

import json
import math
import struct

import pytest
from tests.devices.autopilots.ardupilot_client import servo_packet

from cartwheel.devices.autopilots.ardupilot_packets import (
    ServoPacket,
    VehicleState,
    decode,
    encode_binary,
    encode_json,
)
from cartwheel.geometry import Pose, quat_from_rpy


@pytest.mark.parametrize("count", [16, 32])
def test_the_length_of_a_packet_is_the_number_of_channels(count):
    widths = [1000 + n for n in range(count)]
    packet = decode(servo_packet(7, widths, count=count))
    assert packet == ServoPacket("json", 7, tuple(map(float, widths)))


def test_a_packet_of_sixteen_numbers_is_binary():
    packet = decode(struct.pack("<16f", 0.5, -3.0, 3.0, *[0.0] * 13))
    assert packet == ServoPacket("binary", None, (0.5, -1.0, 1.0, *[0.0] * 13))


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (b"", "length"),
        (b"\0", "length"),
        (servo_packet(0, [1500])[:-1], "length"),
        (servo_packet(0, [1500]) + b"\0", "length"),
        (b"{}" * 40, "length"),
        (servo_packet(0, [1500], magic=18457), "magic"),
        (servo_packet(0, [1500], magic=29569), "magic"),
        (servo_packet(0, [1500], count=32, magic=18458), "magic"),
        (struct.pack("<16f", math.nan, *[0.0] * 15), "number"),
        (struct.pack("<16f", *[0.0] * 15, math.inf), "number"),
    ],
)
def test_an_invalid_packet_has_a_reason(data, fault):
    assert decode(data) == fault


STATE = VehicleState(
    seconds=1.5,
    rates=[1.0, 2.0, 3.0],
    acceleration=[4.0, 5.0, -9.8],
    pose=Pose((7.0, 8.0, -9.0), quat_from_rpy(0.0, 0.0, math.pi / 2)),
    velocity=(10.0, 11.0, 12.0),
    ranges=(13.0, 14.0),
)
HALF = math.sqrt(0.5)


def test_the_json_state():
    text = encode_json(STATE, time_sync=False, lock_step=True)
    assert text.startswith(b"\n{")
    assert text.endswith(b"}\n")
    state = json.loads(text)
    assert state.pop("quaternion") == pytest.approx([HALF, 0.0, 0.0, HALF])
    assert state == {
        "timestamp": 1.5,
        "imu": {"gyro": [1.0, 2.0, 3.0], "accel_body": [4.0, 5.0, -9.8]},
        "position": [7.0, 8.0, -9.0],
        "velocity": [10.0, 11.0, 12.0],
        "rng_1": 13.0,
        "rng_2": 14.0,
        "no_time_sync": True,
        "no_lockstep": False,
    }


def test_the_binary_state():
    expected = [1.5, 1, 2, 3, 4, 5, -9.8, HALF, 0, 0, HALF, 10, 11, 12, 7, 8, -9]
    assert struct.unpack("<17d", encode_binary(STATE)) == pytest.approx(expected)
