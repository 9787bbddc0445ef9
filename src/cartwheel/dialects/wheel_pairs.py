"""The wheel pairs in a plugin's tags: checked before and after the drive is created."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np

from cartwheel.codes import devices, robot
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Link, RobotDescription
from cartwheel.description.solids import bounds, solid_of
from cartwheel.devices.drives.differential import (
    DifferentialDrive,
    DifferentialDriveConfig,
    WheelPair,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, invalid
from cartwheel.errors import PluginError
from cartwheel.geometry import rotate
from cartwheel.simulation.limits import FARTHEST


def wheel_pairs(
    plugin: Plugin[Any],
    joints: Sequence[tuple[str, str]],
    separations: Sequence[float],
    diameters: Sequence[float],
) -> tuple[WheelPair, ...]:
    """Returns pairs of wheels.

    Args:
        plugin: The plugin whose tags state the pairs.
        joints: Joints of the left and right wheel of each pair.
        separations: Distance between the wheels of each pair, m. The last one applies to the
            remaining pairs.
        diameters: Diameter of both wheels of each pair, m. The last one applies to the remaining
            pairs.

    Raises:
        PluginError: A separation or diameter is not allowed.
    """
    pairs = []
    for index, (left, right) in enumerate(joints):
        separation = separations[min(index, len(separations) - 1)]
        diameter = diameters[min(index, len(diameters) - 1)]
        for value, what in ((separation, "separation"), (diameter, "diameter or radius")):
            if not SMALLEST <= value <= FARTHEST:
                raise PluginError(
                    f"the {what} of the wheels must be between {SMALLEST:g} and {FARTHEST:g} m "
                    f"(got {value:g} m)",
                    code=devices.PLUGIN_PARAMETER_INVALID,
                    origin=plugin.origin,
                    values={"parameter": what, "value": value},
                )
        radius = diameter / 2
        pairs.append(
            WheelPair(
                left=left,
                right=right,
                separation=separation,
                left_radius=radius,
                right_radius=radius,
            )
        )
    return tuple(pairs)


def wheel_link(plugin: Plugin[Any], joint: str) -> Link:
    """Returns the link that a joint turns.

    Raises:
        UnknownNameError: The joint does not exist.
    """
    plugin.part.joint(joint, origin=plugin.origin)
    description = plugin.part.description
    described: Any = description.joint(joint)
    return cast("Link", description.link(described.child))


def box_radius(plugin: Plugin[Any], joint: str) -> float:
    """Returns half the longest edge of the bounding box of a wheel's collisions, m.

    Raises:
        UnknownNameError: The joint does not exist.
        PluginError: The wheel has no collision.
    """
    link = wheel_link(plugin, joint)
    pose = link_poses(plugin.part.description, {})[link.name]
    solids = (solid_of(each, link.name) for each in link.collisions)
    box = bounds([solid.placed(pose) for solid in solids if solid is not None])
    if box is None:
        raise invalid("joint", joint, "the joint of a wheel with a collision", plugin.origin)
    return float((box[1] - box[0]).max()) / 2


def joint_distance(plugin: Plugin[Any], one: str, other: str) -> float:
    """Returns the distance between the origins of two joints at zero joint positions, m.

    Raises:
        UnknownNameError: A joint does not exist.
    """
    description = plugin.part.description
    poses = link_poses(description, {})
    places = []
    for name in (one, other):
        plugin.part.joint(name, origin=plugin.origin)
        joint: Any = description.joint(name)
        places.append((poses[joint.child] @ joint.pose).position)
    return math.dist(*places)


def add_differential_drive(
    plugin: Plugin[Any],
    config: DifferentialDriveConfig,
    *,
    yaw_rate: Callable[[], float] | None = None,
    hint: str = "",
) -> DifferentialDrive:
    """Adds a differential drive, and reports swapped wheels; see `DifferentialDrive`.

    Args:
        plugin: The plugin.
        config: Wheels, limits and odometry.
        yaw_rate: Returns the yaw rate in rad/s that a gyroscope measures; None: there is none.
        hint: What to do if the wheels are swapped.
    """
    drive = plugin.add(DifferentialDrive(plugin.scope, config, yaw_rate=yaw_rate))
    _report_swapped_wheels(plugin, config.pairs, hint)
    return drive


def _report_swapped_wheels(plugin: Plugin[Any], pairs: Sequence[WheelPair], hint: str) -> None:
    """Reports a left wheel on the right side, because the robot then turns the wrong way."""
    for pair in pairs:
        if are_swapped(plugin.part.description, pair.left, pair.right):
            plugin.warn(
                robot.WHEELS_SWAPPED,
                f'the left wheel ("{pair.left}") is to the right of the right wheel '
                f'("{pair.right}"), so the robot turns the wrong way, as in Gazebo',
                hint=hint,
                values={"left": pair.left, "right": pair.right},
            )
            return


def are_swapped(description: RobotDescription, left: str, right: str) -> bool:
    """Whether a robot turns the wrong way because the joint of its left wheel is on the right.

    If the wheels are beside each other along x, their axes define the sides.
    """
    joints = [description.joint(name) for name in (left, right)]
    wheels = [each for each in joints if each is not None]
    if len(wheels) < 2:
        return False
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    places = [front @ poses[each.child] @ each.pose for each in wheels]
    gap = np.subtract(places[0].position, places[1].position)
    axes = [rotate(at.orientation, each.axis.xyz) for at, each in zip(places, wheels, strict=True)]
    # A robot turns as commanded if its axes point from the right wheel to the left one.
    senses = [float(np.dot(axis, gap)) for axis in axes]
    if abs(gap[1]) < 0.1 * abs(gap[0]):
        return all(sense < 0 for sense in senses)
    return bool(gap[1] < 0 and not all(sense > 0 for sense in senses))
