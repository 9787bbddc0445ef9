"""Messages from and to mappings, CDR and text."""

import contextlib
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from tests.coded import raises
from tests.messages.cdr.test_cdr import bundled_types

from cartwheel.codes.graph import FIELD_UNKNOWN, FIELD_VALUE_INVALID, MESSAGE_NOT_DECODABLE
from cartwheel.errors import Code, GraphError, UnknownNameError
from cartwheel.messages import (
    CdrCache,
    checked,
    decode_cdr,
    encode_cdr,
    from_dict,
    from_flat,
    message_class,
    to_dict,
    to_yaml,
    zero,
)
from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields
from cartwheel.messages.fitting import fits
from cartwheel.msgs.geometry_msgs import PoseWithCovariance, TransformStamped, Vector3
from cartwheel.msgs.sensor_msgs import Image, JointState
from cartwheel.msgs.std_msgs import Bool, Header, String
from cartwheel.msgs.tf2_msgs import TFMessage
from cartwheel.msgs.trajectory_msgs import JointTrajectory, JointTrajectoryPoint

TYPES = [
    "builtin_interfaces/msg/Duration",
    "gazebo_msgs/msg/ContactsState",
    "gazebo_msgs/msg/ODEJointProperties",
    "gazebo_msgs/srv/GetJointProperties_Response",
    "geometry_msgs/msg/Twist",
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/PointCloud2",
    "shape_msgs/msg/SolidPrimitive",
    "std_srvs/srv/Empty_Request",
    "tf2_msgs/msg/TFMessage",
    "trajectory_msgs/msg/JointTrajectory",
]
SETTINGS = settings(max_examples=60)


# Texts that CDR can carry: it ends them with a zero and encodes them as UTF-8.
TEXTS = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=12)


def scalars(field: Field) -> st.SearchStrategy[Any]:
    if field.kind == "message":
        return mappings(field.type)
    if field.kind == "string":
        return TEXTS
    if field.kind == "bool":
        return st.booleans()
    if field.kind == "float":
        return st.floats(width=32 if field.type == "float32" else 64, allow_nan=False)
    limits = np.iinfo(field.type)
    return st.integers(int(limits.min), int(limits.max))


def values(field: Field) -> st.SearchStrategy[Any]:
    if not field.array:
        return scalars(field)
    if field.kind in ("message", "string"):
        length = field.length
        return st.lists(scalars(field), min_size=length or 0, max_size=length or 2)
    shape = st.just(field.length) if field.length else st.integers(0, field.most or 5)
    elements = {"allow_nan": False} if field.kind == "float" else None
    return npst.arrays(np.dtype(field.type), shape, elements=elements).map(lambda a: a.tolist())


def mappings(name: str) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({field.name: values(field) for field in fields(name)})


@SETTINGS
@given(data=st.data(), name=st.sampled_from(TYPES))
def test_every_way_out_leads_back(data: Any, name: str) -> None:
    mapping = data.draw(mappings(name))
    message = from_dict(name, mapping)
    assert to_dict(message) == mapping
    assert to_dict(decode_cdr(encode_cdr(message), name)) == mapping
    parsed = yaml.safe_load(to_yaml(message, full=True)) or {}
    assert to_dict(from_dict(name, parsed)) == mapping


def test_every_type_has_a_zero_that_can_be_sent() -> None:
    wrong = []
    for name in bundled_types():
        message = zero(name)
        if to_dict(decode_cdr(encode_cdr(message), name)) != to_dict(message):
            wrong.append(name)
        yaml.safe_load(to_yaml(message))
    assert not wrong


def test_missing_fields_are_zero() -> None:
    twist = from_dict("geometry_msgs/Twist", {"linear": {"x": 0.5}})
    assert to_dict(twist) == {
        "linear": {"x": 0.5, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": 0.0},
    }
    odometry = from_dict("nav_msgs/Odometry", {})
    assert odometry.pose.covariance.shape == (36,)


def test_joined_names_reach_inner_fields() -> None:
    twist = from_flat("geometry_msgs/Twist", {"linear_x": 0.5, "angular_z": 1, "linear_y": 2})
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (0.5, 2.0, 1.0)
    odometry = from_flat("nav_msgs/Odometry", {"header_frame_id": "a", "pose_pose_position_x": 3})
    assert (odometry.header.frame_id, odometry.pose.pose.position.x) == ("a", 3.0)
    assert from_flat("nav_msgs/Odometry", {"child_frame_id": "b"}).child_frame_id == "b"
    imu = from_flat("sensor_msgs/Imu", {"orientation_w": 1, "orientation_covariance": range(9)})
    assert (imu.orientation.w, list(imu.orientation_covariance)) == (1.0, list(range(9)))
    goal = from_flat("control_msgs/GripperCommandActionGoal", {"goal_id_id": "a"})
    assert goal.goal_id.id == "a"
    with raises(FIELD_UNKNOWN, field="linear.w"):
        from_flat("geometry_msgs/Twist", {"linear_w": 0.5})
    with raises(FIELD_UNKNOWN, field="speed"):
        from_flat("geometry_msgs/Twist", {"speed": 0.5})


def test_lists_stand_for_fields_in_order() -> None:
    twist = from_dict("geometry_msgs/Twist", [[1, 0, 0], [0, 0, 0.5]])
    assert (twist.linear.x, twist.angular.z) == (1.0, 0.5)


def test_spelling_of_ros1_is_understood() -> None:
    mapping = {"header": {"seq": 3, "stamp": {"secs": 1, "nsecs": 2}}, "K": list(range(9))}
    info = from_dict("sensor_msgs/CameraInfo", mapping)
    assert (info.header.stamp.sec, info.header.stamp.nanosec) == (1, 2)
    assert info.k.tolist() == list(range(9))


def test_numpy_goes_in_as_it_is() -> None:
    pixels = np.arange(6, dtype=np.uint8)
    image = from_dict("sensor_msgs/Image", {"data": pixels, "height": np.uint32(1)})
    assert image.data is pixels
    assert type(image.height) is int
    assert from_dict("sensor_msgs/Image", {"data": b"ab"}).data.tolist() == [97, 98]


def test_numbers_that_yaml_takes_for_texts_are_numbers() -> None:
    twist = from_dict("geometry_msgs/Twist", yaml.safe_load("{linear: {x: 1e-3, y: nan, z: .inf}}"))
    assert twist.linear.x == 0.001
    assert np.isnan(twist.linear.y)
    assert twist.linear.z == float("inf")


@pytest.mark.parametrize(
    ("name", "mapping", "code", "field"),
    [
        ("Twist", {"linar": {}}, FIELD_UNKNOWN, "linar"),
        ("Twist", {"linear": {"X": 1}}, FIELD_UNKNOWN, "linear.X"),
        ("Twist", {"linear": {"x": "fast"}}, FIELD_VALUE_INVALID, "linear.x"),
        ("Twist", {"linear": {"x": True}}, FIELD_VALUE_INVALID, "linear.x"),
        ("Twist", {"linear": {"x": [1]}}, FIELD_VALUE_INVALID, "linear.x"),
        ("Twist", {"linear": {"x": 10**400}}, FIELD_VALUE_INVALID, "linear.x"),
        ("Twist", {"linear": 3}, FIELD_VALUE_INVALID, "linear"),
        ("Twist", [1, 2, 3], FIELD_VALUE_INVALID, ""),
        ("Twist", "go", FIELD_VALUE_INVALID, ""),
        ("PoseWithCovariance", {"covariance": [1.0] * 35}, FIELD_VALUE_INVALID, "covariance"),
        ("PoseWithCovariance", {"covariance": 1.0}, FIELD_VALUE_INVALID, "covariance"),
        (
            "PoseWithCovariance",
            {"covariance": [0.0] * 35 + ["a"]},
            FIELD_VALUE_INVALID,
            "covariance[35]",
        ),
        ("PoseWithCovariance", {"covariance": [[1.0]] * 36}, FIELD_VALUE_INVALID, "covariance[0]"),
    ],
)
def test_what_does_not_fit_is_named(name: str, mapping: Any, code: Code, field: str) -> None:
    with raises(code, GraphError, field=field):
        from_dict(f"geometry_msgs/{name}", mapping)


@pytest.mark.parametrize(
    ("name", "mapping", "code", "field"),
    [
        ("sensor_msgs/Image", {"height": -1}, FIELD_VALUE_INVALID, "height"),
        ("sensor_msgs/Image", {"height": 1.5}, FIELD_VALUE_INVALID, "height"),
        ("sensor_msgs/Image", {"data": [1, 256]}, FIELD_VALUE_INVALID, "data[1]"),
        ("sensor_msgs/Image", {"data": "ab"}, FIELD_VALUE_INVALID, "data"),
        (
            "sensor_msgs/Image",
            {"encoding": 8},
            FIELD_VALUE_INVALID,
            "encoding",
        ),
        ("sensor_msgs/JointState", {"name": ["a", 1]}, FIELD_VALUE_INVALID, "name[1]"),
        (
            "tf2_msgs/TFMessage",
            {"transforms": [{"child": ""}]},
            FIELD_UNKNOWN,
            "transforms[0].child",
        ),
        ("std_msgs/Bool", {"data": "yes"}, FIELD_VALUE_INVALID, "data"),
    ],
)
def test_what_does_not_fit_is_named_in_other_types(
    name: str, mapping: Any, code: Code, field: str
) -> None:
    with raises(code, GraphError, field=field):
        from_dict(name, mapping)


@pytest.mark.parametrize(
    ("mapping", "field"),
    [
        ({"linear": {"x": "1e-3"}}, "linear.x"),
        ({"linear": {"x": None}}, "linear.x"),
        ({"linear": None}, "linear"),
        ({"linear": ["1", 0, 0]}, "linear.x"),
    ],
)
def test_a_program_gives_numbers_as_numbers(mapping: Any, field: str) -> None:
    with raises(FIELD_VALUE_INVALID, GraphError, field=field):
        from_dict("geometry_msgs/Twist", mapping, strict=True)
    assert from_dict("geometry_msgs/Twist", mapping).linear.x in (0.0, 1e-3, 1.0)


@pytest.mark.parametrize("value", [np.float32(0.5), np.array(0.5), np.array(0.5, np.float32)])
def test_a_number_of_numpy_needs_no_dimensions(value: Any) -> None:
    twist = from_dict("geometry_msgs/Twist", {"linear": {"x": value}})
    assert twist.linear.x == 0.5 and type(twist.linear.x) is float
    header = from_dict("std_msgs/Header", {"stamp": value})
    assert (header.stamp.sec, header.stamp.nanosec) == (0, 500_000_000)
    with raises(FIELD_VALUE_INVALID, GraphError, field="position"):
        from_dict("sensor_msgs/JointState", {"position": value})


@pytest.mark.parametrize("name", sorted(TYPES))
@SETTINGS
@given(data=st.data())
def test_a_message_that_fits_is_returned_itself(data: Any, name: str) -> None:
    made = from_dict(name, data.draw(mappings(name)))
    assert fits(made) and checked(made) is made


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        (JointState(position="a"), "position"),
        (JointState(position=None), "position"),
        (JointState(position=[0.0, "1"]), "position[1]"),
        (JointState(position=np.array(["1"])), "position[0]"),
        (JointState(position=np.zeros((1, 2))), "position[0]"),
        (JointState(name="a"), "name"),
        (JointState(name=["a", 1]), "name[1]"),
        (JointState(header=Header(stamp="now")), "header.stamp"),
        (JointState(header=Header(frame_id=3)), "header.frame_id"),
        (JointState(header=Vector3()), "header"),
        (Image(height=-1), "height"),
        (Image(height=2**32), "height"),
        (Image(height=1.5), "height"),
        (Image(is_bigendian=256), "is_bigendian"),
        (PoseWithCovariance(covariance=np.zeros(35)), "covariance"),
        (TFMessage(transforms=[TransformStamped(), None]), "transforms[1]"),
        (
            TFMessage(transforms=[TransformStamped(child_frame_id=1)]),
            "transforms[0].child_frame_id",
        ),
        (Bool(data="yes"), "data"),
        (String(data=None), "data"),
    ],
)
def test_what_does_not_fit_is_named_in_messages(wrong: Any, field: str) -> None:
    with raises(FIELD_VALUE_INVALID, GraphError, field=field):
        checked(wrong)


def test_values_of_messages_get_the_types_of_their_fields() -> None:
    point = JointTrajectoryPoint(positions=[1, 2.5], time_from_start=1.5)
    given = JointTrajectory(joint_names=("a", "b"), points=[point])
    made = checked(given)
    assert made.joint_names == ["a", "b"]
    (each,) = made.points
    assert each.positions.dtype == np.float64 and each.positions.tolist() == [1.0, 2.5]
    assert (each.time_from_start.sec, each.time_from_start.nanosec) == (1, 500_000_000)
    # The message of the program stays as it is.
    assert given.points == [point] and point.time_from_start == 1.5
    assert checked(Image(data=b"ab")).data.tolist() == [97, 98]
    assert checked(Image(height=np.uint32(3))).height == 3
    assert checked(Image(height=True)).height == 1
    assert checked(Bool(data=1)).data is True


def test_unknown_types_and_bytes_are_refused() -> None:
    with pytest.raises(UnknownNameError):
        from_dict("geometry_msgs/Twits", {})
    with raises(MESSAGE_NOT_DECODABLE, bytes=5):
        decode_cdr(b"\0\1\0\0\0", "geometry_msgs/Twist")
    with raises(FIELD_VALUE_INVALID, type="int"):
        to_dict(3)


@SETTINGS
@given(data=st.binary(max_size=200), name=st.sampled_from(TYPES))
def test_no_bytes_do_worse_than_a_refusal(data: bytes, name: str) -> None:
    with contextlib.suppress(GraphError):
        decode_cdr(data, name)


def test_text_is_that_of_rostopic() -> None:
    mapping = {
        "header": {"stamp": {"sec": 79, "nanosec": 123000000}},
        "name": ["wheel_right_joint", "left wheel"],
        "position": [10.150595427401989, 0.5],
    }
    assert to_yaml(from_dict("sensor_msgs/JointState", mapping)) == (
        "header: \n"
        "  stamp: \n"
        "    sec: 79\n"
        "    nanosec: 123000000\n"
        "  frame_id: ''\n"
        "name: \n"
        "  - wheel_right_joint\n"
        '  - "left wheel"\n'
        "position: [10.150595427401989, 0.5]\n"
        "velocity: []\n"
        "effort: []\n"
    )
    contacts = {"header": {"frame_id": "base"}, "states": [{"info": "a", "depths": [1e-10]}]}
    text = to_yaml(from_dict("gazebo_msgs/ContactsState", contacts))
    assert '  frame_id: "base"\nstates: \n  - \n    info: "a"\n' in text
    assert "    depths: [1e-10]\n" in text
    assert to_yaml(zero("sensor_msgs/RegionOfInterest")).endswith("do_rectify: False\n")


def test_long_arrays_are_cut_unless_asked_for() -> None:
    image = from_dict("sensor_msgs/Image", {"data": [178] * 230400})
    shown = to_yaml(image).splitlines()[-1]
    assert shown == "data: [" + "178, " * 64 + "...]"
    assert len(to_yaml(image, full=True)) > 5 * 230400
    assert to_yaml(image, arrays=False).endswith('data: "<array of uint8, 230400 long>"\n')


def test_a_field_alone_is_printed_alone() -> None:
    odometry = from_dict("nav_msgs/Odometry", {"child_frame_id": "base_link"})
    assert to_yaml(odometry.child_frame_id) == '"base_link"\n'
    assert to_yaml(odometry.pose.pose.position.x) == "0.0\n"
    assert to_yaml(odometry.pose.covariance) == f"[{', '.join(['0.0'] * 36)}]\n"
    transforms = from_dict("tf2_msgs/TFMessage", {"transforms": [{}, {}]}).transforms
    assert len(yaml.safe_load(to_yaml(transforms))) == 2


def test_one_message_is_serialised_once() -> None:
    cache = CdrCache()
    clock = message_class("rosgraph_msgs/Clock")
    first = zero("rosgraph_msgs/Clock")
    data = cache.encode(first)
    assert cache.encode(first) is data
    second = clock(clock=from_dict("builtin_interfaces/Time", [1, 2]))
    assert decode_cdr(cache.encode(second), "rosgraph_msgs/Clock") == second
    # Only the last one is kept.
    assert cache.encode(first) == data
    assert cache.encode(first) is not data
    first.clock = second.clock
    cache.forget()
    assert decode_cdr(cache.encode(first), "rosgraph_msgs/Clock") == second
