"""Classes of messages: they behave like the dataclasses of rosbags."""

import copy
import dataclasses
import math
import pickle
import random
import threading
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore
from tests.coded import raises
from tests.messages.cdr.test_cdr import bundled_types, grown

from cartwheel.codes.graph import FIELD_VALUE_INVALID
from cartwheel.errors import Origin
from cartwheel.messages import decode_cdr, encode_cdr, from_dict, message_class, zero
from cartwheel.messages.classes import Classes
from cartwheel.messages.convert import checked
from cartwheel.messages.defaults import STATED
from cartwheel.messages.fitting import fits
from cartwheel.messages.library.parsing import parse_definition
from cartwheel.messages.ros1 import decode_ros1, encode_ros1
from cartwheel.messages.store import ROS2_DEFINITIONS, definitions

ODOMETRY = "nav_msgs/msg/Odometry"


def test_the_functions_of_the_module_dataclasses() -> None:
    made = message_class("geometry_msgs/msg/Vector3")(1.0, 2.0, z=3.0)
    assert dataclasses.is_dataclass(made)
    assert [field.name for field in dataclasses.fields(made)] == ["x", "y", "z"]
    assert dataclasses.replace(made, y=5.0) == type(made)(1.0, 5.0, 3.0)
    pose = zero("geometry_msgs/msg/Pose")
    assert dataclasses.asdict(pose)["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}


def test_copies_and_pickles() -> None:
    made = grown(ODOMETRY, random.Random(2))
    for again in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made)):
        assert type(again) is type(made)
        assert encode_cdr(again) == encode_cdr(made)
        assert again.header is not made.header
    assert copy.copy(made).header is made.header


def test_messages_are_equal_if_their_fields_are() -> None:
    kind = message_class("sensor_msgs/msg/JointState")
    assert kind() == kind()
    assert (kind() != kind()) is False
    assert kind(name=["a"]) != kind() and kind() != zero(ODOMETRY) and kind() != 3
    one = kind(position=np.array([1.0, 2.0]))
    assert one == kind(position=np.array([1.0, 2.0])) == kind(position=[1.0, 2.0])
    assert one != kind(position=np.array([1.0, 3.0]))
    assert one != kind(position=np.array([1.0]))
    assert one != kind(position=np.array([[1.0, 2.0]]))
    joints = message_class("sensor_msgs/msg/MultiDOFJointState")
    with_lists = joints(joint_names=["a"], wrench=[zero("geometry_msgs/msg/Wrench")])
    assert with_lists == copy.deepcopy(with_lists)
    changed = copy.deepcopy(with_lists)
    changed.wrench[0].force.x = 1.0
    assert with_lists != changed and changed in [with_lists, copy.deepcopy(changed)]
    with pytest.raises(TypeError):
        hash(one)


def test_numbers_of_float32_are_those_that_are_sent() -> None:
    make = message_class("sensor_msgs/msg/Range")
    made = make(range=0.1, max_range=np.float64(1 / 3), variance=math.nan)
    assert (made.range, made.max_range) == (float(np.float32(0.1)), float(np.float32(1 / 3)))
    assert type(made.max_range) is float
    for again in (
        decode_cdr(encode_cdr(made), made.__msgtype__),
        copy.copy(made),
    ):
        assert again == made
    assert decode_ros1(encode_ros1(made), made.__msgtype__).range == made.range
    made.min_range = 0.3
    assert not fits(made)
    assert checked(made).min_range == float(np.float32(0.3)) and fits(checked(made))
    assert from_dict("std_msgs/msg/Float32", {"data": "1e-3"}).data == float(np.float32(1e-3))
    # What is not a number is refused when it is published.
    assert make(range="a", min_range=0.1).min_range == 0.1
    for wrong in (1e39, -1e39, "a", True):
        with raises(FIELD_VALUE_INVALID):
            checked(make(range=wrong))
    assert checked(make(range=math.inf, variance=2)).range == math.inf


def test_nan_equals_nan() -> None:
    make = message_class("std_msgs/msg/Float64MultiArray")
    one, other, number = (make(data=np.array([value, 1.0])) for value in (math.nan, math.nan, 0.0))
    assert one == other != number != one
    scalar = message_class("std_msgs/msg/Float64")
    assert scalar(math.nan) == scalar(float("nan")) != scalar(0.0)


def test_a_message_of_each_type_equals_its_copy() -> None:
    wrong = []
    for name in bundled_types():
        made = grown(name, random.Random(3))
        again = decode_cdr(encode_cdr(made), name)
        if again != decode_cdr(encode_cdr(again), name):
            wrong.append(name)
    assert not wrong


def test_constants_and_names_are_those_of_rosbags() -> None:
    theirs = get_typestore(Stores.ROS2_JAZZY).types
    for name in ("sensor_msgs/msg/NavSatStatus", "std_msgs/msg/Header"):
        ours = message_class(name)
        assert ours.__name__ == theirs[name].__name__
        assert ours.__msgtype__ == name
        constants = {key: value for key, value in vars(theirs[name]).items() if key.isupper()}
        assert {key: getattr(ours, key) for key in constants} == constants


def test_omitted_fields_have_the_same_defaults_in_classes_and_mappings() -> None:
    assert not [
        name
        for name in bundled_types()
        if encode_cdr(message_class(name)()) != encode_cdr(zero(name))
    ]


def test_omitted_fields_have_the_defaults_of_the_definition() -> None:
    quaternion = message_class("geometry_msgs/msg/Quaternion")
    assert (quaternion().w, quaternion(0.0, 0.0, 0.0, 0.0).w) == (1.0, 0.0)
    for made in (message_class(ODOMETRY)(), zero(ODOMETRY), from_dict(ODOMETRY, {})):
        turned = made.pose.pose.orientation
        assert (turned.x, turned.y, turned.z, turned.w) == (0.0, 0.0, 0.0, 1.0)
    given = from_dict("geometry_msgs/msg/Pose", {"orientation": {"z": 0.5, "w": 0.0}})
    assert (given.orientation.z, given.orientation.w) == (0.5, 0.0)
    assert from_dict("sensor_msgs/msg/NavSatFix", {}).status.status == -2
    request = message_class("simulation_interfaces/srv/StepSimulation_Request")
    assert request().steps == 1


def test_the_defaults_are_those_of_our_definitions() -> None:
    """Those of rosbags' definitions are not in this project; see `STATED`."""
    stated = {}
    for name, text in (*definitions(), *definitions(ROS2_DEFINITIONS)):
        fields = parse_definition(name, text, Origin(file="test")).fields
        given = {field.name: field.default for field in fields if field.default}
        if given:
            stated[name] = given
    of_rosbags = get_typestore(Stores.ROS2_JAZZY).fielddefs
    assert {name: STATED[name] for name in STATED if name not in of_rosbags} == {
        name: stated[name] for name in stated if name not in of_rosbags
    }
    assert len(stated) >= 2


def test_a_quaternion_of_ros1_stays_as_it_is() -> None:
    made = message_class("geometry_msgs/msg/Quaternion")(0.0, 0.0, 0.0, 0.0)
    assert decode_ros1(encode_ros1(made), "geometry_msgs/msg/Quaternion") == made


def test_default_values_are_not_shared() -> None:
    first, second = (message_class("nav_msgs/msg/Odometry")() for _ in range(2))
    first.pose.pose.position.x = 1.0
    first.pose.covariance[0] = 1.0
    assert second.pose.pose.position.x == second.pose.covariance[0] == 0.0


@pytest.mark.parametrize("wrong", [{"w": 1.0}, {"x": 1.0, "X": 2.0}])
def test_a_field_that_does_not_exist(wrong: dict[str, float]) -> None:
    with pytest.raises(TypeError):
        message_class("geometry_msgs/msg/Vector3")(**wrong)


def test_too_many_values() -> None:
    with pytest.raises(TypeError):
        message_class("geometry_msgs/msg/Vector3")(1.0, 2.0, 3.0, 4.0)


def test_a_field_that_does_not_exist_cannot_be_set() -> None:
    made = zero(ODOMETRY)
    with pytest.raises(AttributeError):
        made.child_frame = "base_link"


def test_threads_convert_a_type_to_the_same_class() -> None:
    for _ in range(20):
        theirs = get_typestore(Stores.ROS2_JAZZY)
        classes = Classes(dict(theirs.types), theirs.fielddefs, module=__name__)
        start = threading.Barrier(4)
        found: list[Any] = []

        def look(classes: Classes = classes, start: threading.Barrier = start) -> None:
            start.wait(60)
            found.append(classes[ODOMETRY])  # noqa: B023 - read in the same round

        threads = [threading.Thread(target=look) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        assert len(found) == 4 and len(set(map(id, found))) == 1


def test_a_type_that_was_removed_can_be_defined_anew() -> None:
    @dataclasses.dataclass
    class Old:
        a: int

    @dataclasses.dataclass
    class New:
        b: int

    number = (Nodetype.BASE, ("int32", 0))
    definitions = {"x/msg/X": ([], [("a", number)])}
    classes = Classes({"x/msg/X": Old}, definitions, module=__name__)
    assert classes["x/msg/X"](a=1).a == 1
    classes.pop("x/msg/X")
    classes.update({"x/msg/X": New})
    definitions["x/msg/X"] = ([], [("b", number)])
    assert classes["x/msg/X"](b=2).b == 2


def test_a_message_is_shown_as_python_code() -> None:
    point = message_class("geometry_msgs/msg/Point")(1.0, 2.0, 3.0)
    assert repr(point) == "Point(x=1.0, y=2.0, z=3.0)"
    pose = message_class("geometry_msgs/msg/Pose")(position=point)
    assert repr(pose).startswith("Pose(position=Point(x=1.0, y=2.0, z=3.0), orientation=Quatern")
    assert repr(message_class("std_srvs/srv/SetBool_Response")(True, "on")) == (
        "SetBool_Response(success=True, message='on')"
    )
    assert repr(message_class("std_srvs/srv/Empty_Response")()) == "Empty_Response()"


def test_all_messages_can_be_shown() -> None:
    for name in bundled_types():
        assert repr(zero(name)).startswith(f"{name.rpartition('/')[2]}(")
