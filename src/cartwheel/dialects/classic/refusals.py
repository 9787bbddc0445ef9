"""Plugins of Gazebo Classic inside a sensor of a type that they do not accept.

From the sources of gazebo_ros_pkgs, hector_gazebo, velodyne_simulator and Gazebo Classic: each of
these plugins casts its sensor to one class. ``RaySensor`` and ``GpuRaySensor`` are different
classes, and a camera is no ``DepthCameraSensor`` or ``MultiCameraSensor``. If the cast fails, the
plugin throws an exception, returns, or crashes Gazebo.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cartwheel.codes.devices import SENSOR_REFUSED
from cartwheel.description.model import PluginTag, RobotDescription, Sensor
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Diagnostic

_ON_GPU = ("gpu_ray", "gpu_lidar")
_ON_CPU = ("ray", "lidar")
_IMAGES = ("camera", "multicamera", "wideanglecamera")
_REFUSED: Mapping[str, tuple[str, tuple[str, ...], str]] = {
    "gazebo_ros_laser": ("ray", _ON_GPU, "gazebo_ros_gpu_laser"),
    "gazebo_ros_gpu_laser": ("gpu_ray", _ON_CPU, "gazebo_ros_laser"),
    "gazebo_ros_block_laser": ("ray", _ON_GPU, ""),
    "gazebo_ros_range": ("ray", _ON_GPU, ""),
    "hector_gazebo_ros_sonar": ("ray", _ON_GPU, ""),
    "gazebo_ros_velodyne_laser": ("ray", _ON_GPU, "gazebo_ros_velodyne_gpu_laser"),
    "gazebo_ros_velodyne_gpu_laser": ("gpu_ray", _ON_CPU, "gazebo_ros_velodyne_laser"),
    "gazebo_ros_depth_camera": ("depth", _IMAGES, "gazebo_ros_camera"),
    "gazebo_ros_openni_kinect": ("depth", _IMAGES, "gazebo_ros_camera"),
    "gazebo_ros_multicamera": ("multicamera", ("camera", "wideanglecamera"), "gazebo_ros_camera"),
}
"""By the plugin: the type of sensor that it accepts, some that it does not, and the plugin for
these; empty if there is none."""


def refusals(robot: RobotDescription) -> Iterator[Diagnostic]:
    """The sensors of a robot that their plugins do not accept."""
    for link in robot.links:
        for sensor in link.sensors:
            for tag in sensor.plugins:
                found = refusal(robot, tag, sensor)
                if found is not None:
                    yield found


def refusal(robot: RobotDescription, tag: PluginTag, sensor: Sensor) -> Diagnostic | None:
    """The finding that a plugin does not accept its sensor.

    None if it may, if the plugin is not loaded, or if the robot's repository builds a plugin of
    this name.
    """
    wanted, refused, other = _REFUSED.get(short_name(tag.filename), ("", (), ""))
    if sensor.type not in refused:
        return None
    # Most robots need neither of them, and they import the readers of launch files.
    from cartwheel.dialects.gz.gazebo_only import other_gazebo
    from cartwheel.dialects.ros_only import is_built

    if other_gazebo(robot, tag, sensor) is not None or is_built(robot, tag):
        return None
    instead = f', or the plugin "lib{other}.so"' if other else ""
    return SENSOR_REFUSED.diagnostic(
        f'plugin "{tag.filename}" accepts only a sensor of the type "{wanted}", but sensor '
        f'"{sensor.name}" has the type "{sensor.type}", so in Gazebo it publishes nothing',
        origin=sensor.origin,
        hint=f'Write type="{wanted}"{instead}.',
        values={
            "sensor": sensor.name,
            "sensors": (sensor.name,),
            "type": sensor.type,
            "name": tag.filename,
            "meant": wanted,
        },
    )
