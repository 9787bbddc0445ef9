"""Descriptions of types against their hashes, which tests elsewhere compare with ROS's own."""

import dataclasses
import hashlib
import json
from typing import Any

import pytest

from cartwheel.errors import UnknownNameError
from cartwheel.messages import encode_cdr
from cartwheel.messages.ros2.type_descriptions import type_description
from cartwheel.messages.ros2.types import ros2_hash_of, ros2_service, ros2_type


def hashed(value: Any) -> Any:
    """A description as REP 2016 hashes it: without defaults, which are no part of the type."""
    if isinstance(value, list):
        return [hashed(each) for each in value]
    if not dataclasses.is_dataclass(value):
        return value
    return {
        field.name: hashed(getattr(value, field.name))
        for field in dataclasses.fields(value)
        if field.name.islower() and field.name not in ("default_value", "__msgtype__")
    }


@pytest.mark.parametrize(
    "name",
    [
        "std_msgs/msg/String",
        "std_msgs/msg/Empty",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/CameraInfo",
        "nav_msgs/msg/Odometry",
        "tf2_msgs/msg/TFMessage",
        "rcl_interfaces/msg/ParameterEvent",
        "std_srvs/srv/Empty",
        "rcl_interfaces/srv/GetParameters",
        "controller_manager_msgs/srv/ListControllers",
        "control_msgs/action/FollowJointTrajectory_SendGoal",
        "type_description_interfaces/srv/GetTypeDescription",
    ],
)
def test_what_is_described_has_the_types_hash(name: str) -> None:
    made = type_description(name)
    encode_cdr(made)
    text = json.dumps(hashed(made))
    digest = hashlib.sha256(text.encode()).hexdigest()
    assert f"RIHS01_{digest}" == ros2_hash_of(name)
    names = [each.type_name for each in made.referenced_type_descriptions]
    assert names == sorted(set(names))


def test_hashes_are_those_of_messages_and_services() -> None:
    assert ros2_hash_of("nav_msgs/msg/Odometry") == ros2_type("nav_msgs/msg/Odometry").hash
    assert ros2_hash_of("std_srvs/srv/Empty") == ros2_service("std_srvs/srv/Empty").hash
    request = ros2_service("std_srvs/srv/SetBool").request_hash
    assert ros2_hash_of("std_srvs/srv/SetBool_Request") == request


@pytest.mark.parametrize("name", ["std_msgs/msg/Strin", "a/srv/B", "nonsense", "", "a/b/c/d"])
def test_what_is_no_type_is_said_to_be_none(name: str) -> None:
    with pytest.raises(UnknownNameError):
        type_description(name)
