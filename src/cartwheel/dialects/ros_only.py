"""Plugins for Gazebo Classic that exist in only one version of ROS.

From the branches ``noetic-devel`` and ``ros2`` of gazebo_ros_pkgs, and from gazebo_ros2_control.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from cartwheel.dialects.catalogue import short_name

_RAYS, _CAMERA = "libgazebo_ros_ray_sensor.so", "libgazebo_ros_camera.so"
_REPLACEMENTS: Mapping[int, Mapping[str, str]] = {
    1: {
        "gazebo_ros_control": "libgazebo_ros2_control.so with a <ros2_control> element",
        "gazebo_ros_block_laser": _RAYS,
        "gazebo_ros_gpu_laser": _RAYS,
        "gazebo_ros_laser": _RAYS,
        "gazebo_ros_range": _RAYS,
        "gazebo_ros_depth_camera": _CAMERA,
        "gazebo_ros_multicamera": _CAMERA,
        "gazebo_ros_openni_kinect": _CAMERA,
        "gazebo_ros_prosilica": _CAMERA,
        "gazebo_ros_triggered_camera": _CAMERA,
        "gazebo_ros_triggered_multicamera": _CAMERA,
        "gazebo_ros_f3d": "libgazebo_ros_ft_sensor.so",
        "gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
        "gazebo_ros_skid_steer_drive": "libgazebo_ros_diff_drive.so with <num_wheel_pairs>",
    },
    2: {
        "gazebo_ros2_control": "libgazebo_ros_control.so with <transmission> elements",
        "gazebo_ros_ray_sensor": "libgazebo_ros_laser.so",
        "gazebo_ros_ackermann_drive": "",
        "gazebo_ros_gps_sensor": "",
    },
}
"""By the version of ROS in which a plugin exists: what to use in the other one; empty if there is
nothing alike."""


def only_in(filename: str) -> tuple[Literal[1, 2], str] | None:
    """The only version of ROS in which a plugin exists, and its replacement in the other one.

    Args:
        filename: Name in a ``<plugin>`` tag.

    Returns:
        None for plugins that exist in both versions, and for all that are not part of Gazebo's
        packages.
    """
    name = short_name(filename)
    if name in _REPLACEMENTS[1]:
        return 1, _REPLACEMENTS[1][name]
    return (2, _REPLACEMENTS[2][name]) if name in _REPLACEMENTS[2] else None
