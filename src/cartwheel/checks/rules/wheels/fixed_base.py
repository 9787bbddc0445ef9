"""Whether the base that wheels drive, or the model that a plugin moves, is free to move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from cartwheel.checks.controller_claims import base_controllers, wheels_of
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import drives_in
from cartwheel.codes import robot as robot_codes
from cartwheel.codes import running
from cartwheel.description.model import Joint
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.errors import Diagnostic, Origin

_WORLD = "world"


@dataclass(frozen=True, kw_only=True, slots=True)
class _Driver:
    """A plugin or controller that drives a base."""

    kind: str
    """A noun for it."""
    name: str
    wheels: tuple[str, ...]
    """Joints that turn the wheels."""
    origin: Origin
    values: Mapping[str, str] = field(default_factory=dict)
    """More values of the finding."""


@rule(robot_codes.BASE_FIXED)
def base_fixed(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in drives_in(subject):
        tag = drive.tag
        plugin = _Driver(kind="plugin", name=tag.filename, wheels=drive.joints, origin=tag.origin)
        yield from _held(subject, robot, plugin)
    for robot, each in base_controllers(subject):
        controller = _Driver(
            kind="controller",
            name=each.name,
            wheels=tuple(wheels_of(robot, each)),
            origin=each.type.origin,
            values={"type": each.kind},
        )
        yield from _held(subject, robot, controller)


@rule(running.MODEL_NOT_MOVABLE)
def model_not_movable(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        base = robot.description.canonical_link
        holder = robot.inbound.get(base) or _holder(robot, base)
        if holder is None and not robot.description.static:
            continue
        for tag, _ in robot.plugins():
            plugin = plugin_named(tag.filename)
            if plugin is None or not plugin.moves_model:
                continue
            values = {"plugin": tag.filename, "model": robot.description.name}
            why, hint = "it is static", "Remove <static>."
            if holder is not None:
                why = f'joint "{holder.name}" fixes it to the world'
                hint = "Remove the joint."
                values["joint"] = holder.name
            yield running.MODEL_NOT_MOVABLE.diagnostic(
                f'plugin "{tag.filename}" cannot move the model, because {why}',
                values=values,
                origin=tag.origin,
                hint=hint,
            )


def _held(subject: Subject, robot: Robot, driver: _Driver) -> Iterator[Diagnostic]:
    """The finding that a plugin or controller cannot drive a robot."""
    wheels = [robot.joints[each] for each in driver.wheels if each in robot.joints]
    values, origin = {driver.kind: driver.name, **driver.values}, driver.origin
    holder = next(filter(None, (_holder(robot, each.parent) for each in wheels)), None)
    if not wheels or (holder is None and not robot.description.static):
        return
    if holder is None:
        why, hint = "the model is static", "Remove <static>."
    else:
        why = f'joint "{holder.name}" fixes it to the world'
        link = "" if subject.in_sdf(holder.origin) else f' and the link "{_WORLD}"'
        hint = f"Remove the joint{link}."
        values, origin = {**values, "joint": holder.name}, holder.origin
    yield robot_codes.BASE_FIXED.diagnostic(
        message=f'{driver.kind} "{driver.name}" cannot drive the robot, because {why}',
        values=values,
        origin=origin,
        hint=hint,
    )


def _holder(robot: Robot, link: str) -> Joint | None:
    """The fixed joint between the world and the links that are rigidly connected to a link."""
    seen = set[str]()
    while link not in seen and link in robot.inbound and robot.inbound[link].type == "fixed":
        seen.add(link)
        joint = robot.inbound[link]
        if joint.parent == _WORLD:
            return joint
        link = joint.parent
    return None
