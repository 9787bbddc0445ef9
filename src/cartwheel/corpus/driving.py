"""Drives a base on its topics: forward, sideways and turning."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence, Set
from itertools import pairwise
from typing import NamedTuple

from cartwheel.api import Model, World
from cartwheel.checks.robot import Robot
from cartwheel.corpus.flying.hovering import climbs, drag_errors
from cartwheel.corpus.heading import BACKWARD, FORWARD, heading
from cartwheel.corpus.limits import StatedLimits
from cartwheel.corpus.motion import positions
from cartwheel.corpus.verdict import TOLERANCE, Drive
from cartwheel.devices.drives.drive import Drive as DriveDevice
from cartwheel.devices.drives.drive import Drives
from cartwheel.devices.drives.timeouts import CommandTimeouts
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.classic.drives.planar_move import PlanarMove
from cartwheel.dialects.gz.velocity_control import VelocityControl
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.geometry import Pose, Vec3, rotate
from cartwheel.graph import TWIST_STAMPED, TopicInfo
from cartwheel.messages import from_dict
from cartwheel.simulation.clock import NANOSECONDS

VELOCITY, TURN = 0.2, 0.4
"""m/s and rad/s commanded to a base: slow enough for the smallest robots."""
_SPEED_UP = 4.0
"""Time for a base to reach the commanded speed, s, unless its acceleration is limited."""
_LONGEST = 20.0
_RADIUS = 4.0
"""Radius of the arc of a steered base, relative to the longest edge of its bounding box: the
steering angle is at most atan(1/4) = 14°."""
_SMALLEST = 0.1
"""m; for bases without geometry."""
_TAKING_OFF = 2.0
"""Time after the message that starts a flight, s."""
_CLIMB, _CLIMBING = 0.8, 4.0
"""Speed in m/s and time in s for which an aircraft with velocity control climbs: it may sink while
it turns, because a propeller's thrust depends on the square of its speed."""
_MEASURED = 2.0
_SETTLED = 0.01
"""Increase from one measurement to the next, or from the first half of one to the second, relative
to the command, below which a base no longer accelerates."""
_SLID = 0.01
"""Speed that a base of planar_move loses, also in Gazebo, if it slides with a friction coefficient
of 1, m/s."""
_PERIOD = 0.05
"""Time between two commands, s, unless they expire earlier."""
_WITHOUT_WHEELS = (PlanarMove, VelocityControl)
"""Plugins that move a whole model, also sideways."""


Facing = tuple[float, float]
"""A direction in the robot's frame, a unit vector."""


class Motion(NamedTuple):
    """A velocity in the plane."""

    ahead: float
    """m/s."""
    left: float
    """m/s."""
    turn: float
    """rad/s, to the left."""


class _Measurement(NamedTuple):
    """How a base moved while a command was published."""

    motion: Motion
    """The mean velocity."""
    halves: tuple[Motion, Motion]
    """Those of the first and of the second half."""
    ahead: Facing
    """The direction that counts as forward."""


def drives(
    world: World,
    model: Model,
    robot: Robot,
    limits: StatedLimits,
    started: Sequence[Controller],
    *,
    idle: Set[str],
    steered: bool,
    look: Callable[[], None],
) -> Iterator[Drive]:
    """Drives on each topic with velocity commands, forward, sideways and turning, after a reset.

    Args:
        world: The world.
        model: The robot in the world.
        robot: Its description.
        limits: The robot's own limits. The commands stay below them.
        started: The controllers that run.
        idle: Nodes of controllers that do not run, whose topics are not tested.
        steered: The base cannot turn in place, so it turns while it drives forward.
        look: Called at the end of each motion of a topic, before the next reset.
    """
    forward = min(VELOCITY, limits.forward)
    turn = min(TURN, limits.turn)
    if steered:
        turn = min(turn, forward / (_RADIUS * max(robot.size, _SMALLEST)))
    speed_up = max(
        _SPEED_UP,
        min(_LONGEST, 2.0 * max(forward / limits.acceleration, turn / limits.turn_acceleration)),
    )
    sag, sag_turn = drag_errors(robot.description)
    if any(plugin_named(tag.filename) is PlanarMove for tag in robot.description.plugins):
        sag = max(sag, _SLID / forward)
    for info in world.graph.topics():
        if not info.drives or (info.subscribers and idle >= set(info.subscribers)):
            continue
        both = Motion(forward if steered else 0.0, 0.0, turn)
        front = _front(info, started)
        (ahead, facing), (turned, _) = (
            _driven(world, model, robot, info, (command, speed_up), look=look, facing=front)
            for command in (Motion(forward, 0.0, 0.0), both)
        )
        drive = _drive_of(world, info, started)
        left = 0.0
        if sideways := _takes_sideways(model, robot, info, drive):
            command = Motion(0.0, forward, 0.0)
            motion, _ = _driven(
                world, model, robot, info, (command, speed_up), look=look, facing=facing
            )
            left = motion.left
        yield Drive(
            topic=info.name,
            commanded=drive.commanded(forward, 0.0)[0] if drive is not None else forward,
            measured=ahead.ahead,
            commanded_turn=drive.commanded(both.ahead, turn)[1] if drive is not None else turn,
            measured_turn=turned.turn,
            commanded_sideways=forward if sideways else 0.0,
            measured_sideways=left,
            turning="arc" if steered else "in place",
            limited=forward < VELOCITY or (turn < TURN and not steered),
            sag=sag,
            sag_turn=sag_turn,
        )
    world.reset()


def _drive_of(
    world: World, topic: TopicInfo, started: Sequence[Controller]
) -> DriveDevice | WheelController | None:
    """The drive that receives the commands on a topic."""
    return world.session.shared.get(Drives).of(topic.subscribers) or next(
        (
            each
            for each in started
            if isinstance(each, WheelController) and each.node in topic.subscribers
        ),
        None,
    )


def _front(topic: TopicInfo, started: Sequence[Controller]) -> Facing | None:
    """The forward direction of a robot whose controller shows that it faces along negative x."""
    backward = any(each.faces_backward and each.node in topic.subscribers for each in started)
    return BACKWARD if backward else None


def _takes_sideways(
    model: Model, robot: Robot, topic: TopicInfo, drive: DriveDevice | WheelController | None
) -> bool:
    """Whether ``linear.y`` of the commands on a topic is followed."""
    return drive.sideways if drive is not None else _is_pushed(model, robot, topic)


def _is_pushed(model: Model, robot: Robot, topic: TopicInfo) -> bool:
    """Whether a plugin moves the whole model as commanded on a topic."""
    nodes = {
        f"{model.name}/{tag.name}"
        for tag in robot.description.plugins
        if plugin_named(tag.filename) in _WITHOUT_WHEELS
    }
    return not nodes.isdisjoint(topic.subscribers)


def _driven(
    world: World,
    model: Model,
    robot: Robot,
    topic: TopicInfo,
    command: tuple[Motion, float],
    *,
    look: Callable[[], None],
    facing: Facing | None = None,
) -> tuple[Motion, Facing]:
    """The velocity after a constant command, and the direction that counts as forward.

    `command` contains the commanded velocity and the time to reach it in s. `facing` is the forward
    direction, if it is known: wheels that roll sideways do not show it.
    """
    world.reset()
    world.run(0.5)
    flying = _take_off(world, topic)
    if climbs(robot.description):
        flying = True
        _drive_on(world, topic, Motion(0.0, 0.0, 0.0), _CLIMBING, climb=_CLIMB)
    wanted, speed_up = command
    _drive_on(world, topic, wanted, speed_up)
    found = _measured(world, model, robot, topic, wanted, facing=facing, flying=flying)
    waited = speed_up + _MEASURED
    # Wheels that slide because of a small load need long to accelerate the base, as do heavy ones,
    # and a base that becomes too fast has the commanded velocity on the way.
    while waited < _LONGEST and not (
        all(
            abs(now - speed) <= TOLERANCE * abs(speed)
            for now, speed in zip(found.motion, wanted, strict=True)
            if speed
        )
        and _increase(*found.halves, wanted) < _SETTLED
    ):
        before = found
        found = _measured(world, model, robot, topic, wanted, facing=facing, flying=flying)
        waited += _MEASURED
        if _increase(before.motion, found.motion, wanted) < _SETTLED:
            break
    look()
    return found.motion, found.ahead


def _increase(before: Motion, after: Motion, wanted: Motion) -> float:
    """The largest increase of a commanded part of a velocity, relative to the command."""
    parts = zip(before, after, wanted, strict=True)
    return max((now - then) / speed for then, now, speed in parts if speed)


def _measured(
    world: World,
    model: Model,
    robot: Robot,
    topic: TopicInfo,
    wanted: Motion,
    *,
    facing: Facing | None,
    flying: bool,
) -> _Measurement:
    """The velocity while a command is published; see `_driven`."""
    joints = positions(world, model)
    poses = [model.pose]
    _drive_on(world, topic, wanted, _MEASURED, look=lambda: poses.append(model.pose))
    speeds = {
        name: (end - joints[name]) / _MEASURED for name, end in positions(world, model).items()
    }
    # The pose is that of the root link, whose frame may be turned in the model's frame.
    # Commands to plugins that move the whole model are in this frame, however its wheels turn.
    free = flying or _is_pushed(model, robot, topic)
    facing = facing or (FORWARD if free else heading(robot, speeds))
    ahead = rotate(robot.description.canonical_pose.inverse().orientation, (*facing, 0))
    middle = len(poses) // 2
    parts = (poses, poses[: middle + 1], poses[middle:])
    period = _period(world, topic)
    motion, *halves = (_velocity(part, ahead, period) for part in parts)
    return _Measurement(motion, (halves[0], halves[1]), facing)


def _velocity(poses: Sequence[Pose], forward: Vec3, period: float) -> Motion:
    """The mean velocity along a path, in the frame at its start.

    Args:
        poses: At the times of the commands.
        forward: The direction that counts as forward in the frame of the poses.
        period: Time between two commands, s.
    """
    seconds = (len(poses) - 1) * period
    before, after = poses[0], poses[-1]
    x, y, _ = rotate(before.orientation, forward)
    length = math.hypot(x, y) or 1.0
    dx, dy = after.x - before.x, after.y - before.y
    # A base that is much too fast turns by more than half a turn while it is measured.
    yaws = [_yaw(pose) for pose in poses]
    turned = sum(math.remainder(now - then, 2 * math.pi) for then, now in pairwise(yaws))
    along, across = (x * dx + y * dy) / length, (x * dy - y * dx) / length
    return Motion(along / seconds, across / seconds, turned / seconds)


def _take_off(world: World, topic: TopicInfo) -> bool:
    """Lets an aircraft take off that flies only after a message; whether there is such a topic."""
    found = False
    for each in world.graph.topics():
        if each.name.rpartition("/")[2] == "takeoff" and set(each.subscribers) & set(
            topic.subscribers
        ):
            found = True
            world.publish(each.name, {})
            world.run(_TAKING_OFF)
    return found


def _drive_on(
    world: World,
    topic: TopicInfo,
    command: Motion,
    seconds: float,
    *,
    climb: float = 0.0,
    look: Callable[[], None] | None = None,
) -> None:
    """Publishes a command, and calls `look` after each message."""
    linear = {"x": command.ahead, "y": command.left, "z": climb}
    twist = {"linear": linear, "angular": {"z": command.turn}}
    period = _period(world, topic)
    stamped = topic.type == TWIST_STAMPED
    # To make each message anew takes as long as to simulate the time between them.
    said = from_dict(topic.type, {"twist": twist} if stamped else twist, strict=True)
    for _ in range(round(seconds / period)):
        if stamped:
            now, rest = divmod(world.session.simulation.time_ns, NANOSECONDS)
            stamp = {"header": {"stamp": {"sec": now, "nanosec": rest}}, "twist": twist}
            said = from_dict(topic.type, stamp, strict=True)
        world.graph.publish(topic.name, topic.type, said)
        world.run(period)
        if look is not None:
            look()


def _period(world: World, topic: TopicInfo) -> float:
    """Time between two commands on a topic, s: at most half of that after which they expire."""
    timeout = world.session.shared.get(CommandTimeouts).shortest(topic.subscribers)
    if timeout >= 2 * _PERIOD:
        return _PERIOD
    step = world.step_size
    return max(1, math.floor(timeout / (2 * step))) * step


def _yaw(pose: Pose) -> float:
    x, y, _ = rotate(pose.orientation, (1, 0, 0))
    return math.atan2(y, x)
