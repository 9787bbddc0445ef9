"""The controllers that a robot's own package starts, by its launch files and YAML files.

Gazebo's controller managers read ``<transmission>`` and ``<ros2_control>`` from the parameter
``robot_description``. For an SDF model, it contains the URDF from which ``gz sdf -p`` made the
model, without these elements.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cartwheel.codes.devices import CONTROL_ELSEWHERE
from cartwheel.description import load_robot
from cartwheel.description.launches import (
    LaunchUse,
    chosen,
    controllers_for,
    launches_near,
    moves,
    root_of,
    shared_parts,
    starters,
    unread,
)
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.dialects.ros_control.files import for_robot, read_parameters
from cartwheel.dialects.ros_control.launched.names import (
    as_named,
    last_names,
    named_in,
    node_arguments,
    used_names,
)
from cartwheel.dialects.ros_control.launched.problems import (
    misplaced,
    misplaced_names,
    of_other_managers,
    only_loaded,
    unfound,
    unmanaged_in_ros2,
    unreadable,
)
from cartwheel.dialects.ros_control.launched.untyped import unloadable
from cartwheel.dialects.ros_control.suggestion import (
    commanding,
    is_controlled,
    is_of_ros1,
    lacks_controllers,
    starter_of,
    suggested,
)
from cartwheel.errors import CartwheelError, Diagnostic, PluginError

_SUFFIXES = frozenset({".sdf", ".world"})
"""Ends of the names of SDF files, which another one may follow, as in ``arena.world.xacro``."""
_MOST = 8
"""Maximum number of launch files that are considered."""
_MOST_LENT = 100
"""Maximum number of other launch files' controller files that are read."""
_FOLDERS = (".", "urdf", "../urdf")
"""Folders beside an SDF model in which its URDF may be."""
_ENDS = (".urdf", ".xacro", ".urdf.xacro")


@dataclass(frozen=True, kw_only=True, slots=True)
class Selection:
    """Controller files, and the controllers in them that are started."""

    files: tuple[Path, ...]
    """YAML files with controllers for the robot."""
    names: tuple[str, ...]
    """Names of the controllers that the launch file starts; empty: all."""
    idle: tuple[str, ...] = ()
    """Names of those that the launch file loads, but does not start."""
    arguments: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Names of controllers, with the ROS arguments that the launch file gives to their nodes."""
    problems: tuple[Diagnostic, ...] = ()
    """Why files of these controllers cannot be read, and which controllers are not started."""
    launch: Path | None = None
    """The launch file that starts the controllers."""
    loaded: tuple[Path, ...] = ()
    """All YAML files that it loads."""
    used: frozenset[str] = frozenset()
    """Names of the controllers that launch files of the robot start or load, if all are known."""
    idle_launch: Path | None = None
    """The launch file that starts the robot in Gazebo, if none starts or loads what may move it."""


def selection_near(robot: RobotDescription, package_path: Sequence[Path] = ()) -> Selection:
    """The controllers that the launch files in the robot's package start, or those near it.

    Empty if the robot has no controller manager, or if its tags name the files.

    Args:
        robot: The robot.
        package_path: Folders to search for packages first.
    """
    if not is_controlled(robot):
        return Selection(files=(), names=())
    file = Path(robot.origin.file)
    folder = root_of(file)
    launches = () if folder is None else launches_near(folder, package_path)
    use = chosen(file, launches)
    starter = starter_of(robot, use, launches)
    # The user need not start this launch file, and here, the controllers work.
    found = selection(robot, use, launches, tolerant=True) if lacks_controllers(robot) else None
    if found is None or not found.files:
        problems = (*unfound(starter), *unloadable(robot, starter), *only_loaded(starter))
        idle = () if starter is None else as_named(starter.loaded, ())
        arguments = () if starter is None else starter.node_arguments
        known = starter is not None and not starter.unsure and any(map(moves, starter.spawned))
        names = as_named(starter.spawned, ()) if starter is not None and known else ()
        found = Selection(files=(), names=names, idle=idle, arguments=arguments, problems=problems)
    return replace(found, problems=(*found.problems, *unread(launches)))


def launched(robot: RobotDescription) -> tuple[str, ...]:
    """Names of the controllers that the launch files in the robot's package start."""
    file = Path(robot.origin.file)
    folder = root_of(file)
    launches = () if folder is None else launches_near(folder)
    starter = starter_of(robot, chosen(file, launches), launches)
    if starter is None:
        return ()
    # A name may contain a part of the namespace.
    return tuple(dict.fromkeys((*starter.spawned, *as_named(starter.spawned, ()))))


def selection(
    robot: RobotDescription,
    use: LaunchUse | None,
    launches: Sequence[LaunchUse],
    *,
    within: Path | None = None,
    tolerant: bool = False,
) -> Selection:
    """As `selection_near`, with launch files that have been read.

    Files that need values from a launch file are left out.

    Args:
        robot: The robot.
        use: The launch file that starts the robot; None if there is none.
        launches: All launch files near the robot.
        within: A folder; files outside of it that no launch file names are not used.
        tolerant: Whether controllers start in another namespace than that of their parameters.
    """
    starter = controllers_for(Path(robot.origin.file), use, launches)
    started = any(each.spawned for each in _about(robot, launches))
    among = () if starter is None else starter.controllers
    named = suggested(robot, among=among, started=started)
    if starter is not use and not commanding(robot, named):
        # The launch file of another part only publishes the states of all joints.
        starter, named = None, []
    spawner = starter or use
    if spawner is not None and is_of_ros1(robot):
        lent = _lent(robot, spawner, launches, named)
        if commanding(robot, lent):
            starter, named = spawner, [*named, *lent]
    near = [] if named else suggested(robot, within=within)
    if starter is None and (use is None or not use.spawned) and not near:
        for each in starters(Path(robot.origin.file), launches, described=True)[:_MOST]:
            found = suggested(robot, among=each.controllers)
            if commanding(robot, found):
                starter, named = each, found
                break
    files = tuple(each for each in named or near if _is_complete(each, robot))
    names = starter.spawned if starter is not None and (named or not files) else ()
    if not files and not names and is_controlled(robot) and not lacks_controllers(robot):
        # The robot's own tags name the files.
        own = starter_of(robot, use, launches)
        names = () if own is None else own.spawned
    starting = starter or starter_of(robot, use, launches)
    others = of_other_managers(robot, starting, launches)
    if starting is not None and others:
        starting = replace(
            starting, spawned=tuple(name for name in starting.spawned if name not in others)
        )
        names = tuple(name for name in names if name not in others)
    names = named_in(names, files, robot)
    lost = unreadable(starter.controllers, names) if starter is not None else ()
    reported = unloadable(robot, starting, within) if is_controlled(robot) else ()
    idle = () if starting is None else named_in(starting.loaded, files, robot)
    elsewhere = misplaced if is_of_ros1(robot) else unmanaged_in_ros2
    apart = tuple(elsewhere(robot, starting, launches)) if is_controlled(robot) else ()
    if apart and not tolerant:
        wrong = named_in(itertools.chain(*map(misplaced_names, apart)), files, robot)
        names = tuple(name for name in names if name not in wrong)
        files = files if names else ()
    used = used_names(launches, _about(robot, launches), files, robot)
    unmoved = use is not None and use.simulated and used is not None and not any(map(moves, used))
    missing = unfound(starting) if is_of_ros1(robot) else ()
    problems = (*lost, *missing, *reported, *apart, *only_loaded(starting))
    return Selection(
        files=files,
        names=names,
        idle=idle,
        arguments=node_arguments(starting, files, robot),
        problems=problems,
        launch=None if starting is None else starting.file,
        loaded=() if starting is None else starting.controllers,
        used=used or frozenset(),
        idle_launch=use.file if unmoved and use is not None else None,
    )


def _lent(
    robot: RobotDescription,
    spawner: LaunchUse,
    launches: Sequence[LaunchUse],
    own: Sequence[Path],
) -> list[Path]:
    """The files with controllers that a launch file starts and whose parameters others load.

    In ROS 1, all launch files set parameters of the same server.

    Args:
        robot: The robot.
        spawner: The launch file.
        launches: All launch files near the robot. Those that load another description are for
            another robot.
        own: The files that it loads itself.
    """
    missing = {name.rpartition("/")[2] for name in spawner.spawned}
    missing -= frozenset[str]().union(*(last_names(path, robot) for path in own))
    if not missing:
        return []
    others = dict.fromkeys(
        path for each in _about(robot, launches) for path in each.controllers if path not in own
    )
    fitting = suggested(robot, among=[*itertools.islice(others, _MOST_LENT)])
    return [path for path in fitting if missing & last_names(path, robot)]


def _about(robot: RobotDescription, launches: Sequence[LaunchUse]) -> Iterator[LaunchUse]:
    """The launch files that load a robot's description, or none."""
    file = Path(robot.origin.file).resolve()
    for each in launches:
        if each.description is None or each.description.resolve() == file:
            yield each


def _is_complete(path: Path, robot: RobotDescription) -> bool:
    """Whether a controller file contains no arguments that only a launch file could set."""
    try:
        for_robot(read_parameters(path), path, robot)
    except PluginError:
        return False
    return True


def with_published_control(
    robot: RobotDescription,
    launches: Sequence[LaunchUse] | None = None,
    package_path: Sequence[Path] = (),
) -> RobotDescription:
    """An SDF model with the hardware of the URDF from which it was made; otherwise the same robot.

    The URDF is one that a launch file names, first one in the launch file that spawns the model or
    starts its world, or that spawns a model of this name, as in a world that was saved; or it has
    the name of the model or of its folder and is beside it. Its hardware must list only joints of
    the model.

    Args:
        robot: The robot.
        launches: Contents of launch files; None for those near the robot.
        package_path: Folders to search for packages first.
    """
    file = Path(robot.origin.file)
    if not _lacks_hardware(robot):
        return robot
    if launches is None:
        folder = root_of(file)
        launches = () if folder is None else launches_near(folder, package_path)
    seen: set[Path] = set()
    for path, arguments in _candidates(robot, file, launches):
        if path.resolve() not in seen:
            seen.add(path.resolve())
            found = _with_hardware_of(robot, path, arguments, package_path)
            if found is not None:
                return found
    return robot


def world_with_published_control(
    world: WorldDescription, package_path: Sequence[Path] = ()
) -> WorldDescription:
    """A world whose models have the hardware of their URDF; see `with_published_control`."""

    @functools.cache
    def near(folder: Path) -> Sequence[LaunchUse]:
        return launches_near(folder, package_path)

    def launches(robot: RobotDescription) -> Sequence[LaunchUse]:
        folder = root_of(Path(robot.origin.file)) if _lacks_hardware(robot) else None
        return () if folder is None else near(folder)

    models = tuple(
        with_published_control(each, launches(each), package_path) for each in world.models
    )
    if all(one is other for one, other in zip(models, world.models, strict=True)):
        return world
    return replace(world, models=models)


def published_by(
    robot: RobotDescription, use: LaunchUse, package_path: Sequence[Path] = ()
) -> RobotDescription | None:
    """A model of a launch file's world for which it publishes a description, with its hardware.

    None if the model has no controller manager, or if the description is that of another model.

    Args:
        robot: A model of the world.
        use: The launch file, with a description that it does not spawn.
        package_path: Folders to search for packages first.
    """
    if use.description is None or not is_controlled(robot):
        return None
    if _lacks_hardware(robot):
        return _with_hardware_of(robot, use.description, dict(use.arguments), package_path)
    return robot if use.description.name.split(".")[0] == robot.name else None


def _lacks_hardware(robot: RobotDescription) -> bool:
    """Whether an SDF model has a controller manager, but lists no joints for it."""
    if robot.ros2_control or robot.transmissions:
        return False
    return not _SUFFIXES.isdisjoint(Path(robot.origin.file).suffixes) and is_controlled(robot)


def _with_hardware_of(
    robot: RobotDescription, path: Path, arguments: dict[str, str], package_path: Sequence[Path]
) -> RobotDescription | None:
    """A model with the hardware of another description; None if this is that of another robot."""
    try:
        other = load_robot(path, arguments=arguments, package_path=package_path)
    except CartwheelError:
        return None
    joints = {joint.name for joint in robot.joints if joint.type != "fixed"}
    names = {
        (joint.attribute("name") or "").strip()
        for held in (*other.ros2_control, *other.transmissions)
        for joint in held.find_all("joint")
    }
    if not names or not names <= joints:
        return None
    note = CONTROL_ELSEWHERE.diagnostic(
        f'controllers command the joints that "{path.name}" lists, because Gazebo reads '
        "them from the parameter robot_description, not from the SDF",
        origin=robot.origin,
        values={"file": str(path), "joints": tuple(sorted(names))},
    )
    return replace(
        robot,
        ros2_control=other.ros2_control,
        transmissions=other.transmissions,
        diagnostics=(*robot.diagnostics, note),
    )


def _candidates(
    robot: RobotDescription, file: Path, launches: Sequence[LaunchUse]
) -> Iterator[tuple[Path, dict[str, str]]]:
    """Descriptions that may be the published one, with arguments; the most likely ones first."""
    own = {
        each.file
        for each in launches
        if (each.description is not None and each.description.resolve() == file.resolve())
        or (each.world and Path(each.world).name == file.name)
    }
    others = [
        each
        for each in launches
        if each.description is not None
        and _SUFFIXES.isdisjoint(each.description.suffixes)
        and not each.guessed
    ]
    named = [
        (each.description, each)
        for each in others
        if each.description is not None
        and (
            each.file in own
            or robot.name in each.models
            or each.description.name.split(".")[0] == robot.name
        )
    ]
    named.sort(key=lambda pair: (pair[1].file not in own, -shared_parts(pair[1].file, file)))
    for path, each in named[:_MOST]:
        yield path, dict(each.arguments)
    names = dict.fromkeys((robot.name, file.stem, file.absolute().parent.name))
    for folder, name, end in itertools.product(_FOLDERS, names, _ENDS):
        path = file.parent / folder / f"{name}{end}"
        if "/" not in name and path.is_file():
            yield path, {}
