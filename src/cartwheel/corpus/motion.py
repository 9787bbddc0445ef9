"""Measures one robot in its own world: standing, driving, moving joints."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence, Set
from typing import Any

from cartwheel.api import Model, World
from cartwheel.checks.robot import Robot
from cartwheel.corpus.couplings import consistent, couplings_of, slopes, within
from cartwheel.corpus.heading import heading
from cartwheel.corpus.hovering import climbs, drag_errors
from cartwheel.corpus.limits import StatedLimits
from cartwheel.corpus.loads import held_by, resistance
from cartwheel.corpus.thrusters import has_thrusters, is_in_space
from cartwheel.corpus.verdict import TOLERANCE, Drive, Reach, Stand
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.devices.drives.drive import Drives
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.classic.drives.planar_move import PlanarMove
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.geometry import Pose, rotate
from cartwheel.graph import TWIST_STAMPED, JointInput, TopicInfo
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
"""Increase from one measurement to the next, relative to the command, below which a base no longer
accelerates."""
_SLID = 0.01
"""Speed that a base of planar_move loses, also in Gazebo, if it slides with a friction coefficient
of 1, m/s."""
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
        size=Robot(description, None).size,
        floats=has_thrusters(description) or is_in_space(description),
    )


def drives(
    world: World,
    model: Model,
    robot: Robot,
    limits: StatedLimits,
    started: Sequence[Controller],
    *,
    idle: Set[str],
    steered: bool,
) -> Iterator[Drive]:
    """Drives on each topic with velocity commands, forward and turning, each after a reset.

    Args:
        world: The world.
        model: The robot in the world.
        robot: Its description.
        limits: The robot's own limits. The commands stay below them.
        started: The controllers that run.
        idle: Nodes of controllers that do not run, whose topics are not tested.
        steered: The base cannot turn in place, so it turns while it drives forward.
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
        ahead, _ = _driven(world, model, robot, info, (forward, 0.0, speed_up))
        both = (forward if steered else 0.0, turn, speed_up)
        _, turned = _driven(world, model, robot, info, both)
        drive = world.session.shared.get(Drives).of(info.subscribers) or next(
            (
                each
                for each in started
                if isinstance(each, WheelController) and each.node in info.subscribers
            ),
            None,
        )
        yield Drive(
            topic=info.name,
            commanded=drive.commanded(forward, 0.0)[0] if drive is not None else forward,
            measured=ahead,
            commanded_turn=drive.commanded(*both[:2])[1] if drive is not None else turn,
            measured_turn=turned,
            turning="arc" if steered else "in place",
            limited=forward < VELOCITY or (turn < TURN and not steered),
            sag=sag,
            sag_turn=sag_turn,
        )
    world.reset()


def reaches(
    world: World,
    model: Model,
    description: RobotDescription,
    started: Sequence[Controller],
    gains: Mapping[str, float],
) -> list[Reach]:
    """Commands all position-controlled joints at once and measures where they end.

    Controllers that a plugin commands are left out, because it would replace the commands. `gains`
    contains the proportional gains of PID controllers with an effort output and a slow or no
    integral, by joint, in N m/rad or N/m.
    """
    taken = {each.name for each in started if _is_commanded(world, each)}
    takers = [each for each in world.graph.joint_inputs.all() if each.owner not in taken]
    if not takers:
        return []
    world.reset()
    world.run(1.0)
    joints = {joint.name: joint for joint in description.joints}
    sent: list[tuple[JointInput, Joint, float]] = []
    chosen = _targets(world, model, [joints[name] for taker in takers for name in taker.joints])
    for taker in takers:
        targets = {name: chosen[name] for name in taker.joints}
        taker.put(targets, _TRAJECTORY)
        sent += [(taker, joints[name], value) for name, value in targets.items()]
    held = {joint.name: held_by(world, model, joint.name) for _, joint, _ in sent}
    coupled = couplings_of(world, model)
    if sent:
        world.run(_REACHING)
    return [
        Reach(
            controller=taker.owner,
            joint=joint.name,
            target=target,
            reached=model.joint(joint.name),
            angular=joint.type != "prismatic",
            sag=max(
                slope * _sag(world, model, name, gains.get(name, 0.0), held[name])
                for name, slope in slopes(joint.name, held, coupled).items()
            ),
        )
        for taker, joint, target in sent
    ]


def _is_commanded(world: World, controller: Controller) -> bool:
    """Whether a plugin publishes on a topic of a controller, such as a drive that steers by it."""
    return any(
        info.publishers and controller.node in info.subscribers for info in world.graph.topics()
    )


def yields(proportional: float, integral: float) -> bool:
    """Whether the integral of a PID controller is too slow to correct an error within the test."""
    return integral * _REACHING < proportional


def _sag(world: World, model: Model, joint: str, gain: float, held: float) -> float:
    """Error of a proportional controller because of its load, rad or m.

    A suspension carries the robot through its wheels, so its load is not gravity at the joint, but
    what its motor `held` before the command, N m or N.
    """
    return max(resistance(world, model, joint)[0], held) / gain if gain > 0 else 0.0


def _driven(
    world: World,
    model: Model,
    robot: Robot,
    topic: TopicInfo,
    command: tuple[float, float, float],
) -> tuple[float, float]:
    """Forward speed in m/s and turn rate in rad/s, to the left, after a constant command.

    `command` contains both velocities and the time to reach them in s.
    """
    world.reset()
    world.run(0.5)
    flying = _take_off(world, topic)
    if climbs(robot.description):
        flying = True
        _drive_on(world, topic, (0.0, 0.0), _CLIMBING, climb=_CLIMB)
    *velocity, speed_up = command
    _drive_on(world, topic, velocity, speed_up)
    ahead, turned = _measured(world, model, robot, topic, velocity, flying=flying)
    waited = speed_up + _MEASURED
    # Wheels that slide because of a small load need long to accelerate the base.
    while waited < _LONGEST and not all(
        abs(now - wanted) <= TOLERANCE * abs(wanted)
        for now, wanted in zip((ahead, turned), velocity, strict=True)
        if wanted
    ):
        before = ahead, turned
        ahead, turned = _measured(world, model, robot, topic, velocity, flying=flying)
        waited += _MEASURED
        changes = [
            (now - then) / wanted
            for now, then, wanted in zip((ahead, turned), before, velocity, strict=True)
            if wanted
        ]
        if max(changes) < _SETTLED:
            break
    return ahead, turned


def _measured(
    world: World,
    model: Model,
    robot: Robot,
    topic: TopicInfo,
    velocity: Sequence[float],
    *,
    flying: bool,
) -> tuple[float, float]:
    """Forward speed in m/s and turn rate in rad/s, to the left, while a command is published."""
    before, joints = model.pose, positions(world, model)
    _drive_on(world, topic, velocity, _MEASURED)
    after = model.pose
    speeds = {
        name: (end - joints[name]) / _MEASURED for name, end in positions(world, model).items()
    }
    # The pose is that of the root link, whose frame may be turned in the model's frame.
    facing = (1.0, 0.0) if flying else heading(robot, speeds)
    ahead = rotate(robot.description.canonical_pose.inverse().orientation, (*facing, 0))
    x, y, _ = rotate(before.orientation, ahead)
    length = math.hypot(x, y) or 1.0
    dx, dy = after.x - before.x, after.y - before.y
    turned = math.remainder(_yaw(after) - _yaw(before), 2 * math.pi)
    return (x * dx + y * dy) / length / _MEASURED, turned / _MEASURED


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


def positions(world: World, model: Model) -> dict[str, float]:
    """Positions of the joints with one degree of freedom, rad or m, by name."""
    joints = world.session.simulation.scene.joints
    return {name: model.joint(name) for owner, name in joints if owner == model.name}


def _drive_on(
    world: World,
    topic: TopicInfo,
    command: Sequence[float],
    seconds: float,
    *,
    climb: float = 0.0,
) -> None:
    twist = {"linear": {"x": command[0], "z": climb}, "angular": {"z": command[1]}}
    for _ in range(round(seconds * _RATE)):
        said: dict[str, Any] = twist
        if topic.type == TWIST_STAMPED:
            now, rest = divmod(world.session.simulation.time_ns, NANOSECONDS)
            said = {"header": {"stamp": {"sec": now, "nanosec": rest}}, "twist": twist}
        world.publish(topic.name, said)
        world.run(1.0 / _RATE)


def _targets(world: World, model: Model, joints: Sequence[Joint]) -> dict[str, float]:
    """Nearby positions within the joints' limits; joints that follow each other move together."""
    commanded = {joint.name: joint for joint in joints}
    wanted = {name: target_of(joint, model.joint(name)) for name, joint in commanded.items()}
    coupled = couplings_of(world, model)
    found: dict[str, float] = {}
    for name, target in wanted.items():
        if name in found:
            continue
        back = 2 * model.joint(name) - target
        ways = [consistent((name, goal), wanted, coupled) for goal in (target, back)]
        found |= next(
            (way for way in ways if all(within(commanded[one], at) for one, at in way.items())),
            ways[0],
        )
    return found


def target_of(joint: Joint, position: float) -> float:
    """A nearby position within the joint's limits."""
    step = _SLIDE if joint.type == "prismatic" else _STEP
    if joint.axis.velocity:
        # Half of the joint's limit leaves time to accelerate.
        step = min(step, 0.5 * joint.axis.velocity * _TRAJECTORY)
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
