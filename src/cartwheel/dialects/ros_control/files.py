"""YAML files with controllers, in the formats of rosparam and ros2_control.

The file is long because both formats share most of the reading.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.readings import Readings
from cartwheel.description.launches.written import written_in
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.ros_control.launch_arguments import launch_arguments
from cartwheel.dialects.ros_control.settings import Settings, merge
from cartwheel.dialects.ros_control.substitution import substitute
from cartwheel.errors import DescriptionError, Diagnostic, Origin, PluginError
from cartwheel.similar_names import meant_one

if TYPE_CHECKING:
    from cartwheel.dialects.ros_control.controller import Controller

T = TypeVar("T")
_ROS2 = "ros__parameters"
_MISSPELT = 0.85
"""Similarity from which another key is probably a misspelt one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ControllerEntry:
    """A controller in a file."""

    name: str
    type: str
    values: Mapping[str, Any]
    namespace: str
    """Namespace in the file, without leading and trailing slashes."""
    source: str
    shared: tuple[str, ...] = ()
    """Parameters that the file gives to all nodes. Unknown ones cause no warning."""
    remappings: Mapping[str, str] = field(default_factory=dict)
    """Remapped topic names: new names by old names."""
    space: str = ""
    """A namespace that is a part of its name in ROS 1, without the first and last slash."""
    misplaced: frozenset[str] = frozenset()
    """Names of values beside the type, in the manager's parameters, which ROS 2 does not use."""
    elsewhere: str = ""
    """A node with the same name in another namespace that has parameters in the file."""

    def settings(self) -> Settings:
        """Returns the parameters of the controller."""
        settings = Settings(self.values, self.name, self.source)
        settings.ignore("use_sim_time", *self.shared)
        settings.misplaced = self.misplaced
        settings.elsewhere = self.elsewhere
        return settings


class ControllerFiles:
    """The files whose controllers the next robot starts automatically.

    A robot's controller manager takes the files when it is created.
    """

    def __init__(self) -> None:
        self.paths: tuple[Path, ...] = ()
        self.names: frozenset[str] = frozenset()
        """Names of the controllers to start, if the files contain all of them; empty: all."""
        self.idle: frozenset[str] = frozenset()
        """Names of controllers to load, but not to start."""
        self.arguments: dict[str, tuple[str, ...]] = {}
        """The ROS arguments of their nodes, by the name of the controller."""
        self.loaded: list[Controller] = []
        """Controllers that managers have loaded from files."""
        self.readings: Readings | None = None
        """What was read of files before; None: files are read each time."""

    @property
    def started(self) -> list[Controller]:
        """The loaded controllers that run. One whose joint is already commanded does not start."""
        return [controller for controller in self.loaded if controller.running]

    def wanted(self, entries: Iterable[ControllerEntry]) -> list[ControllerEntry]:
        """Returns the controllers among the files' entries that are started, or `idle`.

        Arguments of their nodes replace those in the files, as with ROS 2's spawner.
        """
        listed = [
            replace(
                entry,
                remappings=remappings(self.arguments[entry.name]),
                space=_namespace(self.arguments[entry.name]),
            )
            if entry.name in self.arguments
            else entry
            for entry in entries
        ]
        if not self.names or not self.names <= {entry.name for entry in listed}:
            return listed
        return [entry for entry in listed if entry.name in self.names | self.idle]

    def offer(
        self,
        paths: Iterable[Path],
        names: Iterable[str],
        idle: Iterable[str],
        arguments: Iterable[tuple[str, tuple[str, ...]]],
    ) -> None:
        """Sets what the next robot uses."""
        self.paths, self.names, self.idle = tuple(paths), frozenset(names), frozenset(idle)
        self.arguments = dict(arguments)

    def withdraw(self) -> tuple[Path, ...]:
        """Clears what the robot did not use; returns the files that no controller manager took."""
        left = self.take()
        self.names = self.idle = frozenset()
        self.arguments = {}
        return left

    def take(self) -> tuple[Path, ...]:
        """Returns the files and clears them, so that only one robot uses them."""
        paths, self.paths = self.paths, ()
        return paths

    def known(self, robot: RobotDescription, question: Hashable, read: Callable[[], T]) -> T:
        """Returns what `read` returns, or returned before for the same robot; see `Readings.of`."""
        return read() if self.readings is None else self.readings.of(robot, question, read)

    def read(self, path: Path, robot: RobotDescription) -> dict[str, Any]:
        """Reads the controllers of a file, by name, and replaces its substitutions.

        Raises:
            PluginError: See `read_yaml` and `for_robot`.
        """
        return self.known(
            robot, ("ros1", path), lambda: for_robot(read_parameters(path), path, robot)
        )

    def read_ros2(self, path: Path, robot: RobotDescription) -> dict[str, Any]:
        """Reads a ROS 2 parameter file and replaces its substitutions.

        Raises:
            PluginError: See `read_ros2`.
        """
        return self.known(robot, ("ros2", path), lambda: read_ros2(path, robot))


def read_parameters(path: Path) -> dict[str, Any]:
    """Reads the controllers of a file, by name.

    A file can contain the parameters of a single controller, which launch files load into a
    namespace. Its name is the file's stem, or NAME if the path is given as ``NAME=FILE``.

    Raises:
        PluginError: See `read_yaml`.
    """
    name, file = name_and_file(path)
    content = read_yaml(file)
    if name or isinstance(content.get("type"), str):
        return {name or file.stem: content}
    return content


def name_and_file(path: Path) -> tuple[str, Path]:
    """Splits ``NAME=FILE``; the name is empty if the path is only that of a file."""
    name, equals, file = str(path).partition("=")
    return (name, Path(file)) if equals and not path.exists() else ("", path)


def read_yaml(path: Path) -> dict[str, Any]:
    """Reads the mapping in a YAML file, or in a launch file of ROS 1.

    Raises:
        PluginError: The file cannot be read, is not valid YAML, or is not a mapping.
    """
    # The import is slow, and only robots with controllers need it.
    import yaml

    try:
        written = written_in(path)
        text = yaml_text.read(path) if written is None else written
        ros2 = "ros__parameters" in text
        loader = (yaml_text.loader() if ros2 else yaml_text.rosparam_loader())(text)
        node = loader.get_single_node()
        if node is not None and (ros2 or written is not None):
            yaml_text.as_ros2(node)
        content = loader.construct_document(node) if node is not None else None
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        text, line = yaml_text.fault(error)
        raise _unreadable(text, Origin(file=shown_path(path), line=line)) from None
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise _unreadable("the file is not a mapping of parameters", Origin(file=shown_path(path)))
    return content


def _unreadable(message: str, origin: Origin) -> PluginError:
    return PluginError(message, code=devices.CONTROLLERS_FILE_UNREADABLE, origin=origin)


def for_robot(content: dict[str, Any], path: Path, robot: RobotDescription) -> dict[str, Any]:
    """Replaces the substitutions in a file, such as ``$(arg name)``, which launch files evaluate.

    Raises:
        PluginError: See `substitute`.
    """
    arguments = launch_arguments(content, robot)
    filled: dict[str, Any] = substitute(content, path, arguments)
    return filled


def read_ros2(path: Path, robot: RobotDescription) -> dict[str, Any]:
    """Reads a ROS 2 parameter file and replaces its substitutions.

    Args:
        path: The file.
        robot: The robot whose arguments are used.

    Raises:
        PluginError: See `read_yaml` and `for_robot`; or the file is not a ROS 2 parameter file.
    """
    content = for_robot(read_yaml(path), path, robot)
    if content and not is_ros2(content):
        raise PluginError(
            "the file has no ros__parameters, but the robot uses ros2_control",
            code=devices.CONTROLLERS_FILE_MISMATCH,
            origin=Origin(file=shown_path(path)),
            hint="Nest the parameters under the name of their node and ros__parameters.",
        )
    return content


def of_ros2(path: Path) -> PluginError:
    """The error that a controller manager of ROS 1 receives a file for ROS 2."""
    return PluginError(
        "the file is for ros2_control, but the robot uses gazebo_ros_control",
        code=devices.CONTROLLERS_FILE_MISMATCH,
        origin=Origin(file=shown_path(path)),
        hint="Pass the file that the launch file loads with rosparam.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2File:
    """The parameters in one or more ros2_control files."""

    manager: Mapping[str, Any]
    """Parameters of the controller manager."""
    nodes: Mapping[str, Mapping[str, Any]]
    """Parameters of the other nodes, by name."""
    shared: Mapping[str, Any]
    """Parameters of all nodes."""
    elsewhere: tuple[str, ...]
    """Names of nodes in other namespaces."""


def is_ros2(content: Mapping[str, Any]) -> bool:
    """Whether a file contains ROS 2 parameters: ``ros__parameters`` below a node name."""
    return any(
        isinstance(value, Mapping) and (_ROS2 in value or is_ros2(value))
        for value in content.values()
    )


def misspelt_key(content: Mapping[str, Any]) -> str:
    """The key of a node that should probably be ``ros__parameters``; empty if there is none.

    ROS 2 refuses the whole file of such a key.
    """
    waiting: list[Mapping[str, Any]] = [content]
    while waiting:
        for key, value in waiting.pop().items():
            if key == _ROS2 or not isinstance(value, Mapping):
                continue
            if meant_one(str(key), [_ROS2], cutoff=_MISSPELT):
                return str(key)
            waiting.append(value)
    return ""


def ros2_file(
    contents: Sequence[Mapping[str, Any]],
    namespace: str,
    manager: str = "controller_manager",
    *,
    strict: bool = False,
) -> Ros2File:
    """Combines the parameters in several files, for the nodes of a namespace. Later files win.

    ``/**`` applies to all nodes; ``/ns/node`` and nested names apply to one. Source:
    rcl_yaml_param_parser.

    Args:
        contents: Contents of the files.
        namespace: Namespace of the nodes.
        manager: Name of the controller manager's node.
        strict: Whether names without a namespace are not those of nodes in one, as in ROS 2.
    """
    shared: dict[str, Any] = {}
    nodes: dict[str, dict[str, Any]] = {}
    elsewhere = []
    wanted = namespace.strip("/")
    for content in contents:
        for path, values in _ros2_nodes(content, ()):
            *space, name = path
            inside = "/".join(space)
            apart = inside != wanted and (bool(inside) or (strict and name not in ("**", "*")))
            if apart and "**" not in space and "*" not in space:
                elsewhere.append("/".join(("", *path)))
            elif name in ("**", "*"):
                merge(shared, _copy(values))
            else:
                merge(nodes.setdefault(name, {}), _copy(values))
    own = {**shared, **nodes.pop(manager, {})}
    return Ros2File(manager=own, nodes=nodes, shared=shared, elsewhere=tuple(elsewhere))


def _copy(values: Mapping[str, Any]) -> dict[str, Any]:
    """Copies nested mappings. Lists are shared with the original."""
    return {key: _copy(one) if isinstance(one, Mapping) else one for key, one in values.items()}


def controller_entries(file: Ros2File, namespace: str, source: str) -> list[ControllerEntry]:
    """Returns the controllers whose type is specified, in the manager's or their own parameters."""
    manager = Settings(file.manager, "controller_manager", source)
    return [
        entry
        for name in dict.fromkeys((*manager.names(), *file.nodes))
        if (entry := controller_entry(file, name, namespace, source)).type
    ]


def controller_entry(file: Ros2File, name: str, namespace: str, source: str) -> ControllerEntry:
    """Returns a controller by its name. Its type is empty if no file specifies it.

    In some files the type is below an additional ``ros__parameters``. ROS 2 does not find it there,
    and their launch files pass the type to the spawner.
    """
    own = file.nodes.get(name, {})
    listed = Settings(file.manager, "controller_manager", source).raw(name)
    listed = listed if isinstance(listed, Mapping) else {}
    deeper = listed.get(_ROS2)
    if isinstance(deeper, Mapping):
        listed = {**deeper, **listed}
    kind = listed.get("type") if isinstance(listed.get("type"), str) else own.get("type")
    values = _copy(file.shared)
    merge(values, _copy(own))
    return ControllerEntry(
        name=name,
        type=kind if isinstance(kind, str) else "",
        values=values,
        namespace=namespace,
        source=source,
        shared=tuple(key for key in file.shared if key not in own),
        remappings=remappings(listed.get("node_options_args", [])),
        misplaced=frozenset(map(str, listed)),
        elsewhere=next((each for each in file.elsewhere if each.endswith(f"/{name}")), ""),
    )


def remappings(arguments: Any) -> dict[str, str]:
    """Returns the remappings (``-r from:=to``) among a node's arguments. Source: rcl."""
    words = arguments.split() if isinstance(arguments, str) else list(arguments)
    pairs = [
        str(word).partition(":=")
        for flag, word in itertools.pairwise(words)
        if flag in ("-r", "--remap")
    ]
    return {source: target for source, mark, target in pairs if mark}


def _namespace(arguments: Iterable[str]) -> str:
    """The namespace (``__ns:=name``) among a node's arguments; empty if there is none."""
    stated = (word.partition(":=") for word in arguments)
    return next((value.strip("/") for name, _, value in stated if name == "__ns"), "")


def _ros2_nodes(
    content: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    for key, value in content.items():
        if not isinstance(value, Mapping):
            continue
        parts = (*path, *(part for part in str(key).split("/") if part))
        parameters = value.get(_ROS2)
        if isinstance(parameters, Mapping):
            yield parts or ("**",), parameters
        else:
            yield from _ros2_nodes(value, parts)


def stated_path(text: str, origin: Origin) -> Path:
    """Returns the path in a tag. It is relative to the file that contains the tag.

    A description from a service has no folder. Like its meshes, it uses the current folder.
    """
    path = Path(text.strip())
    if path.is_absolute():
        return path
    return Path("" if _is_from_service(origin) else origin.file).parent / path


def moved_file(text: str, origin: Origin) -> tuple[Path | None, list[Diagnostic]]:
    """Returns the file that a tag means by a path of another computer, with its diagnostics.

    The file is None if there is none in the package of the description.
    """
    packages = Packages(None if _is_from_service(origin) else Path(origin.file))
    found = packages.elsewhere(text.strip(), origin, use="controllers")
    return found, list(packages.moves())


def why_missing(text: str, origin: Origin) -> tuple[str, str]:
    """Why the file in a tag does not exist, such as a package that was not found, and a hint."""
    plain = f'the file "{text}" does not exist', ""
    if _is_from_service(origin) or "$(" not in text:
        return plain
    try:
        Packages(Path(origin.file)).resolve(text, origin)
    except DescriptionError as error:
        return error.message, error.hint or ""
    return plain


def _is_from_service(origin: Origin) -> bool:
    return origin.file.startswith("<")
