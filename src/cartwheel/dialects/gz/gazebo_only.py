"""Plugins of one Gazebo in a robot that launch files start in the other one.

From gz-sim's SystemLoader, which looks for a class of gz-sim in the library, and from Gazebo
Classic's loader of plugins: neither loads a plugin of the other one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel.codes.devices import PLUGIN_OF_OTHER_GAZEBO
from cartwheel.description.elements.simulator import plugin_files
from cartwheel.description.files.package_folders import is_in_stand_in
from cartwheel.description.launches import LaunchUse, in_simulator
from cartwheel.description.loading import open_description
from cartwheel.description.model import PluginTag, RobotDescription, Sensor, Simulator
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.sensor_tags import RAYS_ON_CPU, SYSTEMS, is_of_gz
from cartwheel.dialects.ros_only import is_built, other_ros
from cartwheel.dialects.substitutes import rewritten
from cartwheel.errors import CartwheelError, Diagnostic

_SYSTEMS: Mapping[str, str] = {
    "gz-sim-ackermann-steering-system": "AckermannSteering",
    "gz-sim-diff-drive-system": "DiffDrive",
    "gz-sim-joint-state-publisher-system": "JointStatePublisher",
    "gz-sim-lift-drag-system": "LiftDrag",
    "gz-sim-odometry-publisher-system": "OdometryPublisher",
    "gz-sim-velocity-control-system": "VelocityControl",
}
"""Systems of gz-sim, with their classes in the namespace ``gz::sim::systems``."""
_CONTROL = "gz_ros2_control-system"
_PAIRS = (
    ("gazebo_ros2_control", _CONTROL),
    ("gazebo_ros_control", _CONTROL),
    ("gazebo_ros_diff_drive", "gz-sim-diff-drive-system"),
    ("gazebo_ros_skid_steer_drive", "gz-sim-diff-drive-system"),
    ("gazebo_ros_ackermann_drive", "gz-sim-ackermann-steering-system"),
    ("gazebo_ros_planar_move", "gz-sim-velocity-control-system"),
    ("gazebo_ros_joint_state_publisher", "gz-sim-joint-state-publisher-system"),
    ("gazebo_ros_p3d", "gz-sim-odometry-publisher-system"),
    ("LiftDragPlugin", "gz-sim-lift-drag-system"),
)
"""Plugins of Gazebo Classic, each with that of gz-sim for the same purpose."""
_TO_GZ = dict(_PAIRS)
_TO_CLASSIC = {gz: classic for classic, gz in reversed(_PAIRS)} | {
    "ign_ros2_control-system": "gazebo_ros2_control",
    _CONTROL: "gazebo_ros2_control",
}
_DRIVES = frozenset(
    {
        "ackermann",
        "control",
        "controller",
        "diff",
        "mecanum",
        "planar",
        "skid",
        "thruster",
        "tracked",
        "trajectory",
        "velocity",
    }
)
"""Words in the names of plugins that move a robot."""
_OF_ROS = "gazebo_ros_"
"""Beginning of the names of gazebo_ros_pkgs' plugins."""
_SHOWN: Mapping[Simulator, str] = {"classic": "Gazebo Classic", "gz": "gz-sim"}
_MOST_EXPANDED = 4
"""Maximum number of arguments of launch files with which a description is expanded."""


def gazebo_of(filename: str) -> Simulator:
    """The only Gazebo that has a plugin; empty for plugins of others."""
    name = short_name(filename)
    if name in _TO_CLASSIC or is_of_gz(name):
        return "gz"
    return "classic" if name in _TO_GZ or name.startswith(_OF_ROS) else ""


def as_launched(
    robot: RobotDescription,
    file: Path,
    launches: Iterable[LaunchUse],
    given: Mapping[str, str],
    package_path: Sequence[Path] = (),
) -> RobotDescription:
    """A robot with the Gazebo in which launch files start it.

    Plugins of the other Gazebo are `unlaunched` if the description does not contain them with the
    arguments of the launch files, such as ``gazebo:=ignition``.

    Args:
        robot: The robot.
        file: Its file.
        launches: The launch files of its author.
        given: The arguments that the user stated.
        package_path: Folders to search for packages first.
    """
    launches = list(launches)
    robot = in_simulator(robot, file, launches)
    others = {
        tag.filename
        for tag in robot.all_plugins
        if robot.simulator and gazebo_of(tag.filename) not in ("", robot.simulator)
    }
    path = file.resolve()
    stated = {
        tuple(sorted(each.arguments.items()))
        for each in launches
        if each.arguments
        and robot.simulator in each.gazebos
        and each.description is not None
        and each.description.resolve() == path
    }
    for arguments in itertools.islice(sorted(stated), _MOST_EXPANDED if others else 0):
        try:
            opened = open_description(file, {**given, **dict(arguments)}, package_path)
        except CartwheelError:
            return robot
        others.difference_update(plugin_files(opened.root))
    return replace(robot, unlaunched=frozenset(others if stated else ()))


def other_gazebo(
    robot: RobotDescription, tag: PluginTag, sensor: Sensor | None = None
) -> Diagnostic | None:
    """The finding that the Gazebo in which launch files start a robot does not load a plugin.

    It is an info if the robot also has a plugin for this Gazebo with the same purpose. None if the
    Gazebo is unknown, if the robot's repository builds a plugin of this name, if the robot has the
    plugin only with other arguments than those of the launch files, or if Cartwheel's stand-in for
    a package contains the plugin.

    Args:
        robot: The robot.
        tag: One of its plugins.
        sensor: The sensor that contains the plugin, if one does.
    """
    own = robot.simulator
    kind = gazebo_of(tag.filename)
    if not own or kind in ("", own) or tag.filename in robot.unlaunched:
        return None
    if is_in_stand_in(tag.origin.file) or is_built(robot, tag):
        return None
    replaced = any(_is_alike(tag, other) for other in robot.plugins if _is_for(other, own))
    return PLUGIN_OF_OTHER_GAZEBO.diagnostic(
        f'the plugin "{tag.filename}" is one of {_SHOWN[kind]}, but launch files start the robot '
        f"in {_SHOWN[own]}, which does not load the plugin",
        severity="info" if replaced else "warning",
        origin=tag.origin,
        hint="" if replaced else _advice(tag, own, sensor),
        mark=tag.filename,
        values={"plugin": tag.filename, "exists": kind, "simulator": own},
    )


def not_loaded(robot: RobotDescription, tag: PluginTag) -> Diagnostic | None:
    """The finding that Gazebo does not load a plugin of a model, because it is for another Gazebo
    or version of ROS.
    """
    return other_gazebo(robot, tag) or other_ros(robot, tag)


def with_own_plugins(robot: RobotDescription) -> RobotDescription:
    """A robot without the model plugins of the other Gazebo."""
    own = tuple(tag for tag in robot.plugins if other_gazebo(robot, tag) is None)
    return robot if len(own) == len(robot.plugins) else replace(robot, plugins=own)


def _is_for(tag: PluginTag, simulator: Simulator) -> bool:
    return gazebo_of(tag.filename) == simulator


def _is_alike(one: PluginTag, other: PluginTag) -> bool:
    """Whether two plugins have the same purpose; all that move a robot do."""
    names = [short_name(tag.filename) for tag in (one, other)]
    if all(_moves(name) for name in names):
        return True
    pairs = {_TO_GZ.get(name, _TO_CLASSIC.get(name, "")) for name in names}
    return not pairs.isdisjoint(names)


def _moves(name: str) -> bool:
    return not _DRIVES.isdisjoint(name.replace("-", "_").replace("2", "").split("_"))


def _advice(tag: PluginTag, own: Simulator, sensor: Sensor | None) -> str:
    """What to write for the Gazebo in which the robot is started; empty if nothing is alike."""
    name = short_name(tag.filename)
    if own == "classic":
        found = _TO_CLASSIC.get(name, "")
        text = rewritten(tag, f"lib{found}.so", ros2=True)
        return f"In Gazebo Classic, write {text}." if found else ""
    if sensor is not None and sensor.type in RAYS_ON_CPU:
        return (
            f'gz-sim needs no plugin in a <sensor>, but publishes none of type "{sensor.type}". '
            'Write type="gpu_lidar", and delete the plugin.'
        )
    if sensor is not None:
        systems = [system for system, types in SYSTEMS.items() if sensor.type in types]
        return "".join(
            f'gz-sim needs no plugin in a <sensor>: the system "{each}" of the world or the robot '
            "publishes it on its <topic>. Delete the plugin."
            for each in systems
        )
    found = _TO_GZ.get(name, "")
    if not found:
        return ""
    if found == _CONTROL:
        return (
            f'In gz-sim, write filename="{_CONTROL}" and '
            'name="gz_ros2_control::GazeboSimROS2ControlPlugin", and in the <hardware> of '
            "<ros2_control> <plugin>gz_ros2_control/GazeboSimSystem</plugin>."
        )
    text = rewritten(tag, found, name=f"gz::sim::systems::{_SYSTEMS[found]}")
    return f"In gz-sim, write {text}."
