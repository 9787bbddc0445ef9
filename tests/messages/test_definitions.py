"""Our message definitions against the md5 sums that ROS 1 computes for them."""

import hashlib
from typing import Any

import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cartwheel.errors import UnknownNameError
from cartwheel.messages import message_class, service_classes, store
from cartwheel.messages.store import definitions

# As a real ROS 1 Noetic prints them.
MESSAGES = {
    "gazebo_msgs/ContactState": "48c0ffb054b8c444f870cecea1ee50d9",
    "gazebo_msgs/ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
    "gazebo_msgs/LinkState": "0818ebbf28ce3a08d48ab1eaa7309ebe",
    "gazebo_msgs/LinkStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/ModelState": "9330fd35f2fcd82d457e54bd54e10593",
    "gazebo_msgs/ModelStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/ODEJointProperties": "1b744c32a920af979f53afe2f9c3511f",
    "gazebo_msgs/ODEPhysics": "667d56ddbd547918c32d1934503dc335",
    "gazebo_msgs/PerformanceMetrics": "884f71fd5037b886ec5e126b83c4425a",
    "gazebo_msgs/SensorPerformanceMetric": "01762ded18cfe9ebc7c8222667c99547",
    "gazebo_msgs/WorldState": "de1a9de3ab7ba97ac0e9ec01a4eb481e",
    "sensor_msgs/Imu": "6a62c6daae103f4ff57a132d6f95cec2",
    "nav_msgs/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "geometry_msgs/Twist": "9f195f881246fdfa2798d1d3eebca84a",
}
SERVICES = {
    "gazebo_msgs/ApplyBodyWrench": "585b9f9618aa0581b207e2f2d90866bc",
    "gazebo_msgs/ApplyJointEffort": "c0039811b8cc919490b3cff748cdf46b",
    "gazebo_msgs/BodyRequest": "5eade9afe7f232d78005bd0cafeab755",
    "gazebo_msgs/DeleteLight": "ae11ea8100d536d5b92c2b5917abf912",
    "gazebo_msgs/DeleteModel": "9ce56b4e9e54616de25d796dc972a262",
    "gazebo_msgs/GetJointProperties": "7b30be900f50aa21efec4a0ec92d91c9",
    "gazebo_msgs/GetLightProperties": "df2cef87e13e2e6990e81e8aaa454c19",
    "gazebo_msgs/GetLinkProperties": "0e06a70386d0ee3fb880c02f23fcd821",
    "gazebo_msgs/GetLinkState": "09d6c98cce97b35f7ab9bd70300657ab",
    "gazebo_msgs/GetModelProperties": "5717f7bd34ed990fa80e28b3015027a3",
    "gazebo_msgs/GetModelState": "4c515e936d3319c9610c559c60bfc3d4",
    "gazebo_msgs/GetPhysicsProperties": "575a5e74786981b7df2e3afc567693a6",
    "gazebo_msgs/GetWorldProperties": "36bb0f2eccf4d8be971410c22818ba3f",
    "gazebo_msgs/JointRequest": "0be1351618e1dc030eb7959d9a4902de",
    "gazebo_msgs/SetJointProperties": "15a76e921b1410c698d82782ea5fa370",
    "gazebo_msgs/SetJointTrajectory": "88f5c10979e3f9649d5ae87a3b12aa65",
    "gazebo_msgs/SetLightProperties": "e6f13430c57278bb364aca53a1bf5ebf",
    "gazebo_msgs/SetLinkProperties": "d534ce1b36ee99de0ffa806c3a6348f0",
    "gazebo_msgs/SetLinkState": "8a5146eb66ae4d26b0860b08f3f271be",
    "gazebo_msgs/SetModelConfiguration": "10e3139d3b669c40afc057d38956fff7",
    "gazebo_msgs/SetModelState": "5b3ab0281d4f5445def017e3a2e4a07b",
    "gazebo_msgs/SetPhysicsProperties": "97e2057080558ce4730434b5fae75c91",
    "gazebo_msgs/SpawnModel": "9ed9c82c96abe1a00c3e8cdaeee24413",
    "sensor_msgs/SetCameraInfo": "bef1df590ed75ed1f393692395e15482",
    "std_srvs/Empty": "d41d8cd98f00b204e9800998ecf8427e",
    "std_srvs/SetBool": "09fb03525b03e7ea1fd3992bafd87e16",
    "std_srvs/Trigger": "937c9679a518e3a18d831e57125ea522",
}


@pytest.fixture(scope="module")
def noetic() -> Any:
    made = get_typestore(Stores.ROS1_NOETIC)
    ours = {}
    for name, text in definitions():
        (ours[name],) = get_types_from_msg(text, name).values()
    made.register(ours)
    return made


def hashed_text(types: Any, name: str) -> str:
    """What ROS 1 hashes of a message: constants, then fields, messages in it by their hash."""
    times = {"builtin_interfaces/msg/Time": "time", "builtin_interfaces/msg/Duration": "duration"}
    constants, fields = types.fielddefs[name]
    lines = [f"{kind} {field}={value}" for field, kind, value in constants]
    for field, kind in fields:
        if field == "structure_needs_at_least_one_member":
            continue
        brackets, (node, value) = "", kind
        if kind[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            brackets, (node, value) = f"[{kind[1][1] or ''}]", kind[1][0]
        if node == Nodetype.BASE:
            lines.append(f"{value[0]}{brackets} {field}")
        elif value in times:
            lines.append(f"{times[value]}{brackets} {field}")
        else:
            lines.append(f"{md5(hashed_text(types, value))} {field}")
    return "\n".join(lines)


def md5(text: str) -> str:
    return hashlib.md5(text.encode()).hexdigest()


@pytest.mark.parametrize("name", MESSAGES)
def test_messages_have_the_sums_of_ros1(noetic: Any, name: str) -> None:
    package, base = name.split("/")
    assert md5(hashed_text(noetic, f"{package}/msg/{base}")) == MESSAGES[name]


@pytest.mark.parametrize("name", SERVICES)
def test_services_have_the_sums_of_ros1(noetic: Any, name: str) -> None:
    package, base = name.split("/")
    parts = [
        hashed_text(noetic, f"{package}/srv/{base}_{part}") for part in ("Request", "Response")
    ]
    assert md5("".join(parts)) == SERVICES[name]


def test_every_definition_is_compared() -> None:
    ours = {name for name, _ in definitions() if "/msg/" in name}
    assert {name.replace("/msg/", "/") for name in ours} <= set(MESSAGES)
    services = {name.removesuffix("_Request") for name, _ in definitions() if "_Request" in name}
    assert {name.replace("/srv/", "/") for name in services} == set(SERVICES)


def test_the_store_holds_every_definition() -> None:
    for name, _ in definitions():
        assert message_class(name).__msgtype__ == name
    assert "tf2_msgs/msg/TFMessage" in store().types


def test_a_service_has_two_classes() -> None:
    request, response = service_classes("gazebo_msgs/SpawnModel")
    assert request.__msgtype__ == "gazebo_msgs/srv/SpawnModel_Request"
    assert response(success=True, status_message="").success
    assert service_classes("std_srvs/srv/Empty")[0].__msgtype__ == "std_srvs/srv/Empty_Request"


def test_headers_are_those_of_ros2() -> None:
    fields = message_class("std_msgs/Header").__dataclass_fields__
    assert [name for name in fields if not name.startswith("__")] == ["stamp", "frame_id"]


def test_an_unknown_type_names_the_likely_one() -> None:
    with pytest.raises(UnknownNameError, match='Did you mean "geometry_msgs/msg/Twist"'):
        message_class("geometry_msgs/Twst")
    with pytest.raises(UnknownNameError, match='Did you mean "std_srvs/srv/Trigger"'):
        service_classes("std_srvs/srv/Triger")
