"""Stated radii and diameters of wheels, compared with their geometry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.stated_sizes import LEAST, Stated, differs, stated_sizes
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    is_across,
    lowest,
    wheel_axis,
    wheel_links,
    wheel_place,
    wheel_radius,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.errors import Code, Diagnostic

_LIFTED = 0.2
"""Part of its radius by which a wheel is above one behind it, from which it carries nothing."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Sizes:
    """The radii or diameters of the wheels for which one is stated."""

    wheels: Mapping[str, float]
    """By the name of the wheel's joint, m."""
    stated: float
    """The stated one, m."""

    @property
    def mean(self) -> float:
        """The one with which the robot drives, m."""
        return sum(self.wheels.values()) / len(self.wheels)

    @property
    def wrong(self) -> list[str]:
        """Joints of the wheels with another size, beginning with the most different one."""
        wrong = {name: size for name, size in self.wheels.items() if _differs(self.stated, size)}
        return sorted(wrong, key=lambda name: -abs(wrong[name] - self.stated))


@rule(robot_codes.WHEEL_DIAMETER_MISMATCH)
def wheel_diameter(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated_sizes(subject):
        sizes = _sizes(one)
        if sizes is None or not sizes.wrong:
            continue
        joint = one.robot.joints[sizes.wrong[0]]
        real = sizes.wheels[joint.name]
        said = f'the {one.measure} of the wheel "{joint.child}" is {real:.4g} m'
        others = [name for name in sizes.wheels if _differs(real, sizes.wheels[name])]
        if others:
            other = one.robot.joints[others[0]]
            said += f' and that of the wheel "{other.child}" {sizes.wheels[other.name]:.4g} m'
        effect = f"the robot {_speed(sizes.mean, one.used)}"
        if not _differs(one.used, sizes.mean):
            effect = "the robot does not drive straight"
        found = size_mismatch(
            robot_codes.WHEEL_DIAMETER_MISMATCH, one, sizes.mean, f"{said}, so {effect}"
        )
        # No single size is right for different wheels.
        found = replace(found, instead="") if others else found
        yield replace(found, values={**found.values, "joint": joint.name})


def size_mismatch(code: Code, one: Stated, real: float, why: str) -> Diagnostic:
    """The diagnostic for a stated size that differs from the real one.

    Args:
        code: Its code.
        one: The stated size.
        real: The size as measured in the description, m.
        why: The real size and the consequence, as they follow "but" in the message.
    """
    stated = f"{one.label} is {one.value:g} m"
    if one.measured:
        stated = f"{one.label} is missing, so that of the description is used, {one.value:.4g} m"
    if one.factor != 1.0:
        stated += f", times its multiplier {one.factor:g}"
    if not one.written:
        stated = f"{one.label} is missing and defaults to {one.value:g} m"
    return code.diagnostic(
        message=f"{stated}, but {why}",
        values={
            "tag": one.label,
            "joint": one.first[0],
            "stated": one.used,
            "measured": real,
            **one.owner,
        },
        origin=one.origin,
        instead=one.write(nodes.short(round(real / one.factor, 4))) if one.factor else "",
        place=one.place,
        mark=one.mark,
    )


def wrong_size(one: Stated) -> float | None:
    """The real radius or diameter of the wheels of a stated size, m; of different ones, the mean.

    None if the stated one is right, or if it is another measure.
    """
    sizes = _sizes(one)
    return sizes.mean if sizes is not None and _differs(one.used, sizes.mean) else None


def _sizes(one: Stated) -> _Sizes | None:
    """The real sizes of the wheels of a stated size; None if it is another measure."""
    if one.measure not in ("radius", "diameter"):
        return None
    robot = one.robot
    radii = {
        name: radius
        for name in one.first
        if (wheel := robot.joints[name]).child in robot.links and _is_whole(robot, wheel)
        if (radius := wheel_radius(robot, wheel)) is not None and is_across(robot, wheel)
    }
    times = 1 if one.measure == "radius" else 2
    sizes = {
        name: times * radius
        for name, radius in radii.items()
        if not any(_is_lifted(robot, name, other, radius) for other in radii)
    }
    return _Sizes(wheels=sizes, stated=one.used) if sizes else None


def _is_whole(robot: Robot, wheel: Joint) -> bool:
    """Whether no mesh is missing among the shapes that give the size of a wheel.

    A wheel rolls on its collisions, whatever it looks like.
    """
    rolls = any(robot.collisions[name] for name in wheel_links(robot, wheel))
    return robot.whole(wheel.child, looks=not rolls)


def _is_lifted(robot: Robot, name: str, other: str, radius: float) -> bool:
    """Whether a wheel is clearly above another one that is ahead of it or behind it."""
    wheel, below = robot.joints[name], robot.joints[other]
    heights = [lowest(robot, *wheel_links(robot, each)) for each in (wheel, below)]
    if name == other or heights[0] is None or heights[1] is None:
        return False
    gap = np.array(wheel_place(robot, wheel).position) - wheel_place(robot, below).position
    beside = abs(float(gap @ wheel_axis(robot, wheel))) > float(np.linalg.norm(gap)) / 2
    return heights[0] - heights[1] > _LIFTED * radius and not beside


def _speed(real: float, used: float) -> str:
    """What follows from a size for the speed of a robot."""
    far = abs(real / used - 1) if used else 1.0
    return f"drives {far:.0%} {'slower' if used > real else 'faster'} than commanded"


def _differs(stated: float, real: float) -> bool:
    return differs(stated, real, LEAST / 2)
