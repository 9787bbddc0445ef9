"""Settings of a controller's odometry: topic, frames, covariances, averaging."""

from __future__ import annotations

import numpy as np

from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.drives.wheel_odometry import WheelOdometry
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Array

_MOST_AVERAGED = 10_000
"""Maximum number of averaged velocities."""


def wheel_odometry(
    controller: Controller,
    settings: Settings,
    *,
    topic: str = "odom",
    tf_topic: str = "/tf",
    transform: bool,
    prefix: str = "",
) -> WheelOdometry:
    """Creates the odometry of a controller.

    Args:
        controller: The controller that publishes the topic.
        settings: ``publish_rate``, frames, covariances, ``velocity_rolling_window_size``.
        topic: Topic of the odometry.
        tf_topic: Topic of the transform.
        transform: Whether to publish the transform.
        prefix: Prefix of the frames.

    Raises:
        PluginError: A value is not allowed.
    """
    rate = settings.number("publish_rate", 50.0)
    if rate <= 0:
        raise settings.invalid("publish_rate", rate, "positive")
    size = settings.integer("velocity_rolling_window_size", 10)
    if not 1 <= size <= _MOST_AVERAGED:
        wanted = f"between 1 and {_MOST_AVERAGED:,}"
        raise settings.invalid("velocity_rolling_window_size", size, wanted)
    config = OdometryConfig(
        topic=topic,
        frame=prefix + settings.text("odom_frame_id", "odom"),
        base=prefix + settings.text("base_frame_id", "base_link"),
        rate=rate,
        transform=transform,
        tf_topic=tf_topic,
        pose_covariance=_covariance(settings, "pose_covariance_diagonal"),
        twist_covariance=_covariance(settings, "twist_covariance_diagonal"),
    )
    return controller.add(WheelOdometry(controller.scope, config, DeadReckoning(size)))


def _covariance(settings: Settings, name: str) -> Array:
    """Returns a covariance, shape (36,)."""
    values = settings.numbers(name, [0.0] * 6)
    if len(values) == 36:
        return np.array(values)
    if len(values) != 6:
        raise settings.invalid(name, values, "6 numbers, or 36")
    return np.diag(values).ravel()
