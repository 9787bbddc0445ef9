"""Messages as CDR, against rosbags' own writer and against bytes laid out by hand."""

import random
import struct
from typing import Any

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.graph import MESSAGE_NOT_ENCODABLE
from cartwheel.errors import GraphError
from cartwheel.messages import (
    decode_cdr,
    encode_cdr,
    from_dict,
    header,
    message_class,
    store,
    zero,
)
from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields
from cartwheel.messages.store import is_bundled


def bundled_types() -> list[str]:
    """All types, without those that other tests have registered."""
    found = sorted(name for name in store().fielddefs if is_bundled(name))
    assert len(found) > 500
    return found


def grown(name: str, chance: random.Random) -> Any:
    """A message whose every field has a value by chance, and every list a length."""
    message = zero(name)
    for field in fields(name):
        count = field.length if field.length is not None else chance.randrange(3)
        if field.most:
            count = min(count, field.most)
        if not field.array:
            value = _one(field, chance)
        elif field.kind in ("string", "message"):
            value = [_one(field, chance) for _ in range(count)]
        else:
            value = np.array([_one(field, chance) for _ in range(count)], dtype=field.type)
        setattr(message, field.name, value)
    return message


def _one(field: Field, chance: random.Random) -> Any:
    if field.kind == "message":
        return grown(field.type, chance)
    if field.kind == "string":
        return "".join(chance.choices("abcü€", k=chance.randrange(6)))
    if field.kind == "bool":
        return chance.random() < 0.5
    if field.kind == "int":
        limits = np.iinfo(field.type)
        # rosbags takes half of the numbers that a byte may be.
        most = int(limits.max) if field.array or field.type != "uint8" else 127
        return chance.randint(int(limits.min), most)
    return chance.choice([0.0, -1.5, 0.1, 1e30])


def test_every_type_has_the_bytes_that_rosbags_writes() -> None:
    wrong = set()
    for name in bundled_types():
        chance = random.Random(name)
        for message in (zero(name), *(grown(name, chance) for _ in range(5))):
            if encode_cdr(message) != bytes(store().serialize_cdr(message, name)):
                wrong.add(name)
    assert not wrong


def test_lengths_that_are_not_cached_between_those_that_are() -> None:
    """Long strings and large arrays have a writer of their own, also within a list."""
    chance = random.Random(1)
    joints = "sensor_msgs/msg/JointState"
    for count in (0, 3, 2, 3, 600, 3, 70, 3):
        message = grown(joints, chance)
        message.name = [chance.choice("ab€") * chance.randrange(4) for _ in range(count)]
        message.header.frame_id = "f" * chance.choice([1, 5, 100])
        for field in ("position", "velocity", "effort"):
            setattr(message, field, np.arange(float(chance.choice([0, 1, count, 700]))))
        assert encode_cdr(message) == bytes(store().serialize_cdr(message, joints))
    markers = "visualization_msgs/msg/MarkerArray"
    for long in (0, 100, 1, 0, 100):
        message = zero(markers)
        message.markers = [grown("visualization_msgs/msg/Marker", chance) for _ in range(4)]
        message.markers[1].text = "t" * long
        message.markers[2].ns = "n" * long
        assert encode_cdr(message) == bytes(store().serialize_cdr(message, markers))


def test_more_layouts_than_are_kept() -> None:
    text = "std_msgs/msg/String"
    for number in range(1000):
        message = message_class(text)(f"{number:b}")
        assert encode_cdr(message) == bytes(store().serialize_cdr(message, text))


def test_numbers_lie_at_multiples_of_their_size() -> None:
    message = zero("geometry_msgs/TransformStamped")
    message.header = header(3_000_000_004, "ab")
    message.child_frame_id = "c"
    message.transform.translation.x = 1.5
    assert encode_cdr(message) == (
        b"\0\1\0\0"
        + struct.pack("<II", 3, 4)
        + struct.pack("<I", 3) + b"ab\0"
        + b"\0" + struct.pack("<I", 2) + b"c\0"
        + b"\0\0" + struct.pack("<7d", 1.5, 0, 0, 0, 0, 0, 1)
    )  # fmt: skip


def test_a_lone_byte_comes_back() -> None:
    data = b"\0\1\0\0\xc8"
    assert encode_cdr(decode_cdr(data, "std_msgs/Byte")) == data
    assert encode_cdr(decode_cdr(data, "std_msgs/UInt8")) == data


def test_empty_lists_are_but_their_count() -> None:
    # No room is left for numbers that are not there: what follows does.
    message = message_class("sensor_msgs/JointState")(
        header=header(0, ""), name=[], position=np.array([]), velocity=np.array([]),
        effort=np.array([]),
    )  # fmt: skip
    assert encode_cdr(message)[4:] == bytes(8) + b"\1\0\0\0\0" + bytes(3) + bytes(16)


def test_large_arrays_are_whole_however_they_lie_in_memory() -> None:
    picture = np.arange(60 * 80 * 3, dtype=np.uint8).reshape(60, 80, 3)
    image = zero("sensor_msgs/Image")
    for data in (picture.ravel(), picture[::-1].ravel(), picture.ravel()[::-1], picture):
        image.data = data
        back = decode_cdr(encode_cdr(image), "sensor_msgs/Image")
        assert back.data.tobytes() == data.tobytes()


def test_lists_of_numbers_are_taken_as_arrays() -> None:
    message = zero("sensor_msgs/JointState")
    message.position = [1, 2.5]
    back = decode_cdr(encode_cdr(message), "sensor_msgs/JointState")
    assert back.position.tolist() == [1.0, 2.5]


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [
        ("std_msgs/UInt8", "data", 256),
        ("std_msgs/UInt8", "data", "one"),
        ("std_msgs/String", "data", 5),
        ("std_msgs/String", "data", "\udc80"),
        ("std_msgs/Float64MultiArray", "data", ["x"]),
        ("sensor_msgs/CameraInfo", "k", np.zeros(8)),
        ("std_msgs/Header", "stamp", None),
        ("tf2_msgs/TFMessage", "transforms", [5]),
    ],
)
def test_what_does_not_fit_is_reported(name: str, field: str, value: Any) -> None:
    message = zero(name)
    setattr(message, field, value)
    with raises(MESSAGE_NOT_ENCODABLE):
        encode_cdr(message)


def test_zeros_after_a_message_are_taken_where_that_is_said() -> None:
    name = "geometry_msgs/msg/Twist"
    data = encode_cdr(from_dict(name, {"linear": {"x": 0.5}}))
    assert decode_cdr(data + bytes(64), name, padded=True).linear.x == 0.5
    for wrong, padded in ((data + bytes(64), False), (data + b"\0\0\0\0\1", True), (b"", True)):
        with pytest.raises(GraphError):
            decode_cdr(wrong, name, padded=padded)
