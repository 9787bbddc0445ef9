"""``libSimpleTrackedVehiclePlugin.so`` and ``libWheelTrackedVehiclePlugin.so``: tracks."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, TypeVar

from cartwheel.description.model import Cylinder
from cartwheel.devices.drives.differential import DifferentialDriveConfig, WheelPair
from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.track import TrackConfig
from cartwheel.devices.drives.tracked_vehicle import TrackedVehicle, TrackedVehicleConfig
from cartwheel.dialects.drive_tags import commands_only
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, box_radius, wheel_link
from cartwheel.geometry import IDENTITY, Vec3
from cartwheel.world.entry import Grip

_FORWARD: Vec3 = (1.0, 0.0, 0.0)
_LEAST = 0.1
"""Velocity in m/s or rad/s below which the tracks do not turn the vehicle, or only turn it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TracksParameters:
    namespace: str = tag(
        "robot_namespace", default="", doc="Namespace of the topic. Default: the model's name."
    )
    efficiency: float = tag(
        "steering_efficiency",
        default=0.5,
        least=SMALLEST,
        doc="Yaw rate as a fraction of that of wheels that do not slip.",
    )
    separation: float = tag(
        "tracks_separation",
        default=0.4,
        unit="m",
        least=SMALLEST,
        doc="Distance between the left and the right tracks.",
    )
    speed: float = tag(
        "max_linear_speed",
        default=1.0,
        unit="m/s",
        least=SMALLEST,
        doc="Maximum speed of the vehicle and of its tracks.",
    )
    turn: float = tag(
        "max_angular_speed", default=1.0, unit="rad/s", least=0.0, doc="Maximum yaw rate."
    )
    mu: float | None = tag(
        "track_mu",
        default=None,
        least=0.0,
        doc="Friction coefficient of the tracks in the first direction. Default: as described.",
    )
    mu2: float | None = tag(
        "track_mu2",
        default=None,
        least=0.0,
        doc="Friction coefficient of the tracks in the second direction. Default: as described.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class SimpleTracksParameters(TracksParameters):
    body: str = tag(
        "body", role="link", doc="Link about whose origin the vehicle turns, with x to its front."
    )
    left: str = tag("left_track", role="link", doc="Link whose collisions are the left track.")
    right: str = tag("right_track", role="link", doc="Link whose collisions are the right track.")
    left_flippers: tuple[str, ...] = tag(
        "left_flipper",
        default=(),
        role="link",
        doc="Link whose collisions are a track of a left flipper. Repeat the tag for several.",
    )
    right_flippers: tuple[str, ...] = tag(
        "right_flipper",
        default=(),
        role="link",
        doc="Link whose collisions are a track of a right flipper. Repeat the tag for several.",
    )
    bits: int = tag("collide_without_contact_bitmask", default=1, doc="No effect.")


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelTracksParameters(TracksParameters):
    left: tuple[str, ...] = tag(
        "left_joint",
        role="left_wheel",
        doc="Joint of a wheel of the left track. Repeat the tag for each wheel.",
    )
    right: tuple[str, ...] = tag(
        "right_joint",
        role="right_wheel",
        doc="Joint of a wheel of the right track. Repeat the tag for each wheel.",
    )
    torque: float = tag(
        "max_torque",
        default=5.0,
        unit="N m",
        role="wheel_torque",
        least=SMALLEST,
        doc="Maximum torque of each wheel.",
    )


C = TypeVar("C", bound=TracksParameters)


class _Tracks(Plugin[C]):
    """What both plugins have in common."""

    def configure(self) -> None:
        stated = self.tag.element.find("robot_namespace")
        self.namespace = self.part.name if stated is None else self.config.namespace.strip()

    def _limits(self) -> tuple[Limits, Limits]:
        """The limits on the forward speed and on the yaw rate."""
        config = self.config
        return (
            Limits(velocity=(-config.speed, config.speed)),
            Limits(velocity=(-config.turn, config.turn)),
        )

    def _grip(self, links: Iterable[str], direction: tuple[str, Vec3] | None) -> None:
        """Sets the friction of tracks."""
        grip = Grip(mu1=self.config.mu, mu2=self.config.mu2, direction=direction)
        for link in links:
            self.part.grip(link, grip, origin=self.origin)


class SimpleTrackedVehicle(_Tracks[SimpleTracksParameters]):
    """Drives a vehicle on tracks, which are links with a moving surface, by Twist messages.

    The original plugin subscribes to Gazebo's own topics ``~/<robot_namespace>/cmd_vel`` and
    ``~/<robot_namespace>/cmd_vel_twist``, where a positive yaw rate turns the vehicle to the right.
    Here, the topic is ``/<robot_namespace>/cmd_vel``, and a positive yaw rate turns it to the left,
    as in ROS.

    The tracks slip in a turn, so the yaw rate depends on ``<steering_efficiency>`` and on the shape
    of the tracks. As in Gazebo, a vehicle with a yaw rate of less than 0.1 rad/s drives straight
    ahead as far as friction allows, and with a speed of less than 0.1 m/s, it turns in place.
    ``<track_mu>`` applies in the direction of motion. Original plugin:
    ``SimpleTrackedVehiclePlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libSimpleTrackedVehiclePlugin.so",)

    def configure(self) -> None:
        super().configure()
        config = self.config
        body = config.body.strip()
        sides = [
            [each.strip() for each in side]
            for side in (
                (config.left, *config.left_flippers),
                (config.right, *config.right_flippers),
            )
        ]
        left, right = (tuple(_track(link) for link in side) for side in sides)
        self.part.link(body, origin=self.scope.place_of("body"))
        for side in sides:
            self._grip(side, (body, _FORWARD))
        linear, angular = self._limits()
        self.add(
            TrackedVehicle(
                self.scope,
                TrackedVehicleConfig(
                    body=body,
                    left=left,
                    right=right,
                    separation=config.separation,
                    efficiency=config.efficiency,
                    efficiency_topic=None,
                    least=_LEAST,
                    most=config.speed,
                    linear=linear,
                    angular=angular,
                    drive=commands_only(self.part),
                ),
            )
        )


class WheelTrackedVehicle(_Tracks[WheelTracksParameters]):
    """Drives a vehicle whose tracks are rows of wheels, as commanded by Twist messages.

    All wheels on a side have the same rim speed. The radius of a wheel is that of its only
    collision if this is a cylinder, and otherwise half the longest edge of its bounding box. The
    topic of the commands and the direction of the yaw rate are those of
    `libSimpleTrackedVehiclePlugin.so`. Original plugin: ``WheelTrackedVehiclePlugin`` in Gazebo
    Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libWheelTrackedVehiclePlugin.so",)

    def configure(self) -> None:
        super().configure()
        config = self.config
        left, right = ([each.strip() for each in side] for side in (config.left, config.right))
        separation = config.separation / config.efficiency
        linear, angular = self._limits()
        pairs = tuple(
            WheelPair(
                left=one,
                right=other,
                separation=separation,
                left_radius=self._radius(one),
                right_radius=self._radius(other),
            )
            # Extra wheels on one side are paired with the last wheel on the other side.
            for one, other in (
                (one or left[-1], other or right[-1])
                for one, other in itertools.zip_longest(left, right)
            )
        )
        wheels = [self.part.description.joint(name) for name in (*left, *right)]
        self._grip((each.child for each in wheels if each is not None), None)
        add_differential_drive(
            self,
            DifferentialDriveConfig(
                pairs=pairs,
                max_torque=config.torque,
                max_rim_speed=config.speed,
                linear=linear,
                angular=angular,
                drive=commands_only(self.part),
            ),
        )

    def _radius(self, joint: str) -> float:
        """The radius of a wheel, m.

        Raises:
            UnknownNameError: The joint does not exist.
            PluginError: The wheel has no collision.
        """
        collisions = wheel_link(self, joint).collisions
        if len(collisions) == 1 and isinstance(collisions[0].shape, Cylinder):
            return collisions[0].shape.radius
        return box_radius(self, joint)


def _track(link: str) -> TrackConfig:
    return TrackConfig(link=link, orientation=IDENTITY, topics=None, projected=True)
