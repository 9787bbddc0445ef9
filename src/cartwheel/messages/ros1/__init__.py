"""ROS 1 format of the graph's messages: names, md5 sums, definitions, bytes."""

from cartwheel.messages.ros1.reading import decode_ros1
from cartwheel.messages.ros1.types import (
    Ros1Service,
    Ros1Type,
    ros1_name,
    ros1_service,
    ros1_type,
)
from cartwheel.messages.ros1.writing import encode_ros1, write_ros1

__all__ = [
    "Ros1Service",
    "Ros1Type",
    "decode_ros1",
    "encode_ros1",
    "ros1_name",
    "ros1_service",
    "ros1_type",
    "write_ros1",
]
