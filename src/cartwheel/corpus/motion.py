"""Measures one robot in its own world: standing, and moving joints to positions."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence

from cartwheel.api import Model, World
from cartwheel.checks.gains import following_gain, span
from cartwheel.checks.resting import starting_positions
from cartwheel.checks.robot import Robot
from cartwheel.corpus.couplings import consistent, couplings_of, slopes, within
from cartwheel.corpus.flying.thrusters import is_in_space
from cartwheel.corpus.loads import held_by, resistance
from cartwheel.corpus.verdict import SHORT, Reach, Stand
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.dialects.gz.initial_targets import initial_targets
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.sinking import is_in_water, sinking_load
from cartwheel.geometry import Pose, rotate
from cartwheel.graph import JointInput
from cartwheel.simulation.clock import NANOSECONDS

_STEP, _SLIDE = 0.2, 0.02
"""Joint movement, rad and m."""
_TRAJECTORY = 2.0
"""Duration of a trajectory, s."""
_REACHING = 5.0
_LATER = 10.0
"""Time after which a joint that still approaches its target must have reached it, s."""
_APPROACHING = 0.02
"""Part of the way that such a joint moves in one second."""
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
        tilt=angle_between(
            rotate(start.orientation, (0, 0, 1)), rotate(after.orientation, (0, 0, 1))
        ),
        speed=math.dist(before.position, after.position),
        turn=_turned(before, after),
        size=Robot(description, None).size,
        floats=is_in_water(description) or is_in_space(description),
        heavy=sinking_load(description) is not None,
        settled=_settled(description, start, after, positions(world, model)),
    )


def _settled(
    description: RobotDescription, start: Pose, after: Pose, reached: Mapping[str, float]
) -> float | None:
    """Decrease in height of a robot's lowest collision if all links move with the root, m.

    Joints that start outside their limits are moved into them, and plugins may bend legs to their
    initial targets, so that the robot comes down. None for a robot without collisions.

    Args:
        description: The robot.
        start: The pose of its root at the start.
        after: The pose of its root at the end.
        reached: The positions of the joints at the end, rad or m, by name.
    """
    robot = Robot(description, None)
    placed = {link.name: link.pose for link in description.links}
    before = _lowest(robot, placed, start)
    bent = starting_positions(robot)
    for name, target in initial_targets(description).items():
        if name in reached:
            # Further than the target, the load moves it.
            begin = bent.get(name, 0.0)
            bent[name] = min(max(reached[name], min(begin, target)), max(begin, target))
    now = _lowest(robot, link_poses(description, bent), after)
    return None if before is None or now is None else before - now


def _lowest(robot: Robot, poses: Mapping[str, Pose], place: Pose) -> float | None:
    """Height of the lowest collision of links with these poses, m; `place` is the root's pose."""
    root = place @ robot.description.canonical_pose.inverse()
    heights = [
        float(solid.placed(root @ pose)[:, 2].min())
        for name, pose in poses.items()
        for solid in robot.collisions[name]
    ]
    return min(heights, default=None)


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
    body = Robot(description, None)
    fast = commanded_speeds(started)
    # A joint that falls over, or that tips far beyond its target, does not sag by a small angle.
    gains = {
        name: gain
        for name, gain in gains.items()
        if name not in joints or name in fast or gain >= following_gain(body, joints[name])
    }
    commanded = [joints[name] for taker in takers for name in taker.joints]
    targets = _targets(world, model, commanded)
    found = _reached(world, model, takers, joints, targets, gains=gains)
    # The target may be where the load had moved the joint, and so the command as before.
    doubtful = {each.joint for each in found if not each.moved and gains.get(each.joint)}
    if not doubtful:
        return found
    world.reset()
    world.run(1.0)
    other = {
        name: _elsewhere(joints[name], model.joint(name), target) if name in doubtful else target
        for name, target in targets.items()
    }
    again = _reached(world, model, takers, joints, other, gains=gains)
    return [
        then if each.joint in doubtful and then.moved else each
        for each, then in zip(found, again, strict=True)
    ]


def _reached(
    world: World,
    model: Model,
    takers: Sequence[JointInput],
    joints: Mapping[str, Joint],
    chosen: Mapping[str, float],
    *,
    gains: Mapping[str, float],
) -> list[Reach]:
    """Commands targets, by joint, and measures where the joints end."""
    sent: list[tuple[JointInput, Joint, float]] = []
    for taker in takers:
        targets = {name: chosen[name] for name in taker.joints}
        taker.put(targets, _TRAJECTORY)
        sent += [(taker, joints[name], value) for name, value in targets.items()]
    held = {joint.name: held_by(world, model, joint.name) for _, joint, _ in sent}
    start = positions(world, model)
    coupled = couplings_of(world, model)
    if sent:
        shortened = {
            joint.name: (start[joint.name], target)
            for _, joint, target in sent
            if abs(target - start[joint.name]) < 0.99 * _step(joint)
        }
        _wait(world, model, shortened)
    return [
        Reach(
            controller=taker.owner,
            joint=joint.name,
            start=start[joint.name],
            target=target,
            reached=model.joint(joint.name),
            angular=joint.type != "prismatic",
            sag=_explained(
                joint,
                max(
                    slope * _sag(world, model, name, gains.get(name, 0.0), held[name])
                    for name, slope in slopes(joint.name, held, coupled).items()
                ),
            ),
        )
        for taker, joint, target in sent
    ]


def _wait(world: World, model: Model, ways: Mapping[str, tuple[float, float]]) -> None:
    """Waits until joints have reached their targets, and longer for those with limits.

    A heavy joint whose speed is limited overshoots, or starts late. `ways` contains the start and
    the target, rad or m, of the joints whose limits shorten their ways, by name.
    """
    world.run(_REACHING - 1.0)
    for _ in range(1 + round(_LATER - _REACHING)):
        before = {name: model.joint(name) for name in ways}
        world.run(1.0)
        if not any(
            abs(left := target - model.joint(name)) > SHORT * (way := abs(target - begin))
            and abs(left) < abs(target - before[name]) - _APPROACHING * way
            for name, (begin, target) in ways.items()
        ):
            return


def _elsewhere(joint: Joint, start: float, target: float) -> float:
    """Another target: on the other side, or nearer if the joint's limits exclude that."""
    back = 2 * start - target
    return back if within(joint, back) else (start + target) / 2


def _is_commanded(world: World, controller: Controller) -> bool:
    """Whether a plugin publishes on a topic of a controller, such as a drive that steers by it."""
    return any(
        info.publishers and controller.node in info.subscribers for info in world.graph.topics()
    )


def commanded_speeds(started: Sequence[Controller]) -> set[str]:
    """The joints whose velocities controllers command, so that a PID's gain is one of velocity."""
    return {
        joint
        for each in started
        for joint, interface in each.interfaces.items()
        if interface == "velocity"
    }


def yields(proportional: float, integral: float) -> bool:
    """Whether the integral of a PID controller is too slow to correct an error within the test."""
    return integral * _REACHING < proportional


def _sag(world: World, model: Model, joint: str, gain: float, held: float) -> float:
    """Error of a proportional controller because of its load, rad or m.

    A suspension carries the robot through its wheels, so its load is not gravity at the joint, but
    what its motor `held` before the command, N m or N.
    """
    return max(resistance(world, model, joint)[0], held) / gain if gain > 0 else 0.0


def _explained(joint: Joint, sag: float) -> float:
    """The error that gains explain: none if a joint sags to its limit wherever it is commanded."""
    way = span(joint)
    return sag if way is None or sag <= way else 0.0


def positions(world: World, model: Model) -> dict[str, float]:
    """Positions of the joints with one degree of freedom, rad or m, by name."""
    joints = world.session.simulation.scene.joints
    return {name: model.joint(name) for owner, name in joints if owner == model.name}


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
    step = _step(joint)
    if joint.axis.velocity:
        # Half of the joint's limit leaves time to accelerate.
        step = min(step, 0.5 * joint.axis.velocity * _TRAJECTORY)
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type == "continuous" or lower is None or upper is None:
        return position + step
    step = min(step, 0.25 * (upper - lower))
    return position + step if position < (lower + upper) / 2 else position - step


def _step(joint: Joint) -> float:
    """The usual way of a joint, rad or m."""
    return _SLIDE if joint.type == "prismatic" else _STEP


def _turned(one: Pose, other: Pose) -> float:
    """Angle between two orientations, rad."""
    w = abs(sum(a * b for a, b in zip(one.orientation, other.orientation, strict=True)))
    return 2 * math.acos(min(1.0, w))


def angle_between(one: tuple[float, float, float], other: tuple[float, float, float]) -> float:
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    return math.acos(max(-1.0, min(1.0, cosine)))
