"""Messages in ROS 1's encoding, against rosbags' own and against Debian's genpy."""

import functools
import hashlib
import json
import math
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore
from tests.coded import raises
from tests.messages.test_definitions import MESSAGES, SERVICES

from cartwheel.codes.graph import MESSAGE_NOT_DECODABLE, MESSAGE_NOT_ENCODABLE, MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import GraphError
from cartwheel.messages import from_dict, message_class, store, zero
from cartwheel.messages.fields import fields
from cartwheel.messages.ros1 import (
    decode_ros1,
    encode_ros1,
    ros1_name,
    ros1_service,
    ros1_type,
    write_ros1,
)
from cartwheel.messages.store import definitions


@functools.cache
def noetic() -> Any:
    return get_typestore(Stores.ROS1_NOETIC)


@functools.cache
def shared() -> list[str]:
    """The messages that ROS 1 and ROS 2 have."""
    known = store().fielddefs
    return sorted(name for name in noetic().fielddefs if name in known and "/msg/" in name)


def test_types_have_the_names_and_sums_of_ros1() -> None:
    for found in (
        {name: ros1_type(name) for name in MESSAGES},
        {name: ros1_type(name.replace("/", "/msg/")) for name in MESSAGES},
    ):
        assert {each.name: each.md5 for each in found.values()} == MESSAGES
        assert [each.name for each in found.values()] == list(found)


def test_services_have_the_names_and_sums_of_ros1() -> None:
    found = {name: ros1_service(name) for name in SERVICES}
    assert {each.name: each.md5 for each in found.values()} == SERVICES
    assert [each.name for each in found.values()] == list(found)


def test_all_types_have_sums() -> None:
    names = [name for name, _ in definitions()]
    assert len(names) > 150
    for name in names:
        if name.endswith("_Request"):
            assert len(ros1_service(name.removesuffix("_Request")).md5) == 32
        elif "/msg/" in name:
            assert len(ros1_type(name).md5) == 32


def test_a_definition_holds_what_is_within() -> None:
    text = ros1_type("nav_msgs/msg/Odometry").definition
    first, *rest = text.split("=" * 80 + "\n")
    assert first.startswith("std_msgs/Header header\nstring child_frame_id\n")
    names = {part.partition("\n")[0].removeprefix("MSG: ") for part in rest}
    assert names == {
        "std_msgs/Header",
        *(f"geometry_msgs/{name}" for name in (
            "PoseWithCovariance", "Pose", "Point", "Quaternion", "TwistWithCovariance", "Twist",
            "Vector3",
        )),
    }  # fmt: skip
    assert "uint32 seq\ntime stamp\nstring frame_id\n" in text


def test_names_lose_their_middle() -> None:
    assert ros1_name("sensor_msgs/msg/Image") == "sensor_msgs/Image"
    assert ros1_name("std_srvs/srv/Empty") == "std_srvs/Empty"


def test_what_ros1_lacks_is_refused() -> None:
    with raises(MESSAGE_TYPE_UNKNOWN):
        ros1_type("rcl_interfaces/msg/Parameter")
    with raises(MESSAGE_TYPE_UNKNOWN, name="nav_msgs/srv/Nonsense"):
        ros1_service("nav_msgs/srv/Nonsense")


def filled(name: str, seed: int = 0) -> Any:
    """A message whose every field has a value of its own."""
    count = iter(range(seed, 10_000))

    def fill(value: Any) -> Any:
        if hasattr(value, "__msgtype__"):
            for field in fields(value.__msgtype__):
                setattr(value, field.name, fill(getattr(value, field.name)))
        elif isinstance(value, np.ndarray):
            size = len(value) or 3
            return (np.arange(size) + next(count) % 100).astype(value.dtype)
        elif isinstance(value, bool):
            return next(count) % 2 == 0
        elif isinstance(value, str):
            return f"text {next(count)} ü"
        elif isinstance(value, int):
            return next(count) % 120
        elif isinstance(value, float):
            return next(count) / 7
        return value

    return fill(zero(name))


def test_every_type_is_read_by_rosbags_and_comes_back() -> None:
    assert len(shared()) > 100
    for name in shared():
        check_reading(name)


def check_reading(name: str) -> None:
    message = filled(name)
    data = encode_ros1(message, seq=7)
    theirs = noetic().deserialize_ros1(data, name)
    assert bytes(noetic().serialize_ros1(theirs, name)) == data, name
    back = decode_ros1(data, name)
    assert encode_ros1(back, seq=7) == data, name
    own = [field for field, _ in noetic().fielddefs[name][1]]
    for field in {field.name for field in fields(name)} & set(own):
        ours, other = getattr(message, field), getattr(theirs, field)
        if isinstance(ours, np.ndarray):
            assert np.array_equal(ours, other), (name, field)
        elif isinstance(ours, int | str):
            assert ours == other, (name, field)
        elif isinstance(ours, float):
            # It may have 32 bits.
            assert math.isclose(ours, other, rel_tol=1e-6), (name, field)


def test_seq_is_the_outer_headers_alone() -> None:
    transforms = [filled("geometry_msgs/TransformStamped", i) for i in (0, 50)]
    message = message_class("tf2_msgs/TFMessage")(transforms=transforms)
    data = encode_ros1(message, seq=9)
    # A count, then each transform's header, whose first field it is.
    assert struct.unpack_from("<II", data) == (2, 0)
    image = encode_ros1(zero("sensor_msgs/Image"), seq=9)
    assert struct.unpack_from("<I", image) == (9,)
    assert encode_ros1(zero("sensor_msgs/Image"), seq=(1 << 32) + 5)[:4] == b"\5\0\0\0"


def test_camera_info_has_ros1s_capitals() -> None:
    message = from_dict("sensor_msgs/CameraInfo", {"K": list(range(9)), "D": [1.0, 2.0]})
    theirs = noetic().deserialize_ros1(encode_ros1(message), "sensor_msgs/msg/CameraInfo")
    assert theirs.K.tolist() == list(range(9))
    assert theirs.D.tolist() == [1.0, 2.0]
    back = decode_ros1(encode_ros1(message), "sensor_msgs/CameraInfo")
    assert back.k.tolist() == list(range(9))


def test_what_ros1_lacks_in_a_message_is_left_out() -> None:
    message = zero("sensor_msgs/Range")
    message.range, message.variance = 1.5, 0.25
    data = encode_ros1(message)
    theirs = noetic().deserialize_ros1(data, "sensor_msgs/msg/Range")
    assert theirs.range == 1.5
    assert decode_ros1(data, "sensor_msgs/Range").variance == 0.0


def test_a_large_array_is_not_copied_before_it_is_joined() -> None:
    message = zero("sensor_msgs/Image")
    message.data = np.arange(921_600, dtype=np.uint8)
    views = [part for part in write_ros1(message) if isinstance(part, memoryview)]
    assert [view.obj is message.data for view in views] == [True]


def test_lists_and_other_number_types_are_taken_as_arrays() -> None:
    message = zero("sensor_msgs/JointState")
    message.name, message.position = ["a", "b"], [1, 2]
    message.velocity = np.arange(8, dtype=np.float32)[::4]
    back = decode_ros1(encode_ros1(message), "sensor_msgs/JointState")
    assert back.position.tolist() == [1.0, 2.0]
    assert back.velocity.tolist() == [0.0, 4.0]


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [
        ("sensor_msgs/Image", "width", -1),
        ("sensor_msgs/Image", "width", "wide"),
        ("sensor_msgs/CameraInfo", "k", np.zeros(8)),
    ],
)
def test_values_that_do_not_fit_are_reported(name: str, field: str, value: Any) -> None:
    message = zero(name)
    setattr(message, field, value)
    with raises(MESSAGE_NOT_ENCODABLE, type=message.__msgtype__):
        encode_ros1(message)


def test_cut_and_padded_bytes_are_refused() -> None:
    data = encode_ros1(filled("nav_msgs/Odometry"))
    for length in range(len(data)):
        with raises(MESSAGE_NOT_DECODABLE):
            decode_ros1(data[:length], "nav_msgs/Odometry")
    with raises(MESSAGE_NOT_DECODABLE):
        decode_ros1(data + b"\0", "nav_msgs/Odometry")


@given(st.binary(max_size=200), st.deferred(lambda: st.sampled_from(shared())))
def test_any_bytes_are_a_message_or_refused(data: bytes, name: str) -> None:
    try:
        message = decode_ros1(data, name)
    except GraphError:
        return
    written = encode_ros1(message)
    assert encode_ros1(decode_ros1(written, name)) == written


def test_a_huge_count_takes_no_memory() -> None:
    data = struct.pack("<I", 0xFFFFFFFF)
    with pytest.raises(GraphError):
        decode_ros1(data, "std_msgs/String")
    with pytest.raises(GraphError):
        decode_ros1(data, "tf2_msgs/TFMessage")


GENPY = """
import sys, json, hashlib
sys.path.append("/usr/lib/python3/dist-packages")
from roslib.message import get_message_class
found = {}
for name in json.loads(sys.argv[1]):
    made = get_message_class(name)
    if made is None:
        continue
    message = made()
    data = bytes.fromhex(json.loads(sys.argv[2])[name])
    message.deserialize(data)
    import io
    out = io.BytesIO()
    message.serialize(out)
    found[name] = [made._md5sum, made._type, out.getvalue().hex()]
print(json.dumps(found))
"""


def test_debians_genpy_has_the_same_types_and_reads_the_same_bytes() -> None:
    if not Path("/usr/lib/python3/dist-packages/roslib").is_dir():
        pytest.skip("Debian's python3-roslib is not installed")
    names = [name.replace("/msg/", "/") for name in shared()]
    data = {name: encode_ros1(filled(name), seq=3).hex() for name in names}
    done = subprocess.run(
        ["/usr/bin/python3", "-c", GENPY, json.dumps(names), json.dumps(data)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    theirs = json.loads(done.stdout)
    assert {"sensor_msgs/Image", "nav_msgs/Odometry", "geometry_msgs/Twist"} <= set(theirs)
    for name, (md5, type_name, written) in theirs.items():
        assert (md5, type_name) == (ros1_type(name).md5, name)
        assert written == data[name], name


def test_a_sum_is_that_of_the_text_that_ros1_prints() -> None:
    # std_msgs/String: the simplest text that can be hashed by hand.
    assert ros1_type("std_msgs/String").md5 == hashlib.md5(b"string data").hexdigest()
