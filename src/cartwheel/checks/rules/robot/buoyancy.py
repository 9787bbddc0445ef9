"""Vehicles in water that are too heavy to float."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.dialects.sinking import sinking_load
from cartwheel.errors import Diagnostic


@rule(robot_codes.SINKS_IN_WATER)
def sinks_in_water(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        load = sinking_load(robot.description)
        if load is None:
            continue
        count = len(load.unstated)
        unstated = ""
        if count:
            unstated = f". {count} of its links have no <inertial>, and so a mass of 1 kg each"
            if count == 1:
                unstated = f'. Its link "{load.unstated[0]}" has no <inertial>, and so 1 kg'
        yield robot_codes.SINKS_IN_WATER.diagnostic(
            f"the model weighs {load.mass:.4g} kg, but its collisions displace "
            f"{load.displaced:.4g} kg of water, so it sinks{unstated}",
            values={"mass": load.mass, "displaced": load.displaced, "links": load.unstated},
            origin=robot.description.origin,
            hint="State the <inertial> of all links, so that the model weighs about as much as the "
            "water that it displaces.",
        )
