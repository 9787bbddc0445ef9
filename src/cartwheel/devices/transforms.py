"""ROS messages of transforms."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from cartwheel.messages import message_class

TRANSFORM_STAMPED = "geometry_msgs/msg/TransformStamped"
TF_MESSAGE = "tf2_msgs/msg/TFMessage"


def transform_stamped(
    moment: Any, child: str, position: Sequence[float], orientation: Sequence[float]
) -> Any:
    """Returns a TransformStamped message.

    Args:
        moment: The header, with the parent frame.
        child: The child frame.
        position: Of the child frame in the parent frame, m.
        orientation: The same, ``(x, y, z, w)``.
    """
    TransformStamped, Transform, Vector3, Quaternion = transform_classes()
    return TransformStamped(moment, child, Transform(Vector3(*position), Quaternion(*orientation)))


@functools.cache
def transform_classes() -> tuple[Any, Any, Any, Any]:
    """Returns the classes TransformStamped, Transform, Vector3 and Quaternion."""
    return (
        message_class(TRANSFORM_STAMPED),
        message_class("geometry_msgs/msg/Transform"),
        message_class("geometry_msgs/msg/Vector3"),
        message_class("geometry_msgs/msg/Quaternion"),
    )
