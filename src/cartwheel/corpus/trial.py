"""Tests one robot as a user would: load, stand, listen, drive and move joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from cartwheel.api import Model, World
from cartwheel.checks.checking import Report, check
from cartwheel.checks.robot import Robot
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.corpus import commands, driving, motion
from cartwheel.corpus.causes.falls import has_devices
from cartwheel.corpus.diagnosis import faults
from cartwheel.corpus.faults import Fault
from cartwheel.corpus.flying.flights import flights
from cartwheel.corpus.flying.thrusters import bursts, thrusts
from cartwheel.corpus.gains import sagged, too_weak, too_weak_to_turn, undamped, weak_gains
from cartwheel.corpus.limits import stated_limits, within_speeds
from cartwheel.corpus.listening import LISTENING, controlled_sides, controllers_of, idle, listened
from cartwheel.corpus.movers import STEERED, movers
from cartwheel.corpus.placing import HIGH, name_in, put, surroundings
from cartwheel.corpus.poses import posed
from cartwheel.corpus.resting import (
    blocked,
    dragging,
    driven,
    drives_apart,
    gave_way,
    sagging,
    toppled,
)
from cartwheel.corpus.rivals import hindered
from cartwheel.corpus.verdict import Drive, Verdict
from cartwheel.corpus.worlds import load_from_world
from cartwheel.description import load_robot
from cartwheel.description.launches import (
    LaunchSearch,
    LaunchUse,
    chosen,
    launch_mistakes,
    launches_near,
    moves,
    own_launches,
    unread,
)
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.gz.gazebo_only import as_launched, with_own_plugins
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.selection import Selection, selection, with_published_control
from cartwheel.dialects.ros_control.suggestion import is_controlled
from cartwheel.dialects.world_plugins import BUILT_IN, WITHOUT_EFFECT, refused
from cartwheel.errors import CartwheelError, Diagnostic, Origin
from cartwheel.geometry import Pose

STANDING = 10.0
"""Simulation time without commands, s."""


def try_robot(
    file: Path,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    controllers: Sequence[Path] | None = None,
    standing: float = STANDING,
    launches: Sequence[LaunchUse] | None = None,
    model: str = "",
    folder: Path | None = None,
) -> Verdict:
    """Tests a description with the arguments and controllers that its launch files name.

    Args:
        file: A xacro, URDF or SDF file.
        arguments: Arguments of the xacro, which take precedence over those of the launch files.
        package_path: Folders to search for packages first.
        controllers: YAML files whose controllers start. None uses the files in the launch files,
            or the files near the robot that `cartwheel run` would suggest, except those that need
            values from a launch file.
        standing: Simulation time without commands, s.
        launches: Contents of launch files. None: the launch files in the robot's repository, in its
            package and in the packages beside it are read.
        model: The name of the model to test, if the file is a world.
        folder: The folder of robots that contains the file. Files outside of it that the robot
            does not name are not used, nor those of other repositories in it.

    Returns:
        The results, including errors in the description.
    """
    verdict = Verdict(file=file, model=model)
    if launches is None and folder is not None:
        launches = launches_near(folder, package_path)
    find = LaunchSearch(package_path).of
    if launches is not None:
        find = partial(own_launches, uses=launches, within=folder)
    own = find(file)
    launches = own.launches
    use = chosen(file, launches)
    verdict = replace(verdict, launch=use, unread=unread(launches))
    given = dict(arguments or {})
    arguments = {**(use.arguments if use is not None else {}), **given}
    try:
        is_inside = None
        if model:
            robot, is_inside = load_from_world(file, model, arguments, package_path)
        else:
            robot = load_robot(file, arguments=arguments, package_path=package_path)
            if use is not None and not use.simulated and arguments != given:
                default = _for_simulation(robot, file, given, package_path)
                if default is not None:
                    robot, arguments = default, given
        robot = with_published_control(robot, launches, package_path)
        robot = as_launched(robot, file, launches, given, package_path)
    except CartwheelError as error:
        reason = error.diagnostic()
        return replace(
            verdict, error=str(error), failure=reason, faults=(Fault(test="load", reason=reason),)
        )
    verdict = replace(_described(verdict, robot), observed=launch_mistakes(file, use, launches))
    whole, robot = robot, with_own_plugins(robot)  # as in Gazebo
    spawned: tuple[str, ...] = ()
    selected: Selection | None = None
    if controllers is None:
        selected = selection(robot, use, launches, within=own.folder)
        controllers, spawned = selected.files, selected.names
        verdict = replace(verdict, observed=(*verdict.observed, *selected.problems))
    try:
        with World(surroundings(robot), lenient=True) as world:
            robot_model = put(world, robot, controllers)
            verdict = replace(
                verdict,
                loaded=True,
                controllers=tuple(each.name for each in controllers_of(world).started),
                controller_files=tuple(controllers),
                spawned=spawned,
            )
            held: set[str] = set()
            for found in _moved(verdict, world, robot_model, robot, standing, held=held):
                said = (each for each in world.diagnostics if not _is_unused(each, selected))
                verdict = replace(found, diagnostics=tuple(said))
        if _lies(verdict) or _is_stuck(verdict):
            verdict = _hung(verdict, robot, controllers)
        elif held:
            free = {each.joint: each for each in _hung(verdict, robot, controllers).reaches}
            verdict = replace(
                verdict,
                reaches=tuple(
                    free.get(each.joint, each) if each.joint in held else each
                    for each in verdict.reaches
                ),
            )
        alone = partial(_again, verdict, controllers)
        verdict = replace(verdict, hindered=hindered(verdict, robot, alone))
    except CartwheelError as error:
        verdict = replace(verdict, error=str(error), failure=error.diagnostic())
    findings = _Findings(
        partial(
            check,
            file,
            arguments=arguments,
            package_path=package_path,
            controller_files=controllers,
            launches=find,
            selected=selected,
        ),
        is_inside,
    )
    verdict = replace(verdict, movers=tuple(movers(verdict, whole)))
    return replace(verdict, faults=tuple(faults(verdict, whole, findings)))


def _for_simulation(
    robot: RobotDescription, file: Path, given: Mapping[str, str], package_path: Sequence[Path]
) -> RobotDescription | None:
    """A robot with the default arguments, if those of a launch file are for other programs.

    They are if the robot then has no plugins and no sensors. `given` contains the user's arguments.
    None if the robot has some, or cannot be read without the arguments of the launch file.
    """
    if has_devices(robot):
        return None
    try:
        return load_robot(file, arguments=given, package_path=package_path)
    except CartwheelError:
        return None


def _again(verdict: Verdict, controllers: Sequence[Path], robot: RobotDescription) -> Verdict:
    """The verdict on a robot with fewer plugins, perhaps without one that runs controllers."""
    controllers = controllers if is_controlled(robot) else ()
    start = replace(verdict, drives=(), reaches=(), spins=(), flights=())
    with World(surroundings(robot), lenient=True) as world:
        model = put(world, robot, controllers)
        *_, moved = _moved(start, world, model, robot, LISTENING, held=set())
    return moved


class _Findings:
    """The findings of `cartwheel check` in a robot, which is run when they are first needed."""

    def __init__(
        self, checked: Callable[[], Report], is_inside: Callable[[Origin | None], bool] | None
    ) -> None:
        self._is_inside = is_inside
        self._check = checked
        self._found: tuple[Diagnostic, ...] | None = None

    def __call__(self) -> tuple[Diagnostic, ...]:
        if self._found is None:
            try:
                found = self._check().findings
                inside = self._is_inside
                self._found = tuple(each for each in found if inside is None or inside(each.origin))
            except CartwheelError:
                # The description was loaded, so the reason is in a part that `check` reads only.
                self._found = ()
        return self._found


def _is_unused(said: Diagnostic, selected: Selection | None) -> bool:
    """Whether a diagnostic is about a controller that does not start, as in ROS, where no launch
    file starts it.
    """
    return (
        said.code is CONTROLLER_NOT_STARTED
        and selected is not None
        and any(map(moves, selected.used))
        and said.values.get("controller") not in selected.used
    )


def _described(verdict: Verdict, robot: RobotDescription) -> Verdict:
    """Results known without a world."""
    tags = robot.all_plugins
    names = list(dict.fromkeys(short_name(tag.filename) for tag in tags if refused(tag) is None))
    known = {name for name in names if plugin_named(name) or name in BUILT_IN}
    return replace(
        verdict,
        name=robot.name,
        mass=robot.mass,
        links=len(robot.links),
        plugins=tuple(name for name in names if name in known),
        missing=tuple(name for name in names if name not in known | WITHOUT_EFFECT),
        missing_meshes=sum(
            each.values.get("left_out") in ("visual", "collision") and each.severity == "error"
            for each in robot.diagnostics
        ),
        diagnostics=robot.diagnostics,
    )


def _moved(
    verdict: Verdict,
    world: World,
    model: Model,
    robot: RobotDescription,
    standing: float,
    *,
    held: set[str],
) -> Iterator[Verdict]:
    """The verdict after each part of the test, so that an error keeps earlier results.

    The joints that do not arrive because what they move touches the ground are added to `held`.
    """
    before = motion.positions(world, model)
    body = Robot(robot, None)
    stood = motion.stand(world, model, robot, standing)
    upright = model.pose if stood.state == "yes" else None
    started = controllers_of(world).started
    body.controlled = controlled_sides(body, started)
    given_up: list[Diagnostic] = []
    if not stood.fixed:
        moving = stood.state == "moves"
        given_up += gave_way(world, model, body, before, started, moving=moving)
    if stood.state in ("tips", "sinks"):
        given_up += sagging(model, body, started, weak_gains(robot, started))
    verdict = replace(
        verdict,
        stand=stood,
        driven=frozenset(driven(world, model)),
        observed=(*verdict.observed, *given_up),
    )
    yield verdict
    topics, silent = listened(world)
    verdict = replace(verdict, topics=topics, silent=silent)
    yield verdict
    if not stood.fixed:
        verdict = _driven(verdict, world, model, body, started)
        yield verdict
        verdict = replace(verdict, flights=tuple(flights(world, model, robot)))
        yield verdict
    if _lies(verdict):
        return
    moved = verdict
    for moved in _joints_moved(verdict, world, model, robot, held=held, upright=upright):
        yield moved
    pushes = (*thrusts(world, model, robot), *bursts(world, model, robot))
    yield replace(moved, spins=(*moved.spins, *pushes))


def _driven(
    verdict: Verdict, world: World, model: Model, body: Robot, started: list[Controller]
) -> Verdict:
    """Adds the drives, and what rests on the ground at rest or at the end of a failed drive."""
    robot = body.description
    resting: list[Diagnostic] = []
    seen: list[Diagnostic] = []
    drives: list[Drive] = []
    for drive in driving.drives(
        world,
        model,
        body,
        within_speeds(stated_limits(robot, started), body, started),
        started,
        idle=idle(world),
        steered=_steered(robot, started),
        look=lambda: resting.extend(dragging(world, model, body, started)),
    ):
        drives.append(drive)
        seen += resting if not drive.passes else ()
        resting.clear()
    verdict = replace(verdict, drives=tuple(drives))
    if all(drive.passes for drive in drives):
        return verdict
    world.run(LISTENING)
    # An arm in unstable balance falls only while the robot drives.
    seen = [*dragging(world, model, body, started), *seen]
    found = {(each.values["link"], each.values["joint"]): each for each in reversed(seen)}
    turns = min((abs(each.commanded_turn) for each in drives), default=0.0)
    weak = too_weak_to_turn(body, started, turns)
    apart = [*drives_apart(body, drives), *weak]
    return replace(verdict, observed=(*verdict.observed, *reversed(found.values()), *apart))


def _joints_moved(
    verdict: Verdict,
    world: World,
    model: Model,
    robot: RobotDescription,
    *,
    held: set[str],
    upright: Pose | None,
) -> Iterator[Verdict]:
    started = controllers_of(world).started
    gains = weak_gains(robot, started)
    reached = [*motion.reaches(world, model, robot, started, gains)]
    fell = [*toppled(model, Robot(robot, None), [each.joint for each in reached], upright)]
    reached += posed(world, model, robot)
    verdict = replace(verdict, reaches=tuple(reached))
    late = {each.joint for each in reached if not each.arrived}
    held |= late & blocked(world, model, Robot(robot, None)) if late else late
    springs = (
        *undamped(robot, started, late),
        *sagged(robot, started, gains, reached),
        *too_weak(robot, started, gains, sorted(late)),
    )
    verdict = replace(verdict, observed=tuple(dict.fromkeys((*verdict.observed, *fell, *springs))))
    yield verdict
    yield replace(verdict, spins=tuple(commands.spins(world, model, robot, started, gains)))


def _lies(verdict: Verdict) -> bool:
    """Whether a robot without wheels fell. It lies on its joints, which cannot move freely."""
    stand = verdict.stand
    return stand is not None and stand.state in ("tips", "sinks", "moves") and not verdict.drives


def _is_stuck(verdict: Verdict) -> bool:
    """Whether joints of a legged robot do not arrive, perhaps because its feet do not slide."""
    stand = verdict.stand
    free = stand is not None and not stand.fixed and not verdict.drives
    return free and not all(reach.arrived for reach in verdict.reaches)


def _hung(verdict: Verdict, robot: RobotDescription, controllers: Sequence[Path]) -> Verdict:
    """The verdict on a robot whose root is fixed above the ground while its joints are moved."""
    roots = {link.name for link in robot.links} - {joint.child for joint in robot.joints}
    hook = Joint(
        name="hung_from_world",
        type="fixed",
        parent="world",
        child=min(roots, default=robot.canonical_link),
        origin=robot.origin,
    )
    hung = replace(robot, joints=(*robot.joints, hook))
    with World("empty", lenient=True) as world:
        model = world.spawn(hung, name=name_in(world, robot), z=HIGH, controllers=controllers)
        # The controllers start with the simulation.
        world.run(LISTENING)
        *_, moved = _joints_moved(verdict, world, model, robot, held=set(), upright=None)
    return moved


def _steered(robot: RobotDescription, started: Sequence[Controller]) -> bool:
    """Whether one of the drives cannot turn in place."""
    names = [short_name(tag.filename) for tag in robot.plugins]
    return any(STEERED.search(name) for name in (*names, *(each.type for each in started)))
