"""Limits on a base's velocity in the robot's own files: controllers, plugin tags and joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import gz_wheels, wheel_place, wheel_radius
from cartwheel.description.model import Element, RobotDescription
from cartwheel.devices.joints.limits import velocity_limit
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController

_BELOW = 0.9
"""Part of the wheels' maximum speed that is commanded."""
_TURNS = ("angular", "yaw", "rotation", "turn")


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedLimits:
    """The lowest limits."""

    forward: float = math.inf
    """m/s."""
    turn: float = math.inf
    """rad/s."""
    acceleration: float = math.inf
    """m/s²."""
    turn_acceleration: float = math.inf
    """rad/s²."""


def stated_limits(robot: RobotDescription, controllers: list[Controller]) -> StatedLimits:
    """The limits that the started controllers and the plugins of a robot state.

    A limit is a positive number whose name contains ``max`` and ``vel``, ``speed`` or ``acc``, such
    as ``linear/x/max_velocity``. Names with ``angular`` limit the turn rate. Other names with
    ``linear`` or without a direction limit the forward velocity; the latter also limit the turn
    rate, as in gz-sim's DiffDrive.
    """
    found: dict[str, float] = {}
    for controller in controllers:
        if controller.claims:
            _take(found, _flat(controller.settings.flat()))
    for tag in robot.plugins:
        _take(found, _texts(tag.element, ""))
    return StatedLimits(**found)


def within_speeds(
    limits: StatedLimits, robot: Robot, controllers: Sequence[Controller]
) -> StatedLimits:
    """Limits at which no driven wheel turns faster than the velocity limit of its joint.

    A limit of 0 is ignored: with it, the wheel does not turn at any command.
    """
    speeds = {
        name: joint.fastest
        for each in controllers
        if isinstance(each, WheelController)
        for name, joint in each.claims.items()
    }
    speeds |= {name: velocity_limit(robot.joints.get(name)) for name in gz_wheels(robot)}
    rims = {
        name: speed * radius
        for name, speed in speeds.items()
        if name in robot.joints
        and robot.joints[name].turns
        and 0 < speed < math.inf
        and (radius := wheel_radius(robot, robot.joints[name])) is not None
    }
    if not rims:
        return limits
    slowest = _BELOW * min(rims.values())
    places = [wheel_place(robot, robot.joints[name]).position for name in rims]
    reach = max(math.dist(a[:2], b[:2]) for a in places for b in places) / 2
    turn = slowest / reach if reach > 0 else limits.turn
    return replace(limits, forward=min(limits.forward, slowest), turn=min(limits.turn, turn))


def _take(found: dict[str, float], values: Iterator[tuple[str, Any]]) -> None:
    stated = dict(values)
    for path, value in stated.items():
        name = path.lower()
        number = _number(value)
        if number is None or number <= 0 or "max" not in name or _is_off(stated, name):
            continue
        if "acc" in name:
            kinds = ("acceleration", "turn_acceleration")
        elif "vel" in name or "speed" in name:
            kinds = ("forward", "turn")
        else:
            continue
        if any(word in name for word in ("joint", "wheel", "motor", "rotor", "rot_vel", "steer")):
            continue
        turns = any(word in name for word in _TURNS)
        for kind in kinds[1:] if turns else kinds[:1] if "linear" in name else kinds:
            found[kind] = min(found.get(kind, math.inf), number)


def _is_off(stated: Mapping[str, Any], name: str) -> bool:
    """Whether ROS 1's ``has_…_limits`` switches a limit off."""
    path, _, last = name.rpartition("/")
    kind = last.removeprefix("max_")
    switch = stated.get(f"{path}/has_{kind}_limits" if path else f"has_{kind}_limits")
    return switch is not None and str(switch).lower() in ("false", "0")


def _number(value: Any) -> float | None:
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None


def _flat(values: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield from _flat(value, f"{path}/{str(key).replace('.', '/')}".lstrip("/"))
    else:
        yield path, values


def _texts(element: Element, path: str) -> Iterator[tuple[str, Any]]:
    for child in element.children:
        name = f"{path}/{child.tag}".lstrip("/")
        yield name, child.text.strip()
        yield from _texts(child, name)
