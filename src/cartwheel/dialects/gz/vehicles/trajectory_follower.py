"""``gz-sim-trajectory-follower-system``: a boat or another model that moves to waypoints."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.water.waypoints import Circle, Line, Point, Waypoints, WaypointsConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import missing, number_at, required, tag, vector


@dataclass(frozen=True, kw_only=True, slots=True)
class TrajectoryFollowerParameters:
    link: str = tag("link_name", role="link", doc="Link on which the force and the torque act.")
    waypoints: str = tag(
        "waypoints",
        default="",
        nested=True,
        doc="A `<waypoint>` with x and y in the world in m for each waypoint.",
    )
    circle: str = tag(
        "circle",
        default="",
        nested=True,
        doc="A circle about the initial position, with a `<radius>` in m. Used without "
        "`<waypoints>`.",
    )
    line: str = tag(
        "line",
        default="",
        nested=True,
        doc="A line from the initial position, with a `<direction>` in rad relative to the initial "
        "heading and a `<length>` in m. Used without `<waypoints>` and `<circle>`.",
    )
    loop: bool = tag("loop", default=False, doc="Whether to start again after the last waypoint.")
    range_tolerance: float = tag(
        "range_tolerance",
        default=0.5,
        unit="m",
        least=0.0,
        doc="Distance at which a waypoint is reached.",
    )
    bearing_tolerance: float = tag(
        "bearing_tolerance",
        default=2.0,
        least=0.0,
        doc="Bearing of the waypoint in degrees up to which the force acts instead of the torque.",
    )
    stops_turning: bool = tag(
        "zero_vel_on_bearing_reached",
        default=False,
        doc="Whether the rotation stops when the bearing is at most half of `<bearing_tolerance>`.",
    )
    force: float = tag("force", default=60.0, unit="N", doc="Force along the link's x axis.")
    torque: float = tag("torque", default=50.0, unit="N m", doc="Torque about the link's z axis.")
    topic: str = tag(
        "topic",
        default="",
        doc="Topic that pauses the motion (Bool). Default: "
        "`/model/<model>/trajectory_follower/pause`.",
    )


class TrajectoryFollower(Plugin[TrajectoryFollowerParameters]):
    """Moves a model to waypoints in the plane, one after the other.

    A torque turns the link to the next waypoint, and a force then moves it there. The model comes
    to rest only if something damps its motion, such as ``gz-sim-hydrodynamics-system``. Without
    ``<loop>``, the last waypoint remains the target. Original plugin: ``TrajectoryFollower`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-trajectory-follower-system",)

    def configure(self) -> None:
        config = self.config
        path = self._path()
        if path == ():
            self.warn(
                devices.PLUGIN_IDLE,
                "there is no <waypoints>, <circle> or <line>, so the model does not move",
                at=self.tag.origin,
            )
        self.add(
            Waypoints(
                self.scope,
                WaypointsConfig(
                    link=config.link.strip(),
                    path=path,
                    loops=config.loop,
                    reached=config.range_tolerance,
                    aligned=math.radians(config.bearing_tolerance),
                    stops_turning=config.stops_turning,
                    force=config.force,
                    torque=config.torque,
                    pause_topic=gz_name(self, config.topic, "trajectory_follower/pause"),
                ),
            )
        )

    def _path(self) -> tuple[Point, ...] | Circle | Line:
        """Returns the path; empty if there is none.

        Raises:
            PluginError: A tag is missing, or a value is not a number.
        """
        find = self.tag.element.find
        if (stated := find("waypoints")) is not None:
            points = [vector(each, 2) for each in stated.find_all("waypoint")]
            if not points:
                raise missing("waypoints", "waypoint", stated.origin)
            return tuple((x, y) for x, y in points)
        if (stated := find("circle")) is not None:
            required(stated, "radius")
            return Circle(number_at(stated, "radius"))
        if (stated := find("line")) is not None:
            required(stated, "direction")
            required(stated, "length")
            return Line(number_at(stated, "direction"), number_at(stated, "length"))
        return ()
