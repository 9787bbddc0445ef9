"""``gz-sim-track-controller-system``: a track of a vehicle, or a conveyor belt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.track import Track, TrackConfig, TrackTopics
from cartwheel.dialects.gz.bridge_file import namespaced
from cartwheel.dialects.gz.drive_tags import common_limits, gz_name, limit_tag, report_limits
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import quat_from_rpy
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackControllerParameters:
    link: str = tag("link", role="link", doc="Link whose collisions are the track.")
    orientation: tuple[float, float, float] = tag(
        "track_orientation",
        default=(0.0, 0.0, 0.0),
        unit="rad",
        doc="Orientation of the track in the link, as roll, pitch and yaw. A vehicle moves along "
        "the x axis of the track at a positive velocity.",
    )
    velocity_topic: str = tag(
        "velocity_topic",
        default="",
        doc="Topic of the velocity of the track in m/s (Float64). Default: "
        "`/model/<model>/link/<link>/track_cmd_vel`.",
    )
    centre_topic: str = tag(
        "center_of_rotation_topic",
        default="",
        doc="Topic of the point in the world about which the vehicle turns (Vector3). Default: "
        "`/model/<model>/link/<link>/track_cmd_center_of_rotation`.",
    )
    max_command_age: float | None = tag(
        "max_command_age",
        default=None,
        unit="s",
        least=0.0,
        doc="Time after which the track stops without a command. Default: never.",
    )
    odometry_topic: str = tag(
        "odometry_topic",
        default="",
        doc="Topic of the distance and the velocity of the track (Odometry). Default: "
        "`/model/<model>/link/<link>/odometry`.",
    )
    rate: float = tag(
        "odometry_publish_frequency",
        default=50.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate of the odometry. If 0, it is published at every simulation step.",
    )
    min_velocity: float | None = limit_tag("min_velocity", motion="linear")
    max_velocity: float | None = limit_tag("max_velocity", motion="linear")
    min_acceleration: float | None = limit_tag("min_acceleration", motion="linear")
    max_acceleration: float | None = limit_tag("max_acceleration", motion="linear")
    min_jerk: float | None = limit_tag("min_jerk", motion="linear")
    max_jerk: float | None = limit_tag("max_jerk", motion="linear")
    debug: bool = tag("debug", default=False, doc="No effect.")


def track_topics(part: Part, link: str, velocity: str = "", centre: str = "") -> tuple[str, str]:
    """Returns the topics of a track's velocity and of the centre of the turn.

    Args:
        part: The model.
        link: Name of the link.
        velocity: Topic in a tag; empty if there is none.
        centre: Topic in a tag; empty if there is none.
    """
    under = f"/model/{part.name}/link/{link}"
    return (
        namespaced(velocity.strip() or f"{under}/track_cmd_vel", part.namespace),
        namespaced(centre.strip() or f"{under}/track_cmd_center_of_rotation", part.namespace),
    )


class TrackController(Plugin[TrackControllerParameters]):
    """Moves the surface of a track or of a conveyor belt at the commanded velocity.

    Where the track touches another body, friction moves the vehicle, or the object on the belt. The
    friction coefficients apply in the directions that the description states. Original plugin:
    ``TrackController`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-track-controller-system",)

    def configure(self) -> None:
        config = self.config
        report_limits(self, config)
        link = config.link.strip()
        velocity, centre = track_topics(self.part, link, config.velocity_topic, config.centre_topic)
        odometry = config.odometry_topic or f"/model/{self.part.name}/link/{link}/odometry"
        self.add(
            Track(
                self.scope,
                TrackConfig(
                    link=link,
                    orientation=quat_from_rpy(*config.orientation),
                    topics=TrackTopics(
                        velocity=velocity,
                        centre=centre,
                        odometry=gz_name(self, odometry, ""),
                        odometry_rate=config.rate,
                    ),
                    limits=common_limits(config),
                    timeout=config.max_command_age,
                ),
            )
        )
