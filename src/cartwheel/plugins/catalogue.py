"""The plugins by file name and by sensor type.

A plugin's module is imported when a model uses the plugin. Importing all of them takes as long as
the rest of the startup.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import importlib.metadata
import re
from collections.abc import Iterator

from cartwheel.plugins.base import Plugin

ROS_CONTROL = "gazebo_ros_control"
_FILES = {
    "gazebo_ros_diff_drive": "diff_drive",
    "gazebo_ros_skid_steer_drive": "skid_steer",
    "diffdrive_plugin_multi_wheel": "multi_wheel",
    "gazebo_ros_tricycle_drive": "tricycle",
    "gazebo_ros_ackermann_drive": "ackermann",
    "gazebo_ros_planar_move": "planar_move",
    "ridgeback_ros_force_based_move": "force_based_move",
    "gazebo_ros_force_based_move": "force_based_move",
    "robotnik_force_based_move": "force_based_move",
    "gazebo_ros_kobuki": "kobuki",
    "gazebo_ros_create_bumper": "create3",
    "gazebo_ros_create_cliff_sensor": "create3",
    "gazebo_ros_create_ir_intensity_sensor": "create3",
    "gazebo_ros_create_imu": "create3",
    "gazebo_ros_create_optical_mouse": "create3",
    "gazebo_ros_create_wheel_drop": "create3",
    "gazebo_ros_create_ir_opcode": "create3_dock",
    "gazebo_ros_create_docking_status": "create3_dock",
    "gz-sim-diff-drive-system": "gz_diff_drive",
    "gz-sim-ackermann-steering-system": "ackermann",
    "gz-sim-mecanum-drive-system": "mecanum",
    "gz-sim-velocity-control-system": "planar_move",
    "rotors_gazebo_motor_model": "motor_model",
    "gazebo_motor_model": "motor_model",
    "gz-sim-multicopter-motor-model-system": "motor_model",
    "rotors_gazebo_controller_interface": "rotors",
    "rotors_gazebo_multirotor_base_plugin": "rotors",
    "rotors_gazebo_imu_plugin": "rotors",
    "rotors_gazebo_odometry_plugin": "rotors_odometry",
    "warthog_suspension_plugin": "warthog_suspension",
    "gazebo_ros_camera": "camera",
    "gazebo_ros_multicamera": "camera",
    "gazebo_ros_depth_camera": "depth_camera",
    "gazebo_ros_openni_kinect": "depth_camera",
    "gazebo_ros_triggered_camera": "camera",
    "gazebo_ros_triggered_multicamera": "camera",
    "gazebo_ros_prosilica": "camera",
    "realsense_gazebo_plugin": "realsense",
    "gazebo_ros_laser": "laser",
    "gazebo_ros_gpu_laser": "laser",
    "gazebo_ros_ray_sensor": "ray_sensor",
    "gazebo_ros_block_laser": "block_laser",
    "gazebo_ros_velodyne_laser": "velodyne_laser",
    "gazebo_ros_velodyne_gpu_laser": "velodyne_laser",
    "gazebo_ros_range": "range",
    "hector_gazebo_ros_sonar": "range",
    "gazebo_ros_p3d": "p3d",
    "gazebo_world_odometry": "p3d",
    "gz-sim-odometry-publisher-system": "p3d",
    "gz-sim-pose-publisher-system": "pose_publisher",
    "gz-sim-linearbatteryplugin-system": "battery",
    "gz-sim-linear-battery-plugin-system": "battery",
    "gazebo_ros_joint_state_publisher": "joint_state_publisher",
    "gz-sim-joint-state-publisher-system": "joint_state_publisher",
    "gz-sim-joint-position-controller-system": "gz_joint_controller",
    "gz-sim-joint-controller-system": "gz_joint_controller",
    "gz-sim-apply-joint-force-system": "gz_joint_controller",
    "gz-sim-joint-trajectory-controller-system": "gz_joint_trajectory",
    "gazebo_ros_joint_pose_trajectory": "joint_pose_trajectory",
    "gazebo_ros_joint_trajectory": "joint_pose_trajectory",
    "roboticsgroup_upatras_gazebo_mimic_joint_plugin": "mimic_joint",
    "roboticsgroup_gazebo_mimic_joint_plugin": "mimic_joint",
    "gazebo_mimic_joint_plugin": "mimic_joint",
    "leo_gazebo_differential_plugin": "mimic_joint",
    "gazebo_underactuated_finger": "underactuated_finger",
    "gazebo_ros_ft_sensor": "ft_sensor",
    "gazebo_ros_f3d": "f3d",
    "gazebo_ros_force": "force",
    "gazebo_ros_hand_of_god": "hand_of_god",
    "gazebo_ros_wheel_slip": "wheel_slip",
    "gz-sim-wheel-slip-system": "wheel_slip",
    "WheelSlipPlugin": "wheel_slip",
    "gazebo_ros_imu": "imu",
    "gazebo_ros_imu_sensor": "imu",
    "hector_gazebo_ros_imu": "hector_imu",
    "gazebo_ros_gps_sensor": "gps",
    "hector_gazebo_ros_gps": "gps",
    "hector_gazebo_ros_magnetic": "magnetic",
    "hector_gazebo_ros_baro": "hector_baro",
    "gazebo_ros_bumper": "contact",
    "unitreeFootContactPlugin": "foot_contact",
    "gazebo_ros_elevator": "elevator",
    "ElevatorPlugin": "elevator",
    "gazebo_grasp_fix": "grasp_fix",
    "gazebo_ros_vacuum_gripper": "vacuum_gripper",
    "gazebo_ros_link_attacher": "link_attacher",
    "gazebo_link_attacher": "link_attacher",
    "gz-sim-detachable-joint-system": "detachable_joint",
    "gazebo_ros_harness": "harness",
    "HarnessPlugin": "harness",
    ROS_CONTROL: "control.ros_control",
    "gazebo_ros2_control": "control.ros2_control",
    "gz_ros2_control-system": "control.ros2_control",
    "ign_ros2_control-system": "control.ros2_control",
}
"""The module in this package that defines the plugin, by the plugin's short name."""
_SENSORS = {
    "gpu_lidar": "gz_lidar",
    "lidar": "gz_lidar",
    "gpu_ray": "gz_lidar",
    "ray": "gz_lidar",
    "camera": "gz_camera",
    "rgbd_camera": "gz_camera",
    "depth_camera": "gz_camera",
    "depth": "gz_camera",
    "imu": "imu",
    "navsat": "gps",
    "gps": "gps",
    "magnetometer": "magnetic",
    "air_pressure": "air_pressure",
    "altimeter": "altimeter",
    "logical_camera": "logical_camera",
    "contact": "gz_contact",
    "force_torque": "ft_sensor",
}
"""The module that defines the plugin for sensors without a ``<plugin>``, by sensor type."""


def short_name(filename: str) -> str:
    """Returns a plugin's name without path, ``lib``, ``.so`` and outdated vendor prefixes."""
    stem = filename.rsplit("/", 1)[-1]
    stem = re.sub(r"\.(so|dylib|dll)$", "", stem)
    stem = stem.removeprefix("lib")
    # Some names contain a major version: ignition-gazebo6-, gz-sim8-.
    return re.sub(r"^(ignition-gazebo|gz-sim)\d*-", "gz-sim-", stem)


def plugin_named(filename: str) -> type[Plugin[object]] | None:
    """Returns the plugin for a file name, or None. Installed packages take precedence."""
    name = short_name(filename)
    for plugin in _third():
        if name in _names(plugin):
            return plugin
    if name not in _FILES and name.endswith(f"_{ROS_CONTROL}"):
        # Other vendors derive plugins from it: Baxter, HSR, Schunk.
        name = ROS_CONTROL
    ours = _within(_FILES[name]) if name in _FILES else ()
    return next((plugin for plugin in ours if name in _names(plugin)), None)


def plugin_serving(kind: str) -> type[Plugin[object]] | None:
    """Returns the plugin for sensors of a type that need no ``<plugin>``, or None."""
    for plugin in _third():
        if kind in plugin.serves:
            return plugin
    ours = _within(_SENSORS[kind]) if kind in _SENSORS else ()
    return next((plugin for plugin in ours if kind in plugin.serves), None)


def plugin_names() -> list[str]:
    """Returns the short names of all plugins."""
    return [*_FILES, *(name for plugin in _third() for name in _names(plugin))]


def all_plugins() -> list[type[Plugin[object]]]:
    """Returns all plugins: those with a file name, then those for sensors without a plugin."""
    plugins = [plugin_named(name) for name in plugin_names()]
    plugins += [plugin_serving(kind) for kind in _SENSORS]
    return list(dict.fromkeys(plugin for plugin in plugins if plugin is not None))


def _third() -> tuple[type[Plugin[object]], ...]:
    """Plugins in installed packages. For equal names, the last installed takes precedence."""
    return _installed()[0]


def unloadable() -> tuple[str, ...]:
    """Returns a message for each installed plugin that cannot be loaded."""
    return _installed()[1]


@functools.cache
def _installed() -> tuple[tuple[type[Plugin[object]], ...], tuple[str, ...]]:
    plugins: list[type[Plugin[object]]] = []
    broken: list[str] = []
    for entry in importlib.metadata.entry_points(group="cartwheel.plugins"):
        package = entry.dist.name if entry.dist else entry.value
        try:
            plugin = entry.load()
            if not (isinstance(plugin, type) and issubclass(plugin, Plugin)):
                raise TypeError(f"{entry.value} must be a subclass of Plugin")
            if isinstance(plugin.filenames, str):
                raise TypeError(f"{entry.value}.filenames must be a tuple of strings, not a string")
            names = (*plugin.filenames, *plugin.serves)
            if not all(isinstance(name, str) for name in names):
                raise TypeError(
                    f"{entry.value}.filenames and {entry.value}.serves must contain only strings"
                )
            if not dataclasses.is_dataclass(plugin.parameters):
                raise TypeError(f"{entry.value}.parameters must be a dataclass")
        except (Exception, SystemExit) as error:  # noqa: BLE001 - code in a different package
            broken.append(
                f'The plugin "{entry.name}" of the installed package "{package}" cannot be '
                f"loaded: {type(error).__name__}: {error}."
            )
        else:
            plugins.insert(0, plugin)
    return tuple(plugins), tuple(broken)


def _names(plugin: type[Plugin[object]]) -> Iterator[str]:
    return map(short_name, plugin.filenames)


@functools.cache
def _within(module: str) -> tuple[type[Plugin[object]], ...]:
    """The plugins that a module in this package defines."""
    imported = importlib.import_module(f"cartwheel.plugins.{module}")
    return tuple(
        each
        for each in vars(imported).values()
        if isinstance(each, type)
        and issubclass(each, Plugin)
        and each.__module__ == imported.__name__
        and hasattr(each, "filenames")
    )
