"""The models and the world of a launch file, read without ROS and without executing it."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from cartwheel.codes import files as codes
from cartwheel.codes.graph import ENTITY_UNKNOWN
from cartwheel.codes.world import MODEL_NAME_TAKEN
from cartwheel.control.place import placed
from cartwheel.description import load_robot, load_world
from cartwheel.description.files.named_files import bundled_worlds
from cartwheel.description.kinematics import link_poses
from cartwheel.description.launches import LaunchedModel, LaunchStart, LaunchUse, read_launch
from cartwheel.description.launches.bridging import RenamedTopic
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.dialects.gz.bridge_file import Bridge, gz_topic, read_bridge
from cartwheel.dialects.ros_control.selection import published_by
from cartwheel.errors import CartwheelError, DescriptionError, Diagnostic, Origin
from cartwheel.gazebo.entities import INERTIAL
from cartwheel.gazebo.state import bounded
from cartwheel.geometry import Pose
from cartwheel.graph.renaming import Bridged
from cartwheel.messages import type_name
from cartwheel.options import WORLD

if TYPE_CHECKING:
    from cartwheel.session import Session

EMPTY = "empty"
"""The world if none is stated."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Start:
    """A model to spawn."""

    description: RobotDescription
    name: str | None = None
    """None for the name in the description."""
    pose: Pose | None = None
    """None for the pose in the description."""
    namespace: str = "/"
    controllers: LaunchUse | Sequence[Path] | Literal["auto"] = ()
    """As for `Session.spawn`."""
    joints: Mapping[str, float] = field(default_factory=dict)
    """Positions of joints with which it starts, rad or m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Launched:
    """The beginning of a simulation."""

    world: WorldDescription
    models: tuple[Start, ...] = ()
    """The models to spawn in it."""
    bridges: tuple[Path | Bridged, ...] = ()
    """Configuration files of ros_gz_bridge, and topics in its arguments."""
    file: Path | None = None
    """The launch file, if there is one."""
    diagnostics: tuple[Diagnostic, ...] = ()
    """What of a launch file is not as it states."""


def open_launch(
    file: Path,
    arguments: Mapping[str, str],
    *,
    world: str | None = None,
    package_path: Sequence[Path] = (),
) -> Launched:
    """Reads the world and the models of a launch file.

    Args:
        file: The launch file.
        arguments: Its arguments.
        world: The world instead of its own.
        package_path: Folders to search for packages first.

    Raises:
        DescriptionError: A description cannot be read, or is known only when the launch file is
            executed.
    """
    start = read_launch(file, arguments, package_path)
    found = list(start.diagnostics)
    if world is not None:
        found = [each for each in found if each.values.get("what") != "world"]
    if world:
        opened = load_world(world, package_path=package_path)
    else:
        opened = _world(start, package_path, found)
    shown = [each for each in start.models if each.is_shown]
    opened, models = _out_of_world(opened, shown, package_path)
    names = {each.name for each in (*opened.models, *(each.description for each in models))}
    robots: dict[object, RobotDescription] = {}
    spawned = [each for each in start.models if not each.is_shown]
    if not spawned and not models:
        # Of those that are only published, one is shown where there is no other model.
        spawned = shown[:1]
    placed_last = sorted(spawned, key=lambda each: each.spawn.frame not in INERTIAL)
    for each in placed_last:
        # Several models may have the same description.
        key = (each.description, frozenset(each.use.arguments.items()))
        if key not in robots:
            robots[key] = load_robot(
                each.description, arguments=each.use.arguments, package_path=package_path
            )
        model = _start(each, robots[key])
        name = model.name or model.description.name
        if name in names and each.spawn.renames:
            numbered = (f"{name}_{number}" for number in itertools.count())
            name = next(one for one in numbered if one not in names)
            model = replace(model, name=name)
        if name not in names:
            frame = _frame(each.spawn.frame, opened, models)
            if frame is None:
                found.append(_astray(start.file, name, each.spawn.frame))
                continue
            if each.spawn.frame not in INERTIAL:
                model = replace(model, pose=frame @ (model.pose or model.description.pose))
            own = {joint.removeprefix(f"{name}::"): value for joint, value in model.joints.items()}
            model = replace(model, joints=own)
            names.add(name)
            models.append(model)
            found += _without_joints(start.file, name, model)
        elif not each.is_shown:
            found.append(_refused(start.file, name))
    bridges: tuple[Bridge, ...] = (*_readable(start.bridges, found), *map(_bridged, start.renamed))
    return Launched(
        world=opened,
        models=tuple(models),
        bridges=bridges,
        file=file,
        diagnostics=tuple(found),
    )


def _readable(bridges: Sequence[Path], found: list[Diagnostic]) -> Iterator[Path]:
    """The configuration files of a bridge without those that are invalid, which are reported.

    The launch file may pass a copy in which it has replaced parts of the text.
    """
    for path in bridges:
        try:
            read_bridge(path)
        except CartwheelError as error:
            found.append(error.diagnostic("warning"))
        else:
            yield path


def _bridged(topic: RenamedTopic) -> Bridged:
    origin = Origin(file=str(topic.file))
    return Bridged(gz=gz_topic(topic.gz), ros=topic.ros, type=type_name(topic.type), origin=origin)


def _out_of_world(
    world: WorldDescription, shown: Sequence[LaunchedModel], package_path: Sequence[Path]
) -> tuple[WorldDescription, list[Start]]:
    """Spawns the models of the world that have a controller manager, with their controllers.

    The launch file publishes their description for the controller manager and does not spawn it.

    Args:
        world: The world of the launch file.
        shown: The descriptions that the launch file publishes, but does not spawn.
        package_path: Folders to search for packages first.

    Returns:
        The world without these models, and the models.
    """
    found: dict[str, Start] = {}
    for model in world.models:
        for each in shown:
            robot = published_by(model, each.use, package_path)
            if robot is not None:
                found[model.name] = Start(description=robot, namespace="", controllers=each.use)
                break
    if not found:
        return world, []
    rest = tuple(each for each in world.models if each.name not in found)
    return replace(world, models=rest), list(found.values())


def _frame(name: str, world: WorldDescription, models: Sequence[Start]) -> Pose | None:
    """The pose of a model or link in the world; None if there is none of this name.

    Args:
        name: A name in `INERTIAL`, that of a model, or ``MODEL::LINK``.
        world: The world.
        models: The models that are spawned in it.
    """
    if name in INERTIAL:
        return Pose()
    wanted, _, link = name.partition("::")
    known = [Start(description=each, name=each.name, pose=each.pose) for each in world.models]
    for each in (*known, *models):
        if (each.name or each.description.name) == wanted:
            pose = each.pose or each.description.pose
            if not link:
                return pose
            inside = link_poses(each.description, each.joints).get(link)
            return None if inside is None else pose @ inside
    return None


def _astray(file: Path, name: str, frame: str) -> Diagnostic:
    """What Gazebo does with a model whose reference frame does not exist."""
    return ENTITY_UNKNOWN.diagnostic(
        f'the reference frame "{frame}" does not exist, so the model "{name}" is not spawned, as '
        "in Gazebo",
        severity="warning",
        origin=Origin(file=str(file)),
        values={"name": frame, "model": name},
    )


def _without_joints(file: Path, name: str, model: Start) -> list[Diagnostic]:
    """The joints whose positions are stated, although the model does not have them."""
    return [
        ENTITY_UNKNOWN.diagnostic(
            f'the model "{name}" has no joint "{joint}", so its position has no effect',
            severity="warning",
            origin=Origin(file=str(file)),
            values={"name": joint, "model": name},
        )
        for joint in model.joints
        if model.description.joint(joint) is None
    ]


def _refused(file: Path, name: str) -> Diagnostic:
    """What Gazebo does with a model whose name another one has."""
    return MODEL_NAME_TAKEN.diagnostic(
        f'a model named "{name}" is already in the world, so another one is not spawned, as in '
        "Gazebo",
        severity="warning",
        origin=Origin(file=str(file)),
        values={"name": name},
    )


def spawn_all(session: Session, launched: Launched, package_path: Sequence[Path] = ()) -> list[str]:
    """Spawns the models and reports the diagnostics; returns the names of the models.

    Args:
        session: A session with the world.
        launched: The beginning of the simulation.
        package_path: Folders to search for packages first.
    """
    with session.spawning():
        for each in launched.diagnostics:
            session.simulation.engine.report(each)
        names = [
            session.spawn(
                each.description,
                name=each.name,
                pose=each.pose,
                namespace=each.namespace,
                controllers=each.controllers,
                package_path=package_path,
            )
            for each in launched.models
        ]
    for name, model in zip(names, launched.models, strict=True):
        positions = {
            joint.name: bounded(joint, model.joints[joint.name])
            for joint in model.description.joints
            if joint.name in model.joints and joint.type != "fixed"
        }
        if positions:
            session.simulation.set_joint_positions(name, positions)
    return names


def _world(
    start: LaunchStart, package_path: Sequence[Path], found: list[Diagnostic]
) -> WorldDescription:
    """The world that the launch file states; a bundled one, if there is none of that name.

    A launch file that starts nothing but a world requires it. gz-sim's own ``empty.sdf`` and
    ``shapes.sdf`` call their worlds ``empty`` and ``shapes``, while those of Gazebo Classic, as the
    bundled ones, are all called ``default``.
    """
    stated = start.world or EMPTY
    try:
        return load_world(stated, package_path=package_path)
    except DescriptionError as error:
        if error.code not in (codes.FILE_MISSING, codes.FILE_ON_NETWORK) or not start.models:
            raise
    name = Path(stated).stem
    if name in bundled_worlds():
        world = load_world(name)
        return replace(world, name=name) if stated.endswith(".sdf") else world
    found.append(
        codes.LAUNCH_WORLD_ABSENT.diagnostic(
            f'the world "{stated}" was not found, and the empty world is used',
            origin=Origin(file=str(start.file)),
            values={"name": stated},
            hint=f"Pass a world: {WORLD.given('FILE')}.",
        )
    )
    return load_world(EMPTY)


def _start(model: LaunchedModel, robot: RobotDescription) -> Start:
    spawn = model.spawn
    return Start(
        description=robot,
        name=spawn.name or None,
        pose=placed(robot.pose, spawn.place),
        namespace=spawn.namespace or "/",
        controllers=model.use,
        joints=spawn.joints,
    )
