"""MAVLink 2 frames: literals from another implementation (pymavlink), and hostile bytes."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cartwheel.devices.autopilots import mavlink
from cartwheel.devices.autopilots.mavlink import (
    Fix,
    Frame,
    FrameReader,
    Measurements,
    Truth,
    controls_of,
    encode_gps,
    encode_heartbeat,
    encode_sensor,
    encode_time,
    encode_truth,
)

SENSOR = bytes.fromhex(
    "fd3e00000701c86b0000a00f0000000000000000003f000080be00001cc10000003e0000803e000000bf0000583e"
    "0000303c0000da3e00106f44000000000000f44300003c41ff1b2192"
)
GPS = bytes.fromhex(
    "fd2400000801c8710000c0d40100000000004c52401c44f41705bd720700640064001900f6ff1400fbff2823030a"
    "010d"
)
TRUTH = bytes.fromhex(
    "fd4000000901c8730000a00f0000000000000000003f0000803e000000be0000803f0000003e000000bf0000803e"
    "4c52401c44f41705bd720700f6ff1400fbff1e002800640038ff2c013d03"
)
HEARTBEAT = bytes.fromhex("fd0900000a01c80000000000000000080004033d88")
TIME = bytes.fromhex("fd0900000b01c8020000a00f000000000000040dea")
CONTROLS = bytes.fromhex(
    "fd5100000c01015d0000a00f00000000000001000000000000000000003f0000803e0000803f000080bf"
    + "00" * 48
    + "819812"
)
DISARMED = bytes.fromhex(
    "fd5100000d01015d0000401f0000000000000000000000000000" + "00" * 64 + "0198e7"
)


def test_the_checksum_is_that_of_mavlink():
    # The check value of CRC-16/MCRF4XX.
    assert mavlink.checksum(b"123456789") == 0x6F91


def test_sensors():
    measured = Measurements(
        time_us=4000,
        acceleration=(0.5, -0.25, -9.75),
        rates=(0.125, 0.25, -0.5),
        field=(0.2109375, 0.0107421875, 0.42578125),
        pressure=956.25,
        altitude=488.0,
        temperature=11.75,
    )
    assert encode_sensor(measured, 7) == SENSOR


def test_what_is_not_measured_is_not_marked():
    (frame,) = FrameReader().feed(encode_sensor(Measurements(time_us=1), 0))
    # Trailing zeros are omitted, so only the time remains.
    assert frame == Frame(mavlink.SENSOR, b"\x01")


def test_a_position():
    fix = Fix(time_us=120000, place=(47.397742, 8.545594, 488.125), velocity=(-0.1, 0.2, -0.05))
    # The other implementation was given a speed of 25 cm/s and a course of 90 degrees.
    made = encode_gps(fix, 8)
    assert made[:34] == GPS[:34]
    (frame,) = FrameReader().feed(made)
    speed = int.from_bytes(frame.payload[24:26], "little")
    course = int.from_bytes(frame.payload[32:34], "little")
    assert speed == round(100 * math.hypot(0.1, 0.2))
    assert course == round(100 * math.degrees(math.atan2(0.2, -0.1)))


def test_the_true_state():
    truth = Truth(
        time_us=4000,
        orientation=(0.25, -0.125, 1.0, 0.5),
        rates=(0.125, -0.5, 0.25),
        place=(47.397742, 8.545594, 488.125),
        velocity=(-0.1, 0.2, -0.05),
        airspeed=0.3,
        acceleration=(0.1 * 9.80665, -0.2 * 9.80665, 0.3 * 9.80665),
    )
    made = encode_truth(truth, 9)
    (ours,), (theirs,) = FrameReader().feed(made), FrameReader().feed(TRUTH)
    # The other implementation was given a true airspeed of 40 cm/s.
    assert ours.payload[:56] == theirs.payload[:56]
    assert ours.payload[58:] == theirs.payload[58:]
    assert int.from_bytes(ours.payload[56:58], "little") == round(100 * math.hypot(0.1, 0.2, 0.05))


def test_heartbeat_and_time():
    assert encode_heartbeat(10) == HEARTBEAT
    assert encode_time(4000, 11) == TIME


def test_values_beyond_the_range_of_a_message_are_limited():
    fast = Fix(time_us=0, place=(0.0, 0.0, 1e9), velocity=(1e6, -1e6, 0.0))
    (frame,) = FrameReader().feed(encode_gps(fast, 0))
    assert frame.payload[24:26] == b"\xff\xff"


def test_controls():
    (frame,) = FrameReader().feed(CONTROLS)
    controls = controls_of(frame.payload)
    assert controls.outputs == (0.5, 0.25, 1.0, -1.0, *[0.0] * 12)
    assert controls.armed
    (frame,) = FrameReader().feed(DISARMED)
    assert not controls_of(frame.payload).armed


def test_outputs_are_numbers_from_minus_1_to_1():
    values = [math.nan, math.inf, -math.inf, 1e30, -5.0, *[0.25] * 11]
    (frame,) = FrameReader().feed(mavlink.encode(mavlink.ACTUATORS, 0, 0, 0, *values, 128))
    assert controls_of(frame.payload).outputs[:6] == (None, None, None, 1.0, -1.0, 0.25)


def test_frames_arrive_in_pieces():
    reader = FrameReader()
    found = [frame for byte in CONTROLS + HEARTBEAT for frame in reader.feed(bytes((byte,)))]
    assert [frame.number for frame in found] == [mavlink.ACTUATORS, mavlink.HEARTBEAT]
    assert reader.invalid == 0


@pytest.mark.parametrize(
    ("garbage", "invalid"),
    [
        (b"nonsense", 8),
        (CONTROLS[:-1] + b"\0", len(CONTROLS)),
        # A flag that a receiver must understand, but does not.
        (HEARTBEAT[:2] + b"\x02" + HEARTBEAT[3:], len(HEARTBEAT)),
    ],
)
def test_the_reader_continues_after_invalid_bytes(garbage, invalid):
    reader = FrameReader()
    (frame,) = reader.feed(garbage + HEARTBEAT)
    assert frame.number == mavlink.HEARTBEAT
    assert reader.invalid == invalid


def test_messages_that_a_simulator_does_not_receive_are_skipped():
    unknown = b"\xfd\x03\x00\x00\x00\x01\x01\x4c\x00\x00abc\x00\x00"
    signed = b"\xfd\x03\x01\x00\x00\x01\x01\x4c\x00\x00abc\x00\x00" + b"s" * 13
    reader = FrameReader()
    assert [frame.number for frame in reader.feed(unknown + signed + HEARTBEAT)] == [0]
    assert reader.invalid == 0


@given(st.lists(st.binary(max_size=600), max_size=5))
def test_hostile_bytes_neither_fail_nor_pile_up(pieces):
    reader = FrameReader()
    for piece in pieces:
        for frame in reader.feed(piece):
            assert len(frame.payload) <= 255
    assert len(reader._buffer) <= mavlink.LONGEST
