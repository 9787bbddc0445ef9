"""``libplugin_drone.so``: the quadrotor of sjtu_drone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.air.staged_quadrotor import StagedQuadrotor, StagedQuadrotorConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.position.truth import GroundTruth, GroundTruthConfig
from cartwheel.dialects.makers.flying.quadrotor_tags import (
    QuadrotorTags,
    filter_tag,
    gain_tag,
    limit_tag,
    read_control,
    read_pid,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag

_P, _D = 5.0, 1.0
"""Default gains."""
_PLACE, _HEIGHT = "the horizontal position", "the height"


@dataclass(frozen=True, kw_only=True, slots=True)
class SjtuDroneParameters(QuadrotorTags):
    place_p: float | None = gain_tag("positionXY", "Proportional", _PLACE)
    place_i: float | None = gain_tag("positionXY", "Integral", _PLACE)
    place_d: float | None = gain_tag("positionXY", "Differential", _PLACE)
    place_time: float = filter_tag("positionXY", _PLACE)
    place_limit: float = limit_tag("positionXY", _PLACE)
    height_p: float | None = gain_tag("positionZ", "Proportional", _HEIGHT)
    height_i: float | None = gain_tag("positionZ", "Integral", _HEIGHT)
    height_d: float | None = gain_tag("positionZ", "Differential", _HEIGHT)
    height_time: float = filter_tag("positionZ", _HEIGHT)
    height_limit: float = limit_tag("positionZ", _HEIGHT)
    noise: float = tag(
        "motionSmallNoise",
        default=0.0,
        least=0.0,
        doc="Largest noise on the angular and vertical commands, in rad/s and m/s.",
    )
    drift: float = tag(
        "motionDriftNoise",
        default=0.0,
        least=0.0,
        doc="Largest drift of the angular and vertical commands, in rad/s and m/s.",
    )
    drift_time: float = tag(
        "motionDriftNoiseTime",
        default=1.0,
        unit="s",
        least=SMALLEST,
        doc="Time after which the drift changes.",
    )
    odometry: bool = tag(
        "pub_odom", default=False, doc="Whether to publish odometry, with its transform."
    )
    odometry_rate: float = tag(
        "odom_hz", default=30.0, unit="Hz", least=SMALLEST, doc="Rate of the odometry."
    )
    offset: str = tag("xyzOffset", default="", doc="No effect, as in Gazebo.")
    rotation: str = tag("rpyOffset", default="", doc="No effect, as in Gazebo.")


class SjtuDrone(Plugin[SjtuDroneParameters]):
    """Flies a quadrotor without propellers, which takes off and lands by messages.

    A message on ``takeoff`` (Empty) starts the flight: for 0.5 s, the force is 1.5 times the one
    that follows the command. On ``land`` (Empty), it is 0.8 times that force for 1 s, and then 0.
    In flight, ``cmd_vel`` contains velocities in level axes and the yaw rate. After ``true`` on
    ``posctrl`` (Bool), it contains a position in the world. ``dronevel_mode`` (Bool) selects
    whether ``angular.x`` and ``angular.y`` are velocities or angles during the takeoff. ``state``
    (Int8) is 0 on the ground, 1 in flight, 2 during the takeoff and 3 during the landing.

    The default gains are 5 (proportional) and 1 (differential). ``gt_vel`` and ``gt_acc`` are in
    the axes of the link. Original plugin: ``plugin_drone`` in the package
    ``sjtu_drone_description``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libplugin_drone.so",)

    def configure(self) -> None:
        config = self.config
        control = read_control(self, p=_P, d=_D, acts_at="centre of mass", leads=False)
        self.add(
            StagedQuadrotor(
                self.scope,
                StagedQuadrotorConfig(
                    control=control,
                    place=read_pid(config, "place", p=_P, d=_D),
                    height=read_pid(config, "height", p=_P, d=_D),
                    noise=config.noise,
                    drift=config.drift,
                    drift_time=config.drift_time,
                ),
            )
        )
        if config.odometry:
            space = f"{self.namespace.strip('/')}/" if self.namespace.strip("/") else ""
            self.add(
                GroundTruth(
                    self.scope,
                    GroundTruthConfig(
                        link=control.link,
                        twist_in_link=True,
                        noise=0.0,
                        noise_name=f"{self.tag.name} odometry",
                        odometry=OdometryConfig(
                            topic="odom",
                            frame=f"{space}odom",
                            base=f"{space}base_footprint",
                            rate=config.odometry_rate,
                            pose_covariance=np.zeros(36),
                            twist_covariance=np.zeros(36),
                        ),
                    ),
                )
            )
