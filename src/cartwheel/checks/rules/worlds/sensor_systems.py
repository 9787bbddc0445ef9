"""Sensors whose systems the worlds do not load in which gz-sim simulates a robot.

From gz-sim's SimulationRunner, server.config and example worlds: gz-sim loads its default systems
in a world without plugins, and from Ionic on in all worlds. None of them publishes what a sensor
measures. A system in a model acts on the whole world.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.sensor_ranges import sensors_of
from cartwheel.checks.subject import MOST_FOLDERS, Subject
from cartwheel.codes.devices import SENSOR_SYSTEM_MISSING
from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.files.regular_files import read_start
from cartwheel.description.launches import LaunchUse
from cartwheel.description.loading import load_world
from cartwheel.description.model import RobotDescription, Sensor, WorldDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.sensor_tags import CLASSES, RAYS_ON_CPU, SYSTEMS, is_of_gz
from cartwheel.errors import CartwheelError, Diagnostic

_STOCK: Mapping[str, frozenset[str]] = {
    "default.sdf": frozenset(),
    "empty.sdf": frozenset({"gz-sim-contact-system"}),
    "shapes.sdf": frozenset(),
}
"""Worlds of gz-sim, with their systems for sensors."""
_WITH_PLUGINS = frozenset({"empty.sdf"})
"""Those that contain plugins."""
_CONFIG = "server.config"
"""End of the names of files that contain other default systems."""
_VARIABLE = b"_SERVER_CONFIG_PATH"
"""End of the environment variable that names such a file."""
_BYTES = 100_000
"""Bytes of a file that are searched for a text."""
_REMOTE = ("http://", "https://")
_IGNITION = ("ign", "libign")
"""Beginnings of the file names of plugins in Fortress and before."""
_DEFAULTS = "gz-sim-physics-system, gz-sim-user-commands-system and gz-sim-scene-broadcaster-system"


@dataclass(frozen=True, kw_only=True, slots=True)
class _World:
    """A world of gz-sim, together with the robots in it."""

    name: str
    """The world as a launch file states it, or its name."""
    systems: frozenset[str]
    """Short names of the plugins that are loaded."""
    launch: Path | None = None
    """The launch file that starts the robot in the world; None if the world contains the robot."""
    is_stock: bool = False
    """Whether it is a world of gz-sim itself."""
    is_bare: bool = False
    """Whether it contains no plugins, so that gz-sim loads its default systems."""


@rule(SENSOR_SYSTEM_MISSING)
def sensor_system_missing(subject: Subject) -> Iterator[Diagnostic]:
    if not any(True for _ in sensors_of(subject)):
        return
    worlds = _gz_worlds(subject)
    written = _systems_written(subject) if worlds else frozenset()
    for robot in subject.robots if worlds else ():
        for system, types in SYSTEMS.items():
            sensors = [
                sensor
                for _, sensor in robot.sensors()
                if sensor.type in types and sensor.type not in RAYS_ON_CPU
            ]
            if sensors and not any(system in (*each.systems, *written) for each in worlds):
                yield _silent(subject, sensors, system, worlds[0])


def _silent(subject: Subject, sensors: Sequence[Sensor], system: str, world: _World) -> Diagnostic:
    """The finding that a world does not load the system for some sensors of one model."""
    distinct = tuple(dict.fromkeys(sensor.name for sensor in sensors))
    names = ", ".join(f'"{name}"' for name in distinct)
    where = f'the world "{world.name}"'
    if world.launch is not None:
        where += f", in which {xml.shown_path(world.launch)} starts the robot,"
    text = _plugin(subject, system)
    if world.launch is None:
        advice = f"Add {text} to the <world>."
    elif subject.is_urdf:
        advice = f"Add <gazebo>{text}</gazebo> to the robot"
    else:
        advice = f"Add {text} to the <model>"
    if world.launch is not None:
        advice += (
            ", or start another world." if world.is_stock else ", or the plugin to the <world>."
        )
    if world.is_bare and not world.is_stock:
        advice += (
            f" Before Ionic, a <world> with a plugin also needs {_DEFAULTS}, which gz-sim only "
            "loads by itself into a world without plugins."
        )
    several = len(distinct) > 1
    return SENSOR_SYSTEM_MISSING.diagnostic(
        f"the sensor{'s' * several} {names} publish{'' if several else 'es'} nothing in gz-sim: "
        f'{where} does not load "{system}"',
        origin=sensors[0].origin,
        hint=advice,
        values={
            "sensors": distinct,
            "system": system,
            "world": world.name,
        },
    )


def _plugin(subject: Subject, system: str) -> str:
    """The text that loads a system, with the names of the version that the robot is for."""
    files = [
        node.attributes.get("filename", "")
        for node in nodes.walk(subject.root)
        if node.tag == "plugin"
    ]
    file, space = system, "gz::sim"
    if any(each.startswith(_IGNITION) for each in files):
        file, space = system.replace("gz-sim", "ignition-gazebo", 1), "ignition::gazebo"
    return f'<plugin filename="{file}" name="{space}::systems::{CLASSES[system]}"/>'


def _gz_worlds(subject: Subject) -> list[_World]:
    """The worlds in which launch files start a robot in gz-sim, or the world that contains it.

    There are none if the author has other default systems. A launch file is left out if one of its
    worlds is unknown.
    """
    if isinstance(subject.read, WorldDescription):
        found = _itself(subject, subject.read)
    else:
        # Many launch files may start the same world.
        systems_of = cache(partial(_read, subject))
        uses = subject.own_launches.launches
        found = [each for use in uses for each in _started(subject, use, systems_of)]
    return [] if found and _has_own_defaults(subject) else found


def _systems_written(subject: Subject) -> frozenset[str]:
    """The plugins in the files of a robot, also those that its xacro leaves out."""
    return _plugins_in(
        node for tree in (subject.root, *subject.written) for node in nodes.walk(tree)
    )


def _itself(subject: Subject, read: WorldDescription) -> list[_World]:
    """The world that is checked, if it is one for gz-sim."""
    systems = {short_name(tag.filename) for tag in read.plugins} | _plugins_of(read.models)
    if not any(map(is_of_gz, systems)):
        return []
    file = Path(subject.files[0]).name
    spawned = (
        use.description
        for use in subject.own_launches.launches
        if any(Path(each).name == file for each in use.gz_worlds)
    )
    return [
        _World(
            name=read.name,
            systems=frozenset(systems) | _mentioned(spawned),
            is_bare=not read.plugins,
        )
    ]


def _started(
    subject: Subject, use: LaunchUse, systems_of: Callable[[Path], frozenset[str] | None]
) -> list[_World]:
    """The worlds of a launch file that starts the robot in gz-sim; none if one is unknown.

    `systems_of` returns the plugins in the file of a world; None if it cannot be read.
    """
    file = Path(subject.files[0]).resolve()
    if use.description is None or use.description.resolve() != file or "gz" not in use.gazebos:
        return []
    others = (each.description for each in subject.own_launches.launches if each.file == use.file)
    beside = _mentioned(each for each in others if each != use.description)
    worlds = []
    for stated in use.gz_worlds:
        files = list(_files(subject, stated))
        read = [systems_of(each) for each in files]
        if stated not in _STOCK and (not read or None in read):
            return []
        known = [each for each in read if each is not None]
        worlds.append(
            _World(
                name=xml.shown_path(Path(stated)) if Path(stated).is_absolute() else stated,
                systems=beside.union(_STOCK.get(stated, ()), *known),
                launch=use.file,
                is_stock=not files,
                is_bare=not any(known) if files else stated not in _WITH_PLUGINS,
            )
        )
    return worlds


def _files(subject: Subject, world: str) -> Iterator[Path]:
    """The files that may be a world as a launch file states it."""
    path = Path(world)
    if path.is_absolute():
        yield path
        return
    for folder, names in subject.own_folders:
        if path.name in names and (folder / path.name).match(world):
            yield folder / path.name


def _read(subject: Subject, path: Path) -> frozenset[str] | None:
    """The plugins of a world and of the models that it includes; None if it cannot be read."""
    root = xml.readable_file(path)
    if root is None or not nodes.children(root, "world"):
        return None
    found = _plugins_in(nodes.walk(root))
    uris = [nodes.text_of(node, "uri") for node in nodes.walk(root) if node.tag == "include"]
    if all(uri.startswith(_REMOTE) for uri in uris):
        return found
    try:
        world = load_world(path, package_path=subject.packages.package_path)
    except CartwheelError:
        return None
    return found | _plugins_of(world.models)


def _plugins_in(found: Iterable[Node]) -> frozenset[str]:
    """The short names of the plugins among some elements.

    A name of a plugin may also state the class of a system.
    """
    names = set()
    for node in found:
        if node.tag == "plugin":
            names.add(short_name(node.attributes.get("filename", "")))
            last = node.attributes.get("name", "").rpartition("::")[2]
            names |= {system for system, name in CLASSES.items() if name == last}
    return frozenset(names - {""})


def _plugins_of(models: Iterable[RobotDescription]) -> frozenset[str]:
    """The short names of the plugins of models and of their sensors."""
    return frozenset(short_name(tag.filename) for model in models for tag in model.all_plugins)


def _mentioned(descriptions: Iterable[Path | None]) -> frozenset[str]:
    """The systems whose names are in the texts of descriptions."""
    found = set()
    for path in {each for each in descriptions if each is not None}:
        try:
            text = read_start(path, _BYTES)
        except OSError:
            continue
        found |= {name for name in CLASSES if name.removeprefix("gz-sim").encode() in text}
    return frozenset(found)


def _has_own_defaults(subject: Subject) -> bool:
    """Whether the author of a robot may have default systems other than gz-sim's.

    It may be in one of the folders that are not searched, if there are too many.
    """
    own = subject.own_launches
    for file in {each.file for each in own.launches}:
        try:
            if _VARIABLE in read_start(file, _BYTES):
                return True
        except OSError:
            continue
    folders = subject.own_folders
    return len(folders) == MOST_FOLDERS or any(
        name.endswith(_CONFIG) for _, names in folders for name in names
    )
