"""ROS messages of inertial measurement units."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from cartwheel.geometry import IDENTITY, Array
from cartwheel.messages import Form, header, message_class


def imu_message(
    moment: Any,
    orientation: Sequence[float],
    rate: Sequence[float],
    acceleration: Sequence[float],
    covariances: Sequence[Array],
) -> Any:
    """Returns an Imu message.

    Args:
        moment: The header.
        orientation: ``(x, y, z, w)``.
        rate: Angular velocity, rad/s.
        acceleration: Proper acceleration, m/s².
        covariances: Covariances of the three quantities, shape (9,) each.
    """
    Imu, Quaternion, Vector3 = _classes()
    of_orientation, of_rate, of_acceleration = covariances
    return Imu(
        moment,
        Quaternion(*orientation),
        of_orientation,
        Vector3(*rate),
        of_rate,
        Vector3(*acceleration),
        of_acceleration,
    )


def imu_form(frame: str, covariances: Sequence[Array]) -> Form:
    """Returns the form of Imu messages, whose values are the time, the orientation, the angular
    velocity and the proper acceleration.

    Args:
        frame: Frame ID of the messages.
        covariances: Covariances of the three quantities, shape (9,) each.
    """

    def template() -> Any:
        still = (0.0, 0.0, 0.0)
        return imu_message(header(0, frame), IDENTITY, still, still, covariances)

    return Form(template, "header.stamp", "orientation", "angular_velocity", "linear_acceleration")


@functools.cache
def _classes() -> tuple[Any, Any, Any]:
    return (
        message_class("sensor_msgs/msg/Imu"),
        message_class("geometry_msgs/msg/Quaternion"),
        message_class("geometry_msgs/msg/Vector3"),
    )
