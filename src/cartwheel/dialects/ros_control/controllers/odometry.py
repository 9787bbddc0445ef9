"""Settings of a controller's odometry: topic, frames, covariances, averaging."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.drives.wheel_odometry import WheelOdometry
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import parameter
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Array

MOST_AVERAGED = 10_000
"""Maximum number of averaged velocities."""


@dataclass(frozen=True, kw_only=True, slots=True)
class OdometryParameters:
    """The parameters that all drives read."""

    publish_rate: float = parameter(
        "publish_rate",
        default=50.0,
        unit="Hz",
        positive=True,
        doc="Publish rate of the odometry.",
    )
    odom_frame: str = parameter(
        "odom_frame_id", default="odom", doc="Frame of the odometry messages."
    )
    base_frame: str = parameter(
        "base_frame_id", default="base_link", doc="Frame of the robot in the odometry messages."
    )
    enable_odom_tf: bool = parameter(
        "enable_odom_tf", default=True, doc="Publish the transform from the odometry frame."
    )
    pose_covariance: tuple[float, ...] = parameter(
        "pose_covariance_diagonal",
        default=(0.0,) * 6,
        doc="Covariance of the pose: 6 numbers of the diagonal, or all 36.",
    )
    twist_covariance: tuple[float, ...] = parameter(
        "twist_covariance_diagonal",
        default=(0.0,) * 6,
        doc="Covariance of the twist: 6 numbers of the diagonal, or all 36.",
    )
    window: int = parameter(
        "velocity_rolling_window_size",
        default=10,
        doc="Number of measurements over which the velocity is averaged.",
    )


def open_loop_parameter() -> Any:
    """Whether the odometry is that of the commands."""
    doc = "Compute odometry from commands instead of measurements."
    return parameter("open_loop", default=False, doc=doc)


def position_feedback_parameter(*, default: bool) -> Any:
    """Whether the odometry is that of wheel positions."""
    doc = "Compute odometry from wheel positions instead of velocities."
    return parameter("position_feedback", default=default, doc=doc)


def wheel_odometry(
    controller: Controller,
    given: OdometryParameters,
    *,
    topic: str = "odom",
    tf_topic: str = "/tf",
    prefix: str = "",
    averaged: bool = True,
) -> WheelOdometry:
    """Creates the odometry of a controller.

    Args:
        controller: The controller that publishes the topic.
        given: Its parameters.
        topic: Topic of the odometry.
        tf_topic: Topic of the transform.
        prefix: Prefix of the frames.
        averaged: Whether the velocity is a mean of the last measurements.

    Raises:
        PluginError: A value is not allowed.
    """
    settings, size = controller.settings, given.window
    if not 1 <= size <= MOST_AVERAGED:
        wanted = f"between 1 and {MOST_AVERAGED:,}"
        raise settings.invalid("velocity_rolling_window_size", size, wanted)
    config = OdometryConfig(
        topic=topic,
        frame=prefix + given.odom_frame,
        base=prefix + given.base_frame,
        rate=given.publish_rate,
        transform=given.enable_odom_tf,
        tf_topic=tf_topic,
        pose_covariance=_covariance(settings, "pose_covariance_diagonal", given.pose_covariance),
        twist_covariance=_covariance(settings, "twist_covariance_diagonal", given.twist_covariance),
    )
    return controller.add(
        WheelOdometry(controller.scope, config, DeadReckoning(size if averaged else None))
    )


def _covariance(settings: Settings, name: str, values: tuple[float, ...]) -> Array:
    """Returns a covariance, shape (36,)."""
    if len(values) == 36:
        return np.array(values)
    if len(values) != 6:
        raise settings.invalid(name, values, "6 numbers, or 36")
    return np.diag(values).ravel()
