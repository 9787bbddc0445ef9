"""How fast vehicles on tracks turn, whose tracks slide on the ground."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Element
from cartwheel.description.solids import Floats
from cartwheel.dialects.catalogue import plugin_named
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


def sliding_tracks(subject: Subject) -> Iterator[Diagnostic]:
    """A steering efficiency that does not fit the tracks of a vehicle."""
    for robot in subject.robots:
        for tag in robot.description.plugins:
            if plugin_named(tag.filename) is not TrackedVehicleSystem or not robot.is_placed:
                continue
            try:
                config, _ = read(TrackedVehicleParameters, tag.element)
            except PluginError:
                continue
            body = config.body.strip() or robot.description.canonical_link
            links = [*_links(tag.element)]
            if body not in robot.links or not all(map(robot.links.__contains__, links)):
                continue
            reach = _reach(robot, links, body)
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


def _links(plugin: Element) -> Iterator[str]:
    for side in _SIDES:
        for track in plugin.find_all(side):
            link = track.find("link")
            if link is not None:
                yield link.text.strip()


def _reach(robot: Robot, links: list[str], body: str) -> float | None:
    """Distance from the centre of a turn in place at which the ground has the tracks' speed, m.

    Each point of a track drives the vehicle on a circle about the origin of the body, all with the
    same speed. With the reaction of the ground in proportion to the difference, their torques
    balance at the sum of the squared distances over the sum of the distances. None without tracks.
    """
    x, y, _ = robot.links[body].pose.position
    distances: list[Floats] = []
    for link in links:
        clouds = [solid.placed(robot.links[link].pose) for solid in robot.collisions[link]]
        if not clouds:
            return None
        points = np.concatenate(clouds)
        low = points[points[:, 2] <= points[:, 2].min() + _TOUCHING][:, :2]
        angles = (np.arange(_DIRECTIONS) + 0.5) * 2 * math.pi / _DIRECTIONS
        corners = low[np.unique((low @ np.stack([np.cos(angles), np.sin(angles)])).argmax(axis=0))]
        distances.append(np.hypot(*(corners - (x, y)).T))
    if not distances:
        return None
    every = np.concatenate(distances)
    return float((every**2).sum() / every.sum()) if every.sum() > 0 else None
