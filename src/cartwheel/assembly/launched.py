"""The models and the world of a launch file, read without ROS and without executing it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from cartwheel.codes import files as codes
from cartwheel.codes.world import MODEL_NAME_TAKEN
from cartwheel.control.place import placed
from cartwheel.description import load_robot, load_world
from cartwheel.description.files.named_files import bundled_worlds
from cartwheel.description.launches import LaunchedModel, LaunchStart, LaunchUse, read_launch
from cartwheel.description.launches.bridging import RenamedTopic
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.ros_control.selection import published_by
from cartwheel.errors import DescriptionError, Diagnostic, Origin
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
    for each in spawned:
        # Several models may have the same description.
        key = (each.description, frozenset(each.use.arguments.items()))
        if key not in robots:
            robots[key] = load_robot(
                each.description, arguments=each.use.arguments, package_path=package_path
            )
        model = _start(each, robots[key])
        name = model.name or model.description.name
        if name not in names:
            names.add(name)
            models.append(model)
        elif not each.is_shown:
            found.append(_refused(start.file, name))
    return Launched(
        world=opened,
        models=tuple(models),
        bridges=(*start.bridges, *map(_bridged, start.renamed)),
        file=file,
        diagnostics=tuple(found),
    )


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
        return [
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


def _world(
    start: LaunchStart, package_path: Sequence[Path], found: list[Diagnostic]
) -> WorldDescription:
    """The world that the launch file states; a bundled one, if there is none of that name.

    A launch file that starts nothing but a world requires it.
    """
    stated = start.world or EMPTY
    try:
        return load_world(stated, package_path=package_path)
    except DescriptionError as error:
        if error.code not in (codes.FILE_MISSING, codes.FILE_ON_NETWORK) or not start.models:
            raise
    name = Path(stated).stem
    if name not in bundled_worlds():
        name = EMPTY
        found.append(
            codes.LAUNCH_WORLD_ABSENT.diagnostic(
                f'the world "{stated}" was not found, and the empty world is used',
                origin=Origin(file=str(start.file)),
                values={"name": stated},
                hint=f"Pass a world: {WORLD.given('FILE')}.",
            )
        )
    return load_world(name)


def _start(model: LaunchedModel, robot: RobotDescription) -> Start:
    spawn = model.spawn
    return Start(
        description=robot,
        name=spawn.name or None,
        pose=placed(robot.pose, spawn.place),
        namespace=spawn.namespace or "/",
        controllers=model.use,
    )
