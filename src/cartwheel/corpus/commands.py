"""Commands to single joints by velocity or effort."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from cartwheel.api import Model, World
from cartwheel.checks.robot import Robot
from cartwheel.corpus.flying.flights import MOST_ACTUATORS
from cartwheel.corpus.flying.thrusters import thruster_topics
from cartwheel.corpus.heading import rolling
from cartwheel.corpus.loads import degree, resistance
from cartwheel.corpus.motion import positions
from cartwheel.corpus.verdict import Spin
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.joint_controller import (
    JointController,
    JointVelocityParameters,
    actuator_of,
)
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.tags import read
from cartwheel.errors import PluginError
from cartwheel.graph import TopicInfo

_GZ_ACTUATORS = "actuator_msgs/msg/Actuators"
_FLOAT, _FLOATS = "std_msgs/msg/Float64", "std_msgs/msg/Float64MultiArray"
_VELOCITY, _FAST = 0.5, 20.0
"""rad/s or m/s; the second for joints whose controllers' gains are too small for the first."""
_FASTER = 5.0
"""Time to reach the second, s."""
_ROOM = 0.8
"""Fraction of the way to a joint's limit that it may move."""
_ACCELERATION = 5.0
"""rad/s² or m/s², commanded by an effort beyond what holds a joint: the limit of a strong motor
would accelerate a light link beyond all bounds."""
SPEEDING, _MEASURED, _PUSHING = 1.0, 1.0, 0.5
"""s."""
_ALONE, _SOON = 12, 0.3
"""Maximum number of topics whose joints are commanded alone, and the time until they are measured
and while they are, s."""
_GLIMPSE, _MOVES = 0.1, 1e-5
"""A shorter time of pushing, s, and the minimum speed in it, rad/s or m/s."""


@dataclass(frozen=True, slots=True)
class _Input:
    """A topic that commands joints."""

    info: TopicInfo
    joints: tuple[str, ...]
    numbers: Mapping[str, int] = field(default_factory=dict)
    """The indices of the joints in a message of type Actuators."""

    def message(self, values: Sequence[float]) -> dict[str, Any]:
        """The message with a value for each joint."""
        if self.info.type == _FLOAT:
            return {"data": values[0]}
        if self.info.type == _FLOATS:
            return {"data": list(values)}
        velocities = [0.0] * (1 + max(self.numbers.values()))
        for name, value in zip(self.joints, values, strict=True):
            velocities[self.numbers[name]] = value
        return {"velocity": velocities}


def spins(
    world: World,
    model: Model,
    robot: RobotDescription,
    started: Sequence[Controller],
    gains: Mapping[str, float],
) -> Iterator[Spin]:
    """Commands the joints that accept velocities, all at once, and each that accepts efforts.

    `gains` contains the proportional gains of PID controllers with an effort output and a slow or
    no integral, by joint, in N m s/rad or N s/m.
    """
    by_velocity: list[_Input] = []
    by_effort: list[_Input] = []
    by_position = {each.owner for each in world.graph.joint_inputs.all()}
    controllers = {each.node: each for each in started}
    thrusters = thruster_topics(world, model, robot)
    for info in world.graph.topics():
        if info.type == _GZ_ACTUATORS and (numbers := _actuated(info, robot)):
            by_velocity.append(_Input(info, tuple(numbers), numbers))
        if info.type not in (_FLOAT, _FLOATS) or info.name in thrusters:
            continue
        for node in info.subscribers:
            owner = controllers.get(node)
            if not node.startswith(f"{model.name}/") or node.split("/", 1)[1] in by_position:
                continue
            joints = tuple(owner.claims) if owner is not None else _joints(info, robot)
            kind = owner.type + str(owner.interfaces) if owner is not None else info.name
            if joints:
                pushes = re.search("effort|force", kind, re.IGNORECASE) and "Velocity" not in kind
                (by_effort if pushes else by_velocity).append(_Input(info, joints))
    yield from _spun(world, model, robot, by_velocity, gains)
    for each in by_effort:
        for index, name in enumerate(each.joints):
            # An effort on several joints of a chain may move one of them backward.
            effort = _effort(world, model, robot, name)
            only = index if each.info.type == _FLOATS else None
            pushed, pulled = (
                _moved(world, model, [each], _always(push), (_GLIMPSE, _PUSHING), only=only)
                for push in (effort, -effort)
            )
            # The joints of an arm that falls meanwhile soon move each other more than the effort.
            ways = (
                (forth[name] - back[name]) / 2 for forth, back in zip(pushed, pulled, strict=True)
            )
            speeds = [way / time for way, time in zip(ways, (_GLIMPSE, _PUSHING), strict=True)]
            speed = speeds[0] if abs(speeds[0]) > _MOVES else speeds[1]
            yield Spin(
                topic=each.info.name, joint=name, commanded=effort, measured=speed, effort=True
            )


def _spun(
    world: World,
    model: Model,
    robot: RobotDescription,
    inputs: Sequence[_Input],
    gains: Mapping[str, float],
) -> Iterator[Spin]:
    """Commands velocities of all joints at once.

    Joints that do not follow because of their gains are commanded again, at a higher velocity, of
    which the error from friction and rolling resistance is a smaller part. Others are commanded
    again alone: an arm whose joints all move may meet the ground.
    """
    slow = list(_spinning(world, model, robot, inputs, gains, velocity=_VELOCITY))
    late = {each.joint for each in slow if not each.follows and gains.get(each.joint)}
    again = [each for each in inputs if not late.isdisjoint(each.joints)]
    fast = {
        (each.topic, each.joint): each
        for each in _spinning(world, model, robot, again, gains, velocity=_FAST)
        if each.joint in late and each.follows
    }
    found = [fast.get((each.topic, each.joint), each) for each in slow]
    blocked = {each.topic for each in found if not each.follows}
    alone = {
        (each.topic, each.joint): each
        for one in [each for each in inputs if each.info.name in blocked][:_ALONE]
        if len(inputs) > 1
        for each in _spinning(world, model, robot, [one], gains, velocity=_VELOCITY, soon=True)
        if each.follows
    }
    for each in found:
        yield each if each.follows else alone.get((each.topic, each.joint), each)


def _spinning(
    world: World,
    model: Model,
    robot: RobotDescription,
    inputs: Sequence[_Input],
    gains: Mapping[str, float],
    *,
    velocity: float,
    soon: bool = False,
) -> Iterator[Spin]:
    """Commands velocities, and measures them after a while or `soon`."""
    if not inputs:
        return
    speeds: dict[str, float] = {}
    signs = rolling(Robot(robot, None), [name for each in inputs for name in each.joints])

    def speed_of(name: str) -> float:
        joint = robot.joint(name)
        sign = signs.get(name, 1.0) if joint is not None and joint.turns else 1.0
        speeds[name] = sign * _velocity(joint, model.joint(name), velocity)
        return speeds[name]

    begun = _SOON if soon else SPEEDING if velocity == _VELOCITY else _FASTER
    measured = _SOON if soon else _MEASURED
    before, after = _moved(world, model, inputs, speed_of, (begun, begun + measured))
    for each in inputs:
        for name in each.joints:
            yield Spin(
                topic=each.info.name,
                joint=name,
                commanded=speeds[name],
                measured=(after[name] - before[name]) / measured,
                effort=False,
                sag=_sag(world, model, name, gains.get(name, 0.0)),
            )


def _actuated(info: TopicInfo, robot: RobotDescription) -> dict[str, int]:
    """The joints that a topic of type Actuators commands by velocity, with their indices."""
    found: dict[str, int] = {}
    for tag in robot.plugins:
        if plugin_named(tag.filename) is not JointController:
            continue
        with contextlib.suppress(PluginError):
            config, _ = read(JointVelocityParameters, tag.element)
            number = actuator_of(config)
            topic = (config.topic or config.sub_topic).strip() or "actuators"
            if number is not None and number < MOST_ACTUATORS and info.name.endswith(topic):
                found |= dict.fromkeys((name.strip() for name in config.joints), number)
    return found


def _joints(info: TopicInfo, robot: RobotDescription) -> tuple[str, ...]:
    """The joint of a plugin's topic such as ``/model/robot/joint/arm/cmd_vel``, or of its tag."""
    named = [each.name for each in robot.joints if f"/joint/{each.name}/" in info.name]
    for tag in robot.plugins:
        topic, joint = tag.element.find("topic"), tag.element.find("joint_name")
        if topic is not None and joint is not None and info.name.endswith(topic.text.strip()):
            named.append(joint.text.strip())
    return tuple(dict.fromkeys(named))


def _sag(world: World, model: Model, joint: str, gain: float) -> float:
    """Error of a proportional controller because of its load at the commanded velocity."""
    if gain <= 0:
        return 0.0
    load, _ = resistance(world, model, joint)
    return (load + _damping(world, model, joint) * _VELOCITY) / gain


def _damping(world: World, model: Model, joint: str) -> float:
    """N m s/rad or N s/m."""
    return float(world.session.simulation.model.dof_damping[degree(world, model, joint)])


def _always(value: float) -> Callable[[str], float]:
    """The same command for all joints."""
    return lambda _: value


def _velocity(joint: Joint | None, position: float, most: float) -> float:
    """A velocity at which a joint stays within its limits during the test, rad/s or m/s."""
    if joint is None:
        return most
    fastest = min(most, joint.axis.velocity or most)
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.turns or lower is None or upper is None:
        return fastest
    room, sign = max((upper - position, 1.0), (position - lower, -1.0))
    if upper <= lower or room <= 0:
        return fastest
    return sign * min(fastest, _ROOM * room / (SPEEDING + _MEASURED))


def _effort(world: World, model: Model, robot: RobotDescription, name: str) -> float:
    """An effort that moves a joint, at most the joint's limit, N m or N."""
    load, inertia = resistance(world, model, name)
    joint = robot.joint(name)
    limit = (joint.axis.effort if joint is not None else None) or math.inf
    # A damped joint of little inertia would not move otherwise.
    damped = _damping(world, model, name) * _VELOCITY
    return min(load + _ACCELERATION * inertia + damped, limit)


def _moved(
    world: World,
    model: Model,
    inputs: Sequence[_Input],
    value: Callable[[str], float],
    seconds: tuple[float, float],
    *,
    only: int | None = None,
) -> tuple[dict[str, float], dict[str, float]]:
    """Positions at two times after a reset and a command.

    `value` returns the command of a joint. `seconds` contains both times. `only` is the index of
    the joint that receives its value; the others of its topic receive 0.
    """
    world.reset()
    world.run(0.5)
    for each in inputs:
        values = [
            value(name) if only in (None, index) else 0.0 for index, name in enumerate(each.joints)
        ]
        world.publish(each.info.name, each.message(values))
    world.run(seconds[0])
    start = positions(world, model)
    world.run(seconds[1] - seconds[0])
    return start, positions(world, model)
