"""How fast vehicles on tracks turn, whose tracks slide on the ground."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import PluginTag
from cartwheel.description.solids import Floats
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.classic.drives.tracked_vehicle import (
    SimpleTrackedVehicle,
    SimpleTracksParameters,
)
from cartwheel.dialects.gz.vehicles.tracked_vehicle import (
    TrackedVehicleParameters,
    TrackedVehicleSystem,
)
from cartwheel.dialects.tags import read
from cartwheel.errors import Diagnostic, PluginError

_TOUCHING = 0.002
"""Maximum height of a point that touches the ground above the lowest one, m."""
_DIRECTIONS = 32
_LEAST = 0.05
"""Minimum relative difference between the commanded and the expected turn rate."""
_SIDES = ("left_track", "right_track")


class _Vehicle(NamedTuple):
    config: TrackedVehicleParameters | SimpleTracksParameters
    body: str
    links: list[str]
    """The links of all tracks."""
    projected: bool
    """See `TrackConfig.projected`."""


def sliding_tracks(subject: Subject) -> Iterator[Diagnostic]:
    """A steering efficiency that does not fit the tracks of a vehicle."""
    for robot in subject.robots:
        for tag in robot.description.plugins:
            if not robot.is_placed or (vehicle := _vehicle(robot, tag)) is None:
                continue
            if not {vehicle.body, *vehicle.links} <= robot.links.keys():
                continue
            config = vehicle.config
            reach = _reach(robot, vehicle)
            ideal = config.separation / 2
            if reach is None or min(ideal, config.efficiency) <= 0:
                continue
            ratio = ideal / config.efficiency / reach
            if abs(ratio - 1.0) <= _LEAST:
                continue
            stated = tag.element.find("steering_efficiency")
            place = stated if stated is not None else tag.element
            yield robot_codes.SKID_STEERING.diagnostic(
                message="the tracks slide when the robot turns, so it turns at "
                f"{ratio:.0%} of the commanded rate",
                values={"tag": "<steering_efficiency>", "ratio": ratio, "reach": reach},
                origin=place.origin,
                hint="A <steering_efficiency> of "
                f"{nodes.short(round(config.efficiency * ratio, 3))} compensates for this.",
                mark=stated.text.strip() if stated is not None else "",
            )


def _vehicle(robot: Robot, tag: PluginTag) -> _Vehicle | None:
    """The tracks of a plugin; None if it has none."""
    plugin = plugin_named(tag.filename)
    try:
        if plugin is TrackedVehicleSystem:
            system, _ = read(TrackedVehicleParameters, tag.element)
            body = system.body.strip() or robot.description.canonical_link
            links = [
                link.text.strip()
                for side in _SIDES
                for track in tag.element.find_all(side)
                if (link := track.find("link")) is not None
            ]
            return _Vehicle(system, body, links, projected=False)
        if plugin is SimpleTrackedVehicle:
            simple, _ = read(SimpleTracksParameters, tag.element)
            names = (simple.left, simple.right, *simple.left_flippers, *simple.right_flippers)
            links = [name.strip() for name in names]
            return _Vehicle(simple, simple.body.strip(), links, projected=True)
    except PluginError:
        pass
    return None


def _reach(robot: Robot, vehicle: _Vehicle) -> float | None:
    """Distance from the centre of a turn in place at which the ground has the tracks' speed, m.

    Each point of a track drives the vehicle on a circle about the origin of the body, all with the
    same speed, or with its component along the circle. With the reaction of the ground in
    proportion to the difference, their torques balance at the sum of the squared distances over the
    sum of the distances, or of their components across the vehicle. None without tracks.
    """
    x, y, _ = robot.links[vehicle.body].pose.position
    arms: list[Floats] = []
    for link in vehicle.links:
        clouds = [solid.placed(robot.links[link].pose) for solid in robot.collisions[link]]
        if not clouds:
            return None
        points = np.concatenate(clouds)
        low = points[points[:, 2] <= points[:, 2].min() + _TOUCHING][:, :2]
        angles = (np.arange(_DIRECTIONS) + 0.5) * 2 * math.pi / _DIRECTIONS
        corners = low[np.unique((low @ np.stack([np.cos(angles), np.sin(angles)])).argmax(axis=0))]
        arms.append(corners - (x, y))
    if not arms:
        return None
    every = np.concatenate(arms)
    squares = (every**2).sum(axis=1)
    parts = np.abs(every[:, 1]) if vehicle.projected else np.sqrt(squares)
    return float(squares.sum() / parts.sum()) if parts.sum() > 0 else None
