"""CDR as others send it: messages, requests of services, goals of actions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.campaign.target import Target

from cartwheel.errors import GraphError
from cartwheel.messages import decode_cdr, encode_cdr, to_dict, zero
from cartwheel.messages.fields import fields
from cartwheel.messages.limits import unfit

TYPES = (
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/Wrench",
    "trajectory_msgs/msg/JointTrajectory",
    "std_msgs/msg/Float64MultiArray",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/PointCloud2",
    "sensor_msgs/msg/CameraInfo",
    "tf2_msgs/msg/TFMessage",
    "actuator_msgs/msg/Actuators",
    "rcl_interfaces/srv/SetParameters_Request",
    "rcl_interfaces/srv/ListParameters_Request",
    "gazebo_msgs/srv/SpawnEntity_Request",
    "gazebo_msgs/srv/SetPhysicsProperties_Request",
    "simulation_interfaces/srv/SpawnEntities_Request",
    "control_msgs_ros2/action/FollowJointTrajectory_SendGoal_Request",
    "diagnostic_msgs/msg/DiagnosticArray",
    "visualization_msgs/msg/MarkerArray",
)


def known() -> list[str]:
    """Those of the types that this version has."""
    found = []
    for name in TYPES:
        try:
            zero(name)
        except Exception:  # noqa: BLE001 - it is for another version
            continue
        found.append(name)
    return found


KNOWN = known()


def filled(name: str, count: int = 2) -> Any:
    """A message in which nothing is empty."""
    message = zero(name)
    for field in fields(name):
        length = field.length or count
        value: Any
        if field.kind == "message":
            inner = [filled(field.type, 1) for _ in range(length if field.array else 1)]
            value = inner if field.array else inner[0]
        elif field.kind == "string":
            value = ["aü"] * length if field.array else "base_link"
        elif field.array:
            value = np.arange(1, length + 1, dtype=field.type)
        else:
            value = {"bool": True, "int": 7, "float": -0.5}[field.kind]
        setattr(message, field.name, value)
    return message


def seeds() -> list[bytes]:
    """Of each type an empty message and a full one, behind the number of the type."""
    return [
        bytes([number]) + encode_cdr(message)
        for number, name in enumerate(KNOWN)
        for message in (zero(name), filled(name))
    ]


def run_one(data: bytes) -> None:
    """Reads a message as the bridges do, and does with it what the graph does."""
    if not data:
        return
    name = KNOWN[data[0] % len(KNOWN)]
    message = decode_cdr(data[1:], name)
    unfit(message, most=math.inf)
    again = encode_cdr(message)
    to_dict(decode_cdr(again, name))


TARGETS = (Target(name="cdr", seeds=seeds, run_one=run_one, allowed=(GraphError,)),)
