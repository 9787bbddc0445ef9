"""Measures one robot in its own world: standing, driving, moving joints."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Any

from cartwheel.api import Model, World
from cartwheel.corpus.verdict import Drive, Reach, Stand
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.geometry import Pose, rotate
from cartwheel.graph import TWIST_STAMPED, JointInput, TopicInfo
from cartwheel.simulation.clock import NANOSECONDS

VELOCITY, TURN = 0.2, 0.4
"""m/s and rad/s commanded to a base: slow enough for the smallest robots."""
_SPEED_UP = 4.0
"""Maximum time for a base to reach the commanded speed, s."""
_MEASURED = 2.0
_RATE = 20.0
"""Rate of commands, Hz."""
_STEP, _SLIDE = 0.2, 0.02
"""Joint movement, rad and m."""
_TRAJECTORY = 2.0
"""Duration of a trajectory, s."""
_REACHING = 5.0
_SLICE = 0.5
"""Interval of wall-clock checks, s."""


def stand(world: World, model: Model, description: RobotDescription, seconds: float) -> Stand:
    """Simulates the robot without commands and measures how it stands.

    A simulation much slower than real time is cut short: its wall time is limited to the requested
    simulation time, but the last second is always measured.

    Raises:
        SimulationError: The simulation diverged.
    """
    start, begun, from_ns = model.pose, time.perf_counter(), world.session.simulation.time_ns
    left = round((seconds - 1.0) / _SLICE)
    while left > 0 and time.perf_counter() - begun < seconds:
        world.run(_SLICE)
        left -= 1
    before = model.pose
    world.run(1.0)
    after = model.pose
    simulated = (world.session.simulation.time_ns - from_ns) / NANOSECONDS
    return Stand(
        fixed=description.static or not world.session.simulation.moves(model.name),
        simulated=simulated,
        wall=time.perf_counter() - begun,
        sunk=start.z - after.z,
        tilt=_between(rotate(start.orientation, (0, 0, 1)), rotate(after.orientation, (0, 0, 1))),
        speed=math.dist(before.position, after.position),
        turn=_turned(before, after),
    )


def drives(world: World, model: Model) -> Iterator[Drive]:
    """Drives on each topic with velocity commands, forward and turning, each after a reset."""
    for info in world.graph.topics():
        if not info.drives:
            continue
        ahead, _ = _driven(world, model, info, (VELOCITY, 0.0))
        _, turn = _driven(world, model, info, (0.0, TURN))
        yield Drive(
            topic=info.name,
            commanded=VELOCITY,
            measured=ahead,
            commanded_turn=TURN,
            measured_turn=turn,
        )
    world.reset()


def reaches(world: World, model: Model, description: RobotDescription) -> list[Reach]:
    """Commands all position-controlled joints at once and measures where they end."""
    world.reset()
    world.run(1.0)
    joints = {joint.name: joint for joint in description.joints}
    told: list[tuple[JointInput, Joint, float]] = []
    for taker in world.graph.joint_inputs.all():
        targets = {name: _target(joints[name], model.joint(name)) for name in taker.joints}
        taker.put(targets, _TRAJECTORY)
        told += [(taker, joints[name], value) for name, value in targets.items()]
    if told:
        world.run(_REACHING)
    return [
        Reach(
            controller=taker.owner,
            joint=joint.name,
            target=target,
            reached=model.joint(joint.name),
            angular=joint.type != "prismatic",
        )
        for taker, joint, target in told
    ]


def _driven(
    world: World, model: Model, topic: TopicInfo, command: tuple[float, float]
) -> tuple[float, float]:
    """Forward speed in m/s and turn rate in rad/s, to the left, after a constant command."""
    world.reset()
    world.run(0.5)
    _drive_on(world, topic, command, _SPEED_UP)
    before = model.pose
    _drive_on(world, topic, command, _MEASURED)
    after = model.pose
    yaw = _yaw(before)
    dx, dy = after.x - before.x, after.y - before.y
    turned = math.remainder(_yaw(after) - yaw, 2 * math.pi)
    return (math.cos(yaw) * dx + math.sin(yaw) * dy) / _MEASURED, turned / _MEASURED


def _drive_on(world: World, topic: TopicInfo, command: tuple[float, float], seconds: float) -> None:
    twist = {"linear": {"x": command[0]}, "angular": {"z": command[1]}}
    for _ in range(round(seconds * _RATE)):
        said: dict[str, Any] = twist
        if topic.type == TWIST_STAMPED:
            now, rest = divmod(world.session.simulation.time_ns, NANOSECONDS)
            said = {"header": {"stamp": {"sec": now, "nanosec": rest}}, "twist": twist}
        world.publish(topic.name, said)
        world.run(1.0 / _RATE)


def _target(joint: Joint, position: float) -> float:
    """A nearby position within the joint's limits."""
    step = _SLIDE if joint.type == "prismatic" else _STEP
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type == "continuous" or lower is None or upper is None:
        return position + step
    step = min(step, 0.25 * (upper - lower))
    return position + step if position < (lower + upper) / 2 else position - step


def _yaw(pose: Pose) -> float:
    x, y, _ = rotate(pose.orientation, (1, 0, 0))
    return math.atan2(y, x)


def _turned(one: Pose, other: Pose) -> float:
    """Angle between two orientations, rad."""
    w = abs(sum(a * b for a, b in zip(one.orientation, other.orientation, strict=True)))
    return 2 * math.acos(min(1.0, w))


def _between(one: tuple[float, float, float], other: tuple[float, float, float]) -> float:
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    return math.acos(max(-1.0, min(1.0, cosine)))
