"""``libgazebo_ros_planar_force_move.so``: a base that its velocity or forces move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.description.model import RobotDescription
from cartwheel.devices.drives.odometry import (
    NO_COVARIANCE,
    OdometryConfig,
    planar_covariance,
)
from cartwheel.devices.drives.planar import PlanarDrive, PlanarDriveConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarForceMoveParameters:
    command_topic: str = drive_tags.command_topic("commandTopic")
    odometry_topic: str = drive_tags.odometry_topic("odometryTopic")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    rate: float = drive_tags.odometry_rate("odometryRate")
    sideways: bool = tag(
        "enableYAxis", default=True, doc="Whether `linear.y` of the commands is followed."
    )
    forces: bool = tag(
        "useForceFeedback",
        default=False,
        doc="Whether forces move the robot, with the gains below. Otherwise, its velocity is "
        "controlled as stiffly as with `libgazebo_ros_planar_move.so`.",
    )
    link: str = tag(
        "appliedForceLink",
        default="base_link",
        role="link",
        doc="Link at whose centre of mass the forces act, if it is fixed to the root link. If it "
        "has no mass, they act at the centre of mass of all links that are fixed to the root link. "
        "Otherwise, they act at the centre of mass of the robot.",
    )
    x_gain: float = tag(
        "forceGainX",
        default=20000.0,
        unit="N s/m",
        least=0.0,
        doc="Force divided by the error of the linear velocity.",
    )
    y_gain: float = tag(
        "forceGainY",
        default=20000.0,
        unit="N s/m",
        least=0.0,
        doc="Must be equal to `<forceGainX>`, because one gain applies to both directions.",
    )
    turn_gain: float = tag(
        "forceGainRot",
        default=5000.0,
        unit="N m s/rad",
        least=0.0,
        doc="Torque divided by the error of the yaw rate.",
    )
    dead_zone: float = tag(
        "velocityDeadZone",
        default=0.0001,
        doc="No effect: a command of 0 also holds the velocity, not the position.",
    )


class PlanarForceMove(Plugin[PlanarForceMoveParameters]):
    """Moves the robot in the xy plane as commanded by Twist messages, and publishes odometry.

    The robot needs no wheels. The odometry is the ground-truth pose. Original plugin:
    ``gazebo_ros_planar_force_move`` in the package ``seed_r7_gazebo`` and in packages of JSK.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_planar_force_move.so",)
    moves_model: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        if config.forces and config.y_gain != config.x_gain:
            self.warn_ignored("forceGainY", "<forceGainX> is used in both directions")
        pushed: tuple[str, ...] = ()
        trunk = _trunk(self.part.description)
        name = config.link.strip()
        if config.forces and name in trunk:
            link = self.part.description.link(name)
            heavy = link is not None and link.inertial is not None and link.inertial.mass > 0
            pushed = (name,) if heavy else tuple(sorted(trunk))
        odometry = OdometryConfig(
            topic=config.odometry_topic,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=config.rate,
            transform=True,
            pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
            twist_covariance=NO_COVARIANCE,
        )
        self.add(
            PlanarDrive(
                self.scope,
                PlanarDriveConfig(
                    command_topic=config.command_topic,
                    sideways=config.sideways,
                    pushed=pushed,
                    gains=(config.x_gain, config.turn_gain) if config.forces else None,
                    odometry=odometry if config.rate > 0 else None,
                ),
            )
        )


def _trunk(robot: RobotDescription) -> set[str]:
    """The links that fixed joints connect with the root link."""
    found, waiting = {robot.canonical_link}, [robot.canonical_link]
    while waiting:
        name = waiting.pop()
        for joint in robot.joints:
            if joint.type != "fixed" or name not in (joint.parent, joint.child):
                continue
            other = joint.child if joint.parent == name else joint.parent
            if other not in found:
                found.add(other)
                waiting.append(other)
    return found
