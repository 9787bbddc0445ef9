"""Commands to single joints by velocity or effort, and to the propellers of an aircraft."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from cartwheel.api import Model, World
from cartwheel.corpus.motion import degree, positions, resistance
from cartwheel.corpus.thrusters import thruster_topics
from cartwheel.corpus.verdict import RISEN, Flight, Spin
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.graph import TopicInfo

_FLOAT, _FLOATS = "std_msgs/msg/Float64", "std_msgs/msg/Float64MultiArray"
_ACTUATORS = {
    "mav_msgs/msg/Actuators": "angular_velocities",
    "actuator_msgs/msg/Actuators": "velocity",
    "hector_uav_msgs/msg/MotorPWM": "pwm",
}
"""Fields with the propellers' speeds, or duty cycles, by message type."""
_DUTY = 255
"""The duty cycle of a motor at its full voltage."""
_PROPELLERS = 4
"""Number of propellers of a plugin for all of them."""
_VELOCITY = 0.5
"""rad/s or m/s."""
_ROOM = 0.8
"""Fraction of the way to a joint's limit that it may move."""
_ACCELERATION = 5.0
"""rad/s² or m/s², commanded by an effort beyond what holds a joint: the limit of a strong motor
would accelerate a light link beyond all bounds."""
_SPEEDING, _MEASURED, _PUSHING = 1.0, 1.0, 0.5
"""s."""
_STEPS = 20
"""Number of propeller speeds to try."""
_CLIMBING = 1.0
"""Time at each propeller speed, s."""
_LOOKING = 0.1
"""Interval at which the height is measured, s."""
_FASTEST = 838.0
"""rad/s; the default of gz-sim's motor model."""
_MOTOR = re.compile(r"motor_model|multicopter-motor")
_MOTORS = re.compile(r"quadrotor_propulsion")


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
    by_velocity: list[tuple[TopicInfo, tuple[str, ...]]] = []
    by_effort: list[tuple[TopicInfo, tuple[str, ...]]] = []
    by_position = {each.owner for each in world.graph.joint_inputs.all()}
    controllers = {each.node: each for each in started}
    thrusters = thruster_topics(world, model, robot)
    for info in world.graph.topics():
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
                (by_effort if pushes else by_velocity).append((info, joints))
    if by_velocity:
        speeds: dict[str, float] = {}

        def speed_of(name: str) -> float:
            speeds[name] = _velocity(robot.joint(name), model.joint(name))
            return speeds[name]

        before, after = _moved(world, model, by_velocity, speed_of, (_SPEEDING, _MEASURED))
        for info, joints in by_velocity:
            for name in joints:
                yield Spin(
                    topic=info.name,
                    joint=name,
                    commanded=speeds[name],
                    measured=(after[name] - before[name]) / _MEASURED,
                    effort=False,
                    sag=_sag(world, model, name, gains.get(name, 0.0)),
                )
    for info, joints in by_effort:
        for index, name in enumerate(joints):
            # An effort on several joints of a chain may move one of them backward.
            effort = _effort(world, model, robot, name)
            only = index if info.type == _FLOATS else None
            pushed, pulled = (
                _moved(world, model, [(info, joints)], _always(push), (0.0, _PUSHING), only=only)[1]
                for push in (effort, -effort)
            )
            speed = (pushed[name] - pulled[name]) / 2 / _PUSHING
            yield Spin(topic=info.name, joint=name, commanded=effort, measured=speed, effort=True)


def flights(world: World, model: Model, robot: RobotDescription) -> Iterator[Flight]:
    """Tries increasing speeds of all propellers, each from standstill, until the aircraft rises.

    Nothing stabilises it, so it tips over if the thrust hardly exceeds its weight for a while.
    """
    tags = [tag for tag in robot.plugins if _MOTOR.search(short_name(tag.filename))]
    together = [tag for tag in robot.plugins if _MOTORS.search(short_name(tag.filename))]
    motors = len(tags) or _PROPELLERS * len(together)
    if not motors:
        return
    stated = [tag.element.find("maxRotVelocity") for tag in tags]
    fastest = max([float(each.text) for each in stated if each is not None], default=_FASTEST)
    for info in world.graph.topics():
        field = _ACTUATORS.get(info.type)
        if field is None or not info.subscribers:
            continue
        speed = rose = 0.0
        for step in range(1, _STEPS + 1):
            speed = fastest * step / _STEPS if field != "pwm" else _DUTY * step // _STEPS
            rose = _risen(world, model, info.name, {field: [speed] * motors})
            if rose >= RISEN:
                break
        yield Flight(topic=info.name, motors=motors, command=speed, rose=rose)


def _risen(world: World, model: Model, topic: str, command: Mapping[str, Any]) -> float:
    """Largest increase in height after a command from standstill, m."""
    world.reset()
    world.run(0.5)
    height, rose = model.pose.z, 0.0
    world.publish(topic, command)
    for _ in range(round(_CLIMBING / _LOOKING)):
        world.run(_LOOKING)
        rose = max(rose, model.pose.z - height)
    return rose


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


def _velocity(joint: Joint | None, position: float) -> float:
    """A velocity at which a joint stays within its limits during the test, rad/s or m/s."""
    if joint is None:
        return _VELOCITY
    fastest = min(_VELOCITY, joint.axis.velocity or _VELOCITY)
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type == "continuous" or lower is None or upper is None:
        return fastest
    room, sign = max((upper - position, 1.0), (position - lower, -1.0))
    if upper <= lower or room <= 0:
        return fastest
    return sign * min(fastest, _ROOM * room / (_SPEEDING + _MEASURED))


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
    inputs: Sequence[tuple[TopicInfo, tuple[str, ...]]],
    value: Callable[[str], float],
    seconds: tuple[float, float],
    *,
    only: int | None = None,
) -> tuple[dict[str, float], dict[str, float]]:
    """Positions at the beginning and end of a measurement, after a reset and a command.

    `value` returns the command of a joint. `seconds` contains the time before the measurement and
    its duration. `only` is the index of the joint that receives its value; the others of its topic
    receive 0.
    """
    world.reset()
    world.run(0.5)
    for info, joints in inputs:
        values = [
            value(name) if only in (None, index) else 0.0 for index, name in enumerate(joints)
        ]
        said: Any = values[0] if info.type == _FLOAT else values
        world.publish(info.name, {"data": said})
    if seconds[0]:
        world.run(seconds[0])
    start = positions(world, model)
    world.run(seconds[1])
    return start, positions(world, model)
