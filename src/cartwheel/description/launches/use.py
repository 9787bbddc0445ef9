"""What is collected while a launch file is read.

The file is long because all of it fills one object.
"""

from __future__ import annotations

import contextlib
import os
import re
import shlex
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

from cartwheel.description.files.package_folders import is_file, package_above, package_name
from cartwheel.description.launches import variants
from cartwheel.description.launches.bridging import BRIDGES, RenamedTopic, renamed_topics
from cartwheel.description.launches.controllers import (
    ControllerCommand,
    by_command,
    by_service,
    by_spawner,
    shell_commands,
)
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.gazebos import Gazebos
from cartwheel.description.launches.launch_use import Missing, MissingFile, Unfound
from cartwheel.description.launches.python_variables import Place, Uncertain
from cartwheel.description.launches.spawning import (
    MODEL_SPAWNERS,
    Spawn,
    resolved,
    spawn_of,
    spawns,
    split,
    world_in,
)
from cartwheel.errors import Diagnostic, Origin

ABSENT = -1
"""The number of a description that was not found."""
_GAZEBO = frozenset({"gazebo_ros", "ros_gz_sim", "ros_ign_gazebo", "ros_gz"})
"""Packages with nodes that start Gazebo or spawn models."""
_LOOK = 100
"""Steps of a look at a file or folder."""
DEEPEST = 6
"""Maximum nesting of included launch files."""
_YAMLS = (".yaml", ".yml")
_SPAWNERS = MODEL_SPAWNERS | {"gzserver", "gzclient", "gz_sim", "gazebo"}
_SERVERS = frozenset({"gazebo", "gzserver", "gz", "ign"})
"""Commands that start Gazebo."""
_WORLD = re.compile(r"gazebo|gz_|empty_world|ignition")
_STARTERS: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("gazebo_ros", "empty_world.launch"): ("world_name",),
    ("gazebo_ros", "gazebo.launch.py"): ("world",),
    ("gazebo_ros", "gzserver.launch.py"): ("world",),
    ("ros_gz_sim", "gz_sim.launch.py"): ("gz_args",),
    ("ros_gz_sim", "gz_server.launch.py"): ("world_sdf_file",),
    ("ros_ign_gazebo", "ign_gazebo.launch.py"): ("ign_args", "gz_args"),
}
"""The arguments that name the world, of the launch files of these packages that start Gazebo."""
_PRINTING = frozenset({"xacro", "xacro.py", "cat"})
"""Commands that fail if their file does not exist."""
_CONTROLLER_SPAWNERS = frozenset({"spawner", "spawner.py", "controller_manager"})
_HARDWARE = re.compile(r"control_node|ros2?_control|hardware|driver|(?<![a-z])hw(?![a-z])")
"""Parts of the names of programs that may run a controller manager outside of Gazebo."""


@dataclass(kw_only=True)
class Facts:
    """The contents of a launch file and its included files, collected while they are read."""

    find: Callable[[str], Path | None]
    """Returns the folder of a package."""
    home: Path | None = None
    """The package of the launch file, which stands for packages that are not found: many launch
    files were copied from another package."""
    read: Callable[[Path, Mapping[str, str], Facts, int], None]
    """Reads an included launch file with arguments, at a depth."""
    effort: Effort
    """The remaining effort."""
    file: Path = Path()
    """The launch file that is read."""
    descriptions: list[tuple[Path, dict[str, str]]] = field(default_factory=list)
    words: dict[Path, str] = field(default_factory=dict)
    """What stands for the unknown part of the name of a description."""
    plain: dict[int, Origin] = field(default_factory=dict)
    """Where those are stated whose text is not expanded, by their numbers."""
    raw: set[int] = field(default_factory=set)
    """The numbers of those that a spawner reads from their files."""
    absent: dict[str, None] = field(default_factory=dict)
    """Files and packages that are stated, but were not found, in their order."""
    published: dict[str, int] = field(default_factory=dict)
    """The number of a description, by the parameter or topic that contains it; `ABSENT` if it was
    not found."""
    unread: dict[str, Callable[[], int | None]] = field(default_factory=dict)
    """What adds the contents of a parameter that contains a description if a spawner names it."""
    namespace: str = ""
    """The namespace of the group that is being read."""
    yamls: list[tuple[str, Path]] = field(default_factory=list)
    """Files with parameters of controllers, with the namespaces into which they are loaded."""
    places: list[tuple[str, Path]] = field(default_factory=list)
    """The same files, with the namespace `UNKNOWN` if it is uncertain."""
    sought: list[tuple[str, str]] = field(default_factory=list)
    """See `LaunchUse.sought`."""
    sought_in_ros2: list[tuple[str, str]] = field(default_factory=list)
    """See `LaunchUse.sought_in_ros2`."""
    programs: dict[tuple[str, str], None] = field(default_factory=dict)
    """See `LaunchUse.programs`."""
    managers: dict[str, bool] = field(default_factory=dict)
    """See `LaunchUse.managers`, each with whether it is certainly started."""
    spawning: bool = False
    """Whether a node spawns a model, also one of another package with the arguments of gazebo_ros's
    spawner."""
    partial: bool = False
    """Whether it includes launch files that were not found, apart from those of Gazebo, or starts a
    program that may be a controller manager by its name."""
    lost: list[Path] = field(default_factory=list)
    """Such files that do not exist."""
    unfound: list[Unfound] = field(default_factory=list)
    """See `LaunchUse.unfound`."""
    foreign: dict[Path, None] = field(default_factory=dict)
    """See `LaunchUse.foreign`."""
    spawned: list[tuple[str, str]] = field(default_factory=list)
    """Controllers that are started, with the namespaces of their managers."""
    loaded: list[tuple[str, str]] = field(default_factory=list)
    """Those that are loaded, but not started by the same command."""
    arguments: list[tuple[str, tuple[str, tuple[str, ...]]]] = field(default_factory=list)
    """The namespaces of managers, and the controllers whose nodes have ROS arguments, with them."""
    undecided: set[str] = field(default_factory=set)
    """Those of them whose command does not state that it does not start them."""
    unsure: bool = False
    """See `LaunchUse.unsure`."""
    typed: set[str] = field(default_factory=set)
    """See `LaunchUse.typed`."""
    simulated: bool = False
    spawns: list[Spawn] = field(default_factory=list)
    world: str = ""
    """The world as it is stated; empty if none is."""
    gazebos: Gazebos = field(default_factory=Gazebos)
    bridges: list[Path] = field(default_factory=list)
    """Configuration files of ros_gz_bridge."""
    renamed: list[RenamedTopic] = field(default_factory=list)
    """Topics that the arguments and remappings of ros_gz_bridge rename."""
    lost_bridges: list[str] = field(default_factory=list)
    """Those that were not found."""
    declared: set[str] = field(default_factory=set)
    """Names of the arguments of the launch file itself that can be set."""
    count: int = 0
    """Number of files that were read."""
    uncertain: dict[tuple[Path, int, str], Uncertain] = field(default_factory=dict)
    """Functions and variables in Python that may have different values, and texts of files, by the
    launch file, the line of the first value and the name."""
    kept: dict[str, tuple[Path, int]] = field(default_factory=dict)
    """Files of whose text a launch file changes a part to an unknown value, with its path and line.
    """
    conditionals: dict[Place, int] = field(default_factory=dict)
    """The expressions ``a if condition else b`` with an unknown condition, with the lines of a."""
    reversed: Collection[Place] = ()
    """Those of which b is used instead of a."""
    assumed: dict[str, Diagnostic] = field(default_factory=dict)
    """Notes about the environment variables of ROS that are not set."""
    required: dict[tuple[Path, str], Origin] = field(default_factory=dict)
    """Where arguments are declared that have neither a default nor a value, by the name and the
    launch file, which may be an included one. ROS does not start a launch file without them."""
    includes: list[tuple[Path, Mapping[str, str]]] = field(default_factory=list)
    """The included launch files with the arguments that they receive."""
    defaults: dict[str, str] = field(default_factory=dict)
    """The arguments of the launch file itself that have their default, such as the robot's type."""
    choices: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Their values that are stated to be valid."""
    incomplete: bool = False
    """See `LaunchUse.incomplete`."""
    leaves_out: bool = False
    """Whether a condition that does not hold leaves out a part."""
    strict: bool = False
    """Whether only what is certain counts: no package stands for another one, and what depends on
    an unknown condition is in doubt. `missing` is then filled."""
    doubts: int = 0
    """The number of reasons why what is being read may not be executed."""
    missing: list[MissingFile] = field(default_factory=list)
    """Stated files that do not exist where they are stated."""
    folders: set[Path] = field(default_factory=set)
    """The folders of packages that were found."""

    @contextlib.contextmanager
    def within(self, space: str) -> Iterator[None]:
        """Reads what is in the block in another namespace."""
        before, self.namespace = self.namespace, space
        yield
        self.namespace = before

    @contextlib.contextmanager
    def doubting(self, doubt: bool = True) -> Iterator[None]:
        """Reads what is in the block, which may not be executed."""
        self.doubts += doubt
        try:
            yield
        finally:
            self.doubts -= doubt

    def need(self, what: Missing, text: str, origin: Origin | None) -> None:
        """Notes a file without which the launch file does not start, if it does not exist."""
        name = text.strip()
        if not self.strict or self.doubts or not name or UNKNOWN in name:
            return
        self.effort.spend(_LOOK)
        if not is_file(Path(name)):
            origin = origin or Origin(file=str(self.file))
            self.missing.append(MissingFile(what=what, name=name, origin=origin))

    def need_text(self, words: Sequence[str], origin: Origin | None) -> None:
        """Notes the file of a command that prints a description, if it does not exist."""
        program = words[0].rpartition("/")[2] if words else ""
        if program in _PRINTING:
            for word in words[1:]:
                if ":=" not in word and word.endswith(variants.SUFFIXES):
                    self.need("file", word, origin)

    def package(self, name: str) -> str:
        """The folder of a package as text, with an unknown part if it is not found."""
        self.effort.search(name.strip())
        folder = self.find(name.strip()) if UNKNOWN not in name else None
        if folder is None and UNKNOWN not in name and name.strip() not in {*_GAZEBO, "xacro"}:
            self.absent[f'package "{name.strip()}"'] = None
        if folder is not None:
            self.folders.add(folder)
        elif name.strip() in _GAZEBO:
            # Its launch files often have the same names as those of the robot's package.
            return f"{UNKNOWN}/{name.strip()}"
        folder = folder or (None if self.strict else self.home)
        return str(folder) if folder is not None else f"{UNKNOWN}/{name}"

    def describe(self, text: str, origin: Origin) -> int | None:
        """Adds the description in a file name, or in a command such as ``xacro FILE a:=b``.

        Args:
            text: The file or the command.
            origin: Where the launch file states it.

        Returns:
            As for `add`.
        """
        if text.startswith("xacro/"):
            # Some launch files forget the space, as in ["xacro", file].
            text = "xacro " + text.removeprefix("xacro")
        self.effort.spend(len(text))
        try:
            words = shlex.split(text)
        except ValueError:
            return None
        arguments: dict[str, str] = {}
        file: Path | None = None
        skip = False
        for index, word in enumerate(words):
            if skip:
                skip = False
                continue
            name, assigned, value = word.partition(":=")
            if assigned and re.fullmatch(r"\w+", name):
                if not value and index + 1 < len(words) and ":=" not in words[index + 1]:
                    value, skip = words[index + 1], True
                # xacro ignores an argument without a value. Without the space before the next
                # argument, both values are unknown.
                if value:
                    arguments[name] = UNKNOWN if ":=" in value else value
            elif file is None and word.endswith(variants.SUFFIXES):
                file = Path(word)
        first = len(self.descriptions)
        number = self.add(file, arguments)
        if words and (Path(words[0]) == file or words[0].rpartition("/")[2] == "cat"):
            self.plain |= dict.fromkeys(range(first, len(self.descriptions)), origin)
        return number

    def add(self, file: Path | None, arguments: Mapping[str, str]) -> int | None:
        """Adds a description with arguments, if the file exists.

        If a part of the file's name is unknown, as in ``robot_$(env MODEL).xacro``, it may be any
        of the files with such a name.

        Returns:
            Its number in `descriptions`, that of the first if there are several; None if no file
            is stated; `ABSENT` if the file was not found.
        """
        self.effort.spend(_LOOK)
        if file is None:
            return None
        if UNKNOWN in str(file.parent):
            if (place := variants.below(file, UNKNOWN, self.file)) is None:
                return ABSENT
            file = place
        number = len(self.descriptions)
        if UNKNOWN not in file.name:
            file = self.here(file)
            if is_file(file):
                self.descriptions.append((file, dict(arguments)))
        elif variants.is_telling(file, UNKNOWN):
            known = {**arguments, "": UNKNOWN}
            found = variants.beside(file, UNKNOWN)
            self.words |= found
            self.descriptions += [(each, dict(known)) for each in found]
        if len(self.descriptions) > number:
            return number
        self.absent[f'file "{file}"'.replace(UNKNOWN, "…")] = None
        return ABSENT

    def store_parameter(self, name: str, number: int | None) -> None:
        """Stores which description a parameter contains; the last one counts."""
        key = resolved(self.namespace, name)
        if number is not None and (number != ABSENT or key not in self.published):
            self.published[key] = number

    def read_spawned(self) -> None:
        """Adds the descriptions in the parameters that spawners name, whatever their names."""
        for spawn in self.spawns:
            read = self.unread.pop(spawn.source, None)
            if read is not None:
                self.store_parameter(f"/{spawn.source}", read())

    def note_kept(self) -> None:
        """Notes the `kept` parts of files with controllers or for the bridge; others are ignored,
        such as those of Nav2.
        """
        used = {str(path) for path in (*(path for _, path in self.yamls), *self.bridges)}
        used.update(*(arguments.values() for _, arguments in self.descriptions))
        for file, (path, line) in self.kept.items():
            if file in used:
                place = (path, line, Path(file).name)
                self.uncertain.setdefault(place, Uncertain(what="text", used=line))

    def store_topic(self, space: str, number: int | None, remappings: Mapping[str, str]) -> None:
        """Stores which description a robot_state_publisher publishes; the first one counts.

        Args:
            space: The namespace of the node.
            number: The number of the description.
            remappings: New names of the node's topics, by their old names.
        """
        if number is not None:
            topic = "robot_description"
            topics = {resolved(space, old): new for old, new in remappings.items()}
            key = resolved(space, topics.get(resolved(space, topic), topic))
            if self.published.get(key, ABSENT) == ABSENT:
                self.published[key] = number

    def here(self, file: Path) -> Path:
        """A file where it is in the sources, although the launch file names another place.

        An absolute path may be that on another computer, such as ~/ws/src/bot/bot.urdf, and
        setup.py may install a file elsewhere than it is in the sources of the package.
        """
        if is_file(file):
            return file
        package = package_above(file.parent) or self.home
        if package is None:
            return file
        for name in (package.name, package_name(package)):
            if name in file.parts:
                last = len(file.parts) - file.parts[::-1].index(name)
                if is_file(found := package.joinpath(*file.parts[last:])):
                    return found
        return self._only(package, file.name) or file

    def found_world(self, world: str) -> str:
        """A world as it is stated, or its path if it is elsewhere than an absolute path states."""
        absolute = Path(world).is_absolute() and UNKNOWN not in world
        return str(self.here(Path(world))) if absolute else world

    def _only(self, package: Path, name: str) -> Path | None:
        """The only file of a name in a package; None if there is none or several."""
        found: list[Path] = []
        for root, folders, names in os.walk(package):
            self.effort.spend(_LOOK + len(names))
            folders[:] = sorted(each for each in folders if not each.startswith("."))
            found += [Path(root, name)] if name in names else []
        return found[0] if len(found) == 1 else None

    def node(
        self,
        package: str,
        executable: str,
        words: list[str],
        space: str,
        *,
        described: int | None = None,
        remappings: Mapping[str, str] = MappingProxyType({}),
        values: Mapping[str, str] = MappingProxyType({}),
        origin: Origin | None = None,
        name: str = "",
    ) -> None:
        """Adds what a node starts: models, controllers or a bridge.

        Args:
            package: Its package.
            executable: Its program.
            words: Its arguments.
            space: Its namespace.
            described: The number of the description whose text is one of its arguments.
            remappings: New names of its topics, by their old names.
            values: Its parameters, by name.
            origin: Where it is stated; None if only the file is known.
            name: Its name; empty if it has that of its program.
        """
        self.programs[UNKNOWN if UNKNOWN in space else space.strip("/"), package] = None
        if package in _GAZEBO:
            if executable == "create":
                # It also accepts its arguments as parameters.
                self.effort.spend(len(values))
                words = [*words, *(f"-{name}={value}" for name, value in values.items())]
            self.simulated |= executable in _SPAWNERS
            if executable in MODEL_SPAWNERS:
                spawn = spawn_of(executable, words, space)
                if spawn.file is not None:
                    first = len(self.descriptions)
                    described = self.add(spawn.file, {})
                    # The spawner passes the text of the file to Gazebo.
                    numbers = range(first, len(self.descriptions))
                    self.plain |= dict.fromkeys(numbers, origin or Origin(file=str(self.file)))
                    self.raw |= {*numbers}
                elif spawn.model:
                    file = variants.model_in(self.home, spawn.model)
                    described = ABSENT if file is None else self.add(file, {})
                    if file is None:
                        self.absent[f'model "{spawn.model}"'.replace(UNKNOWN, "…")] = None
                self.spawns.append(replace(spawn, described=described))
            else:
                world = world_in(words) or values.get("world_sdf_file", "")
                self._begin(world)
                self.need("world" if package == "gazebo_ros" else "gz world", world, origin)
            self.gazebos.add_node(package, () if executable in MODEL_SPAWNERS else words, values)
        if package in BRIDGES:
            for word in words:
                if word.startswith("config_file:="):
                    self.bridge(word.removeprefix("config_file:="))
            self.effort.spend(len(words) + len(remappings))
            self.renamed += renamed_topics(words, space, remappings, self.file)
        if package == "controller_manager" and executable in _CONTROLLER_SPAWNERS:
            command = by_spawner(words, space)
            self._control(command)
            # The spawner of Foxy does not use the namespace of its node.
            unsure = UNKNOWN in space or (executable == "spawner.py" and command.space == space)
            if not unsure and not any(UNKNOWN in word for word in words):
                self.sought_in_ros2 += ((command.space, name) for name in command.started)
        if executable == "ros2_control_node":
            outside = UNKNOWN if UNKNOWN in space else space.strip("/")
            sure = not self.doubts and name in ("", "controller_manager")
            self.managers[outside] = self.managers.get(outside, False) or sure
        self.partial |= _HARDWARE.search(executable) is not None
        self.spawning |= spawns(words) or (package in _GAZEBO and executable in MODEL_SPAWNERS)
        if package == "rosservice" and words[:1] == ["call"]:
            self._control(by_service(words[1:]))

    def bridge(self, text: str) -> None:
        """Adds a configuration file of ros_gz_bridge if it exists."""
        self.effort.spend(_LOOK)
        path = Path(text.strip())
        if UNKNOWN in text or not is_file(path):
            self.lost_bridges.append(text.strip().replace(UNKNOWN, "…"))
        elif path not in self.bridges:
            self.bridges.append(path)

    def command(self, words: list[str], origin: Origin | None = None) -> None:
        """Adds what a command starts, such as ``gazebo arena.world``."""
        if words and (server := words[0].rsplit("/", 1)[-1]) in _SERVERS:
            self.simulated = True
            self._begin(world_in(words))
            self.need("gz world" if server in ("gz", "ign") else "world", world_in(words), origin)
        self.gazebos.add_command(words)
        for program, *rest in shell_commands(words):
            self.effort.spend(len(rest))
            name = program.rsplit("/", 1)[-1]
            if name == "ros2" and rest[:1] == ["control"]:
                self._control(by_command(rest[1:]))
            elif name == "ros2" and rest[:2] == ["service", "call"]:
                self._control(by_service(rest[2:]))
            elif name == "rosservice" and rest[:1] == ["call"]:
                self._control(by_service(rest[1:]))
            elif name == "ros2" and rest[:1] == ["run"] and rest[2:3]:
                self.node(rest[1], rest[2], rest[3:], "")
            elif name == "rosrun" and rest[1:2]:
                self.node(rest[0], rest[1], rest[2:], "")

    def _begin(self, world: str) -> None:
        self.world = self.world or world.strip()

    def _control(self, command: ControllerCommand | None) -> None:
        if command is not None:
            self.spawned += ((command.space, name) for name in command.started)
            self.loaded += ((command.space, name) for name in command.loaded)
            self.undecided |= set(() if command.decided else command.loaded)
            self.unsure |= command.unsure
            self.typed |= set(command.started if command.typed else ())
            if command.arguments:
                for name in (*command.started, *command.loaded):
                    self.arguments.append((command.space, (name, command.arguments)))
            for each in command.files:
                self.parameters(each, within=command.space)

    def seek(self, words: list[str], space: str) -> None:
        """Adds the controllers of a spawner of ROS 1 with these arguments, in this namespace."""
        self.effort.spend(len(words))
        if UNKNOWN in space or any(UNKNOWN in word for word in words):
            return
        command = by_spawner(words, space)
        for name in command.started:
            # A name that begins with a slash is global.
            own = "" if f"/{name}" in words else command.space
            self.sought.append((own, name))

    def parameters(
        self,
        text: str,
        namespace: str = "",
        *,
        within: str | None = None,
        certain: bool = False,
    ) -> None:
        """Adds a YAML file if it exists.

        If a part of its name is unknown, it is the only file with such a name.

        Args:
            text: Its name.
            namespace: Namespace into which ROS 1 loads it. It is the name of the controller if the
                file contains the parameters of a single one.
            within: Namespace of the node that loads it; None for that of the group.
            certain: Whether the namespace is that of its parameters in ROS 1.
        """
        self.effort.spend(_LOOK)
        path = Path(text.strip())
        if UNKNOWN in text and (meant := variants.only_beside(path, UNKNOWN, _YAMLS)) is not None:
            path, text = meant, str(meant)
        if UNKNOWN not in text and path.suffix in _YAMLS and is_file(path):
            space = resolved(self.namespace if within is None else within, namespace.strip())
            name = namespace.strip("/ ").rpartition("/")[2]
            if re.fullmatch(r"\w+", name) and variants.is_single(path):
                path, space = Path(f"{name}={path}"), space.rpartition("/")[0]
            self.yamls.append((space, path))
            self.places.append((space if certain else UNKNOWN, path))
        elif UNKNOWN not in text and path.suffix in _YAMLS and path not in self.lost:
            self.lost.append(path)

    def written(self, path: Path, namespace: str) -> None:
        """Adds a launch file that contains parameters of controllers itself."""
        if (place := (resolved(self.namespace, namespace.strip()), path)) not in self.yamls:
            self.yamls.append(place)
            self.places.append((UNKNOWN, path))

    def include(
        self,
        text: str,
        arguments: Mapping[str, str],
        depth: int,
        inherited: Mapping[str, str] = MappingProxyType({}),
        *,
        origin: Origin | None = None,
        places: Mapping[str, Origin] = MappingProxyType({}),
    ) -> None:
        """Reads an included launch file if it exists.

        Args:
            text: Its name.
            arguments: The arguments that it receives.
            depth: The number of launch files that include the including one.
            inherited: Further arguments, which it inherits.
            origin: Where it is included; None if only the file is known.
            places: Where its arguments are stated, if this is known, by their names.
        """
        if _WORLD.search(text.rsplit("/", 1)[-1]):
            self.simulated = True
            for name in ("world_name", "world", "world_sdf_file"):
                self._begin(arguments.get(name, ""))
            for name in ("gz_args", "ign_args"):
                self._begin(world_in(split(arguments.get(name, ""))))
        path = Path(text.strip())
        is_own = UNKNOWN not in text and depth < DEEPEST and is_file(path)
        self.need("launch file", text, origin)
        if not is_own:
            self._need_world(path, {**inherited, **arguments}, places, origin)
        absent = any(each.startswith("package ") for each in self.absent)
        is_sure = "gazebo_ros" in path.parts or (not absent and UNKNOWN not in text)
        self.gazebos.add_launch_file(path.name, arguments, is_own=is_own, is_sure=is_sure)
        self.partial |= not is_own and _GAZEBO.isdisjoint(path.parts)
        if is_own:
            self.effort.spend(len(inherited))
            given = {**inherited, **arguments}
            self.includes.append((path, given))
            self.read(path, given, self, depth + 1)

    def _need_world(
        self,
        path: Path,
        arguments: Mapping[str, str],
        places: Mapping[str, Origin],
        origin: Origin | None,
    ) -> None:
        """Notes the world that a launch file of Gazebo's packages starts, if it does not exist."""
        for (package, name), stated in _STARTERS.items():
            if package in path.parts and name == path.name:
                for each in stated:
                    value = arguments.get(each, "")
                    world = world_in(split(value)) if each.endswith("_args") else value
                    kind: Missing = "world" if package == "gazebo_ros" else "gz world"
                    self.need(kind, world, places.get(each, origin))
