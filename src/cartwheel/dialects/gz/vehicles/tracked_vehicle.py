"""``gz-sim-tracked-vehicle-system``: a vehicle with left and right tracks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.devices.drives.tracked_vehicle import (
    CommandTopics,
    TrackedVehicle,
    TrackedVehicleConfig,
)
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.drive_tags import (
    GzDriveParameters,
    common_limits,
    gz_drive,
    gz_name,
    limit_tag,
    model_frame,
    report_limits,
)
from cartwheel.dialects.gz.vehicles.track_controller import TrackController, track_topics
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import missing, required, tag

_LINEAR, _ANGULAR = "linear_velocity/", "angular_velocity/"
_TRACK = (
    "track: its `<link>`, and its `<velocity_topic>` and `<center_of_rotation_topic>` if they "
    "differ from the defaults of `gz-sim-track-controller-system`. Repeat the tag for several."
)


def _side(side: str) -> tuple[str, ...]:
    field: tuple[str, ...] = tag(f"{side}_track", default=(), nested=True, doc=f"A {side} {_TRACK}")
    return field


@dataclass(frozen=True, kw_only=True, slots=True)
class TrackedVehicleParameters(GzDriveParameters):
    body: str = tag(
        "body_link",
        default="",
        role="link",
        doc="Link about whose origin the vehicle turns. Default: the root link.",
    )
    left: tuple[str, ...] = _side("left")
    right: tuple[str, ...] = _side("right")
    separation: float = tag(
        "tracks_separation",
        default=1.0,
        unit="m",
        doc="Distance between the left and the right tracks.",
    )
    height: float = tag("track_height", default=0.2, unit="m", doc="No effect, as in gz-sim.")
    efficiency: float = tag(
        "steering_efficiency",
        default=0.5,
        doc="Yaw rate as a fraction of that of wheels that do not slip.",
    )
    efficiency_topic: str = tag(
        "steering_efficiency_topic",
        default="",
        doc="Topic of the steering efficiency (Float64). Default: "
        "`/model/<model>/steering_efficiency`.",
    )
    linear_min_velocity: float | None = limit_tag("min_velocity", motion="linear", path=_LINEAR)
    linear_max_velocity: float | None = limit_tag("max_velocity", motion="linear", path=_LINEAR)
    linear_min_acceleration: float | None = limit_tag(
        "min_acceleration", motion="linear", path=_LINEAR
    )
    linear_max_acceleration: float | None = limit_tag(
        "max_acceleration", motion="linear", path=_LINEAR
    )
    linear_min_jerk: float | None = limit_tag("min_jerk", motion="linear", path=_LINEAR)
    linear_max_jerk: float | None = limit_tag("max_jerk", motion="linear", path=_LINEAR)
    angular_min_velocity: float | None = limit_tag("min_velocity", motion="angular", path=_ANGULAR)
    angular_max_velocity: float | None = limit_tag("max_velocity", motion="angular", path=_ANGULAR)
    angular_min_acceleration: float | None = limit_tag(
        "min_acceleration", motion="angular", path=_ANGULAR
    )
    angular_max_acceleration: float | None = limit_tag(
        "max_acceleration", motion="angular", path=_ANGULAR
    )
    angular_min_jerk: float | None = limit_tag("min_jerk", motion="angular", path=_ANGULAR)
    angular_max_jerk: float | None = limit_tag("max_jerk", motion="angular", path=_ANGULAR)
    debug: bool = tag("debug", default=False, doc="No effect.")


class TrackedVehicleSystem(Plugin[TrackedVehicleParameters]):
    """Drives a vehicle on tracks as commanded by Twist messages, and publishes odometry.

    Each track needs a ``gz-sim-track-controller-system``, which receives its velocity. The tracks
    slip in a turn, so the yaw rate depends on ``<steering_efficiency>`` and on the shape of the
    tracks. As in gz-sim, the odometry is computed from the commanded velocities of the tracks, as
    if they were wheels, so its yaw rate is too high. Original plugin:
    ``TrackedVehicle`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-tracked-vehicle-system",)

    def configure(self) -> None:
        config = self.config
        report_limits(self, config)
        self.check_above_zero(
            tracks_separation=config.separation, steering_efficiency=config.efficiency
        )
        left, right = (tuple(self._tracks(side)) for side in ("left_track", "right_track"))
        body = config.body.strip() or self.part.description.canonical_link
        drive = gz_drive(self, config)
        base = config.child_frame or model_frame(self.part, body)
        self.add(
            TrackedVehicle(
                self.scope,
                TrackedVehicleConfig(
                    body=body,
                    left=left,
                    right=right,
                    separation=config.separation,
                    efficiency=config.efficiency,
                    efficiency_topic=gz_name(self, config.efficiency_topic, "steering_efficiency"),
                    linear=common_limits(config, prefix="linear_"),
                    angular=common_limits(config, prefix="angular_"),
                    drive=replace(
                        drive, control_rate=0.0, odometry=replace(drive.odometry, base=base)
                    ),
                ),
            )
        )

    def _tracks(self, name: str) -> Iterator[CommandTopics]:
        """Yields the topics of the tracks on one side.

        Raises:
            PluginError: There is none, or a link is missing.
        """
        elements = list(self.tag.element.find_all(name))
        if not elements:
            raise missing("plugin", name, self.tag.origin)
        for element in elements:
            link = required(element, "link").text.strip()
            self._check_link(element, link)
            velocity, centre = track_topics(
                self.part,
                link,
                *(_text(element, each) for each in ("velocity_topic", "center_of_rotation_topic")),
            )
            yield CommandTopics(velocity=velocity, centre=centre)

    def _check_link(self, element: Element, link: str) -> None:
        """Warns about a track that nothing moves."""
        for plugin in self.part.description.plugins:
            stated = plugin.element.find("link")
            if (
                short_name(plugin.filename) in map(short_name, TrackController.filenames)
                and stated is not None
                and stated.text.strip() == link
            ):
                return
        self.warn(
            devices.PLUGIN_IDLE,
            f'the track "{link}" has no {TrackController.filenames[0]}, so it does not move',
            at=element.origin,
            values={"link": link},
        )


def _text(element: Element, name: str) -> str:
    found = element.find(name)
    return "" if found is None else found.text
