"""What a robot rests on, what gave way while it stood, and what the ground holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import numpy as np

from cartwheel.api import Model, World
from cartwheel.checks.resting import starting_positions
from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import (
    ROUND,
    lowest,
    wheel_axis,
    wheel_joints,
    wheel_links,
    wheel_widths,
)
from cartwheel.codes import devices
from cartwheel.codes import robot as robot_codes
from cartwheel.corpus.loads import held_by
from cartwheel.corpus.motion import angle_between, commanded_speeds
from cartwheel.corpus.movers import LEFT_OUT
from cartwheel.corpus.verdict import TILTED, Drive
from cartwheel.description.model import Joint
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.errors import Diagnostic, Origin
from cartwheel.geometry import Pose, rotate

_CARRIES = 0.1
"""Smallest part of the weight that is reported."""
_UNLOADED = 0.1
"""Part of the weight below which driven wheels hardly push a robot."""
_MOST = 0.5
"""Part of the weight that other parts then carry."""
_SLACK = 1e-3
"""Effort of a joint that nothing holds, relative to the weight at the robot's size."""
_SLIPPERY = 0.3
"""Largest friction coefficient of a part that is meant to slide."""
_SLID, _TURNED = 0.02, 0.2
"""Motion of a joint that gave way, m and rad."""
_GIVEN, _SLIPPED = 0.05, 0.005
"""Minimum motion of a controlled joint that lets a robot down, rad and m."""
_ALL = 0.95
"""Part of the effort limit that a motor uses which cannot hold its joint."""
_LEVEL = 0.9
"""Largest vertical component of the axis of a joint that lifts."""
_GRAVITY = 9.8
_UP = (0.0, 0.0, 1.0)
_FLAT = 0.005
"""Largest height of a part on which a robot stands, relative to the robot's size."""
_LOOKING, _INSTANTS = 0.1, 10
"""Time in which loads are averaged, s, and the number of times at which they are taken."""


def dragging(
    world: World, model: Model, robot: Robot, started: Sequence[Controller]
) -> Iterator[Diagnostic]:
    """Parts of arms without commands that rest on the ground beside the driven wheels.

    Args:
        world: The world, with the robot at rest or at the end of a drive.
        model: The robot in the world.
        robot: Its description.
        started: The controllers that run.
    """
    nodes = {node for info in world.graph.topics() if info.drives for node in info.subscribers}
    named = [
        name
        for each in started
        if each.node in nodes
        for name in each.interfaces
        if name in robot.joints
    ]
    joints = [*wheel_joints(robot), *(robot.joints[name] for name in named)]
    wheels = {name for joint in joints for name in wheel_links(robot, joint)}
    if not wheels:
        return
    # What is dragged jumps, so that the load at one instant may be none.
    loads: dict[str, float] = {}
    for _ in range(_INSTANTS):
        world.run(_LOOKING / _INSTANTS)
        for contact in world.contacts(model.name):
            if contact.models[1] != model.name:
                load = abs(float(np.dot(contact.force, contact.normal))) / _INSTANTS
                loads[contact.links[0]] = loads.get(contact.links[0], 0.0) + load
    weight = _GRAVITY * robot.description.mass
    yield from _unloaded(robot, wheels, loads, weight)
    for name, load in loads.items():
        holder = _holder(robot, name)
        if name in wheels or holder is None or load < _CARRIES * weight:
            continue
        if held_by(world, model, holder.name) > _SLACK * weight * robot.size:
            continue
        mu = [each.surface.mu1 for each in robot.links[name].collisions]
        if all(each is not None and each <= _SLIPPERY for each in mu):
            continue
        if _rolls(world, model, robot, name, _SLACK * weight * robot.size):
            continue
        yield robot_codes.BODY_ON_GROUND.diagnostic(
            message=f'link "{name}" rests on the ground and carries {load / weight:.0%} of the '
            f'weight, because nothing holds joint "{holder.name}" up, so it brakes the robot',
            severity="info",
            values={"link": name, "joint": holder.name, "part": load / weight},
            origin=holder.origin,
            hint="Command the joint before the robot drives, or add a controller that holds it.",
        )


def _unloaded(
    robot: Robot, wheels: Set[str], loads: Mapping[str, float], weight: float
) -> Iterator[Diagnostic]:
    """Driven wheels that carry almost nothing, because other parts carry the robot.

    Args:
        robot: The robot.
        wheels: The links of its driven wheels.
        loads: The forces with which links press on the ground, N.
        weight: That of the robot, N.
    """
    carried = sum(load for name, load in loads.items() if name in wheels)
    others = {name: load for name, load in loads.items() if name not in wheels}
    if not others or carried >= _UNLOADED * weight or sum(others.values()) < _MOST * weight:
        return
    name = max(others, key=others.__getitem__)
    yield robot_codes.BODY_ON_GROUND.diagnostic(
        message=f"the driven wheels carry {carried / weight:.0%} of the weight, because "
        f'"{name}" carries {others[name] / weight:.0%} of it, so the wheels hardly push the robot',
        severity="info",
        values={"link": name, "joint": "", "part": others[name] / weight, "unloaded": True},
        origin=robot.links[name].origin if name in robot.links else robot.description.origin,
        hint="Place the centre of mass nearer to the driven wheels, or lift this part.",
    )


def drives_apart(robot: Robot, drives: Sequence[Drive]) -> Iterator[Diagnostic]:
    """Drives of different wheels that were commanded one after the other."""
    topics = sorted({drive.topic for drive in drives})
    wheels = {frozenset((*left, *right)) for left, right in robot.sides}
    if len(topics) < 2 or len(wheels) < 2 or len(frozenset.union(*wheels)) < sum(map(len, wheels)):
        return
    names = " and ".join(f'"{topic}"' for topic in topics)
    yield robot_codes.DRIVES_APART.diagnostic(
        f"the drives that receive {names} turn different wheels, so a drive without a command "
        "brakes the robot",
        values={"topics": tuple(topics)},
        origin=robot.description.origin,
        hint="Command all drives at the same time, for example on the same topic.",
    )


def toppled(
    model: Model, robot: Robot, commanded: Iterable[str], upright: Pose | None
) -> Iterator[Diagnostic]:
    """The robot, if it stands on its base, but fell when the joints on the base moved.

    Args:
        model: The robot in the world, after the motion.
        robot: Its description.
        commanded: The joints that were moved.
        upright: The pose of its root link at rest; None if it did not stand.
    """
    heights = {name: low for name in robot.links if (low := lowest(robot, name)) is not None}
    ground = min(heights.values(), default=0.0) + _FLAT * robot.size
    standing = [name for name, height in heights.items() if height <= ground]
    moved = set(commanded)
    if upright is None or not moved or not standing or moved & robot.carrying(standing):
        # Those are legs.
        return
    if any(_is_lost(each) for each in robot.description.diagnostics):
        return
    tilt = angle_between(*(rotate(pose.orientation, _UP) for pose in (upright, model.pose)))
    if tilt <= TILTED:
        return
    wheels = {name for joint in wheel_joints(robot) for name in wheel_links(robot, joint)}
    root = robot.rigid_root(standing[0])
    hint = "Make the base heavier or its track wider, or the arm lighter."
    why = ""
    if not wheels:
        why = ", because nothing fixes it to the world"
        hint = (
            f'If it is mounted on something, add <link name="world"/> and a fixed joint from '
            f'"world" to "{root}".'
        )
    yield robot_codes.UNBALANCED.diagnostic(
        message=f"the robot tilts by {math.degrees(tilt):.2g}° when its joints move{why}",
        severity="warning",
        values={"tilt": tilt, "joints": tuple(sorted(moved))},
        origin=robot.description.origin,
        hint=hint,
    )


def _is_lost(each: Diagnostic) -> bool:
    """Whether it is about a missing shape or part, on which the robot may stand in Gazebo."""
    return each.code in LEFT_OUT or each.values.get("left_out") == "collision"


def gave_way(
    world: World,
    model: Model,
    robot: Robot,
    before: Mapping[str, float],
    started: Sequence[Controller],
    *,
    moving: bool = False,
) -> Iterator[Diagnostic]:
    """Joints without motors, or with motors that wait for commands, that moved while it stood.

    Args:
        world: The world, after the robot stood.
        model: The robot in the world.
        robot: Its description.
        before: Positions of the joints at the start, rad or m.
        started: The controllers that run.
        moving: Whether the robot did not stand still. If it has no motors, its wheels may roll.
    """
    waiting = {name: each.name for each in started if not each.holds for name in each.interfaces}
    moved = driven(world, model) - waiting.keys()
    rolls = moving and not moved and not waiting
    found = {
        joint.name: abs(model.joint(joint.name) - _within(joint, before[joint.name]))
        for joint in robot.description.joints
        if joint.name in before
        and (joint.type in ("revolute", "prismatic") or (rolls and joint.turns))
        and joint.name not in moved
        and joint.mimic is None
        and joint.axis.spring_stiffness == 0
    }
    found = {
        name: way
        for name, way in found.items()
        if way > (_SLID if robot.joints[name].type == "prismatic" else _TURNED)
    }
    if found:
        carrying = _carrying(world, model, robot)

        def weight(name: str) -> tuple[bool, bool, float]:
            """How likely it is that this joint lets the robot down."""
            joint = robot.joints[name]
            unit = _SLID if joint.type == "prismatic" else _TURNED
            return name in carrying, rolls or not joint.turns, found[name] / unit

        found = {name: found[name] for name in sorted(found, key=weight, reverse=True)}
        most = next(iter(found))
        # Others that moved, such as an antenna, do not let the robot down.
        shown = [name for name in found if weight(name)[:2] == weight(most)[:2]]
        names = ", ".join(f'"{name}"' for name in shown[:4])
        more = f" and {len(shown) - 4} more" if len(shown) > 4 else ""
        wait = most in waiting
        why = (
            f"until its first command, the controller of each of the joints {names}{more} does not "
            "hold it"
            if wait
            else f"no controller or plugin drives the joints {names}{more}"
        )
        yield robot_codes.JOINTS_UNDRIVEN.diagnostic(
            f"{why}, so the robot rolls"
            if rolls and robot.joints[most].turns
            else f'{why}, so they give way: "{most}" moved by {found[most]:.2g} '
            f"{'m' if robot.joints[most].type == 'prismatic' else 'rad'}",
            values={
                "joints": tuple(found),
                **({} if rolls and robot.joints[most].turns else {"moved": found[most]}),
            },
            origin=robot.joints[most].origin,
            hint=f'Command "{waiting[most]}" and the others at the start.' if wait else "",
        )


def sagging(
    model: Model,
    robot: Robot,
    started: Sequence[Controller],
    gains: Mapping[str, float],
) -> Iterator[Diagnostic]:
    """The joint that the weight has moved furthest from where its controller should hold it.

    Args:
        model: The robot in the world, after it should have stood.
        robot: Its description.
        started: The controllers that run.
        gains: The gains that `weak_gains` returns.
    """
    held = {name: each for each in started if each.holds for name in each.interfaces}
    speeds = commanded_speeds(started)
    starts = starting_positions(robot)
    moved = {
        name: way
        for name in held
        if (joint := robot.joints.get(name)) is not None
        and name not in speeds
        and joint.mimic is None
        and (way := abs(model.joint(name) - starts.get(name, 0.0)))
        > (_SLIPPED if joint.type == "prismatic" else _GIVEN)
    }
    for name in sorted(moved, key=lambda each: -moved[each]):
        joint = robot.joints[name]
        unit, effort = ("m", "N") if joint.type == "prismatic" else ("rad", "N m")
        limit = joint.axis.effort
        if limit and abs(model.joints.efforts[name]) >= _ALL * limit:
            yield devices.EFFORT_LIMIT_TOO_LOW.diagnostic(
                f'the effort limit of joint "{name}", {limit:g} {effort}, does not hold the weight '
                f"on it: it moved by {moved[name]:.2g} {unit}",
                values={"joint": name, "stated": limit, "sagged": moved[name]},
                origin=joint.origin,
                hint="Use the effort limit of the motor.",
            )
            return
        if name in gains:
            source = held[name].settings.source
            yield devices.CONTROLLER_GAIN_TOO_LOW.diagnostic(
                f"with the proportional gain of {gains[name]:g} {effort}/{unit}, joint "
                f'"{name}" gives way to the weight on it: it moved by {moved[name]:.2g} {unit}',
                values={"joint": name, "gain": gains[name], "sagged": moved[name]},
                origin=Origin(file=source) if source else joint.origin,
                hint="Use a higher proportional gain, or an integral gain.",
            )
            return


def _carrying(world: World, model: Model, robot: Robot) -> set[str]:
    """The joints between the root link and the links on the ground, wheels among them."""
    return robot.carrying(
        contact.links[0]
        for contact in world.contacts(model.name)
        if contact.models[1] != model.name
    )


def blocked(world: World, model: Model, robot: Robot) -> set[str]:
    """The joints that hold a link other than a wheel that touches the ground or another model."""

    def is_wheel(link: str) -> bool:
        joint = robot.inbound.get(robot.rigid_root(link))
        return joint is not None and joint.turns

    return robot.carrying(
        contact.links[0]
        for contact in world.contacts(model.name)
        if contact.models[1] != model.name and not is_wheel(contact.links[0])
    )


def _within(joint: Joint, position: float) -> float:
    """The nearest position within the joint's limits, to which it is moved at first."""
    lower, upper = joint.axis.lower, joint.axis.upper
    position = position if lower is None else max(position, lower)
    return position if upper is None else min(position, upper)


def driven(world: World, model: Model) -> set[str]:
    """The joints that plugins drive."""
    return {
        name
        for entry in world.session.simulation.engine.entries
        if entry.name == model.name
        for name in (*entry.motors, *entry.mimics)
    }


def _holder(robot: Robot, link: str) -> Joint | None:
    """The joint without a spring that lifts a link; None if it is fixed to the body."""
    joint = robot.inbound.get(robot.rigid_root(link))
    while joint is not None and joint.turns:
        joint = robot.inbound.get(robot.rigid_root(joint.parent))
    if joint is None or joint.axis.spring_stiffness or joint.child not in robot.placed:
        return None
    level = joint.type == "revolute" and abs(wheel_axis(robot, joint)[2]) < _LEVEL
    return joint if level or joint.type == "prismatic" else None


def _rolls(world: World, model: Model, robot: Robot, link: str, slack: float) -> bool:
    """Whether a link is a round wheel that nothing drives.

    A joint for controllers has a servo, which has no effort if no controller commands it. `slack`
    is the largest effort that counts as none, N m.
    """
    joint = robot.inbound.get(robot.rigid_root(link))
    entries = world.session.simulation.engine.entries
    motors = {name: motor for entry in entries for name, motor in entry.motors.items()}
    if joint is None or not joint.turns:
        return False
    motor = motors.get(joint.name)
    if motor is not None and (motor.mode != "servo" or held_by(world, model, joint.name) > slack):
        return False
    return _is_wheel(robot, joint)


def _is_wheel(robot: Robot, joint: Joint) -> bool:
    """Whether a joint that turns carries something round, or nothing that touches."""
    if not joint.turns:
        return False
    widths = wheel_widths(robot, joint, robot.collisions)
    return widths is None or bool(widths.min() >= ROUND * widths.max())
