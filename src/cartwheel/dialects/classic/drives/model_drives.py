"""``libDiffDrivePlugin.so`` and ``libSkidSteerDrivePlugin.so``, which Gazebo Classic contains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.drives.differential import DifferentialDriveConfig
from cartwheel.dialects.drive_tags import commands_only
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_pairs import (
    add_differential_drive,
    box_radius,
    joint_distance,
    wheel_pairs,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelDiffDriveParameters:
    left_joint: str = tag("left_joint", role="left_wheel", doc="Joint of the left wheel.")
    right_joint: str = tag("right_joint", role="right_wheel", doc="Joint of the right wheel.")
    torque: float = tag(
        "torque",
        default=5.0,
        unit="N m",
        doc="No effect, as in Gazebo 11: the torque is unlimited.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelSkidSteerParameters:
    right_front: str = tag(
        "right_front",
        default="right_front",
        role="right_wheel",
        doc="Joint of the right front wheel. Gazebo 11 reads none of these tags, and always uses "
        "the joints with the default names.",
    )
    right_rear: str = tag(
        "right_rear",
        default="right_rear",
        role="right_wheel",
        doc="Joint of the right rear wheel.",
    )
    left_front: str = tag(
        "left_front",
        default="left_front",
        role="left_wheel",
        doc="Joint of the left front wheel.",
    )
    left_rear: str = tag(
        "left_rear", default="left_rear", role="left_wheel", doc="Joint of the left rear wheel."
    )
    torque: float = tag(
        "max_force",
        "MaxForce",
        default=5.0,
        unit="N m",
        doc="No effect, as in Gazebo 11: the torque is unlimited.",
    )


class ModelDiffDrive(Plugin[ModelDiffDriveParameters]):
    """Drives a left and a right wheel as commanded by Twist messages.

    The original plugin subscribes to poses on Gazebo's own topic ``~/<model>/vel_cmd``, where a
    positive yaw rate turns the robot to the right. Here, the topic is ``/<model>/cmd_vel``, and a
    positive yaw rate turns it to the left, as in ROS.

    The wheel separation is the distance between the two joints. The radius of both wheels is half
    the longest edge of the left wheel's bounding box, so wheels must not be wider than high. The
    wheels have the commanded speed whatever torque they need. Original plugin: ``DiffDrivePlugin``
    in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libDiffDrivePlugin.so",)

    def configure(self) -> None:
        left, right = self.config.left_joint.strip(), self.config.right_joint.strip()
        separation = joint_distance(self, left, right)
        _drive(self, [(left, right)], separation, box_radius(self, left))


class ModelSkidSteer(Plugin[ModelSkidSteerParameters]):
    """Drives a four-wheeled skid-steer robot as commanded by Twist messages.

    The original plugin subscribes to poses on Gazebo's own topic ``~/<model>/vel_cmd``. Here, the
    topic is ``/<model>/cmd_vel``. A positive yaw rate turns the robot to the left in both.

    The wheel separation is the distance between the joints of the front wheels. The radius of all
    wheels is half the longest edge of the right front wheel's bounding box, so wheels must not be
    wider than high. As in Gazebo, the speeds of the left and right wheels differ by twice the
    product of yaw rate and wheel separation, so wheels that did not slide would turn the robot at
    twice the commanded rate. Original plugin: ``SkidSteerDrivePlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libSkidSteerDrivePlugin.so",)

    def configure(self) -> None:
        config = self.config
        pairs = [
            (left.strip(), right.strip())
            for left, right in (
                (config.left_front, config.right_front),
                (config.left_rear, config.right_rear),
            )
        ]
        separation = 2 * joint_distance(self, *pairs[0])
        _drive(self, pairs, separation, box_radius(self, pairs[0][1]))


def _drive(
    plugin: Plugin[Any], joints: Sequence[tuple[str, str]], separation: float, radius: float
) -> None:
    plugin.namespace = plugin.part.name
    add_differential_drive(
        plugin,
        DifferentialDriveConfig(
            pairs=wheel_pairs(plugin, joints, [separation], [2 * radius]),
            effort_limits=False,
            drive=commands_only(plugin.part),
        ),
    )
