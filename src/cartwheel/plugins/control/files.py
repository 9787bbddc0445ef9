"""Controllers' YAML files, as rosparam and ros2_control read them."""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.description.model import RobotDescription
from cartwheel.errors import Origin, PluginError
from cartwheel.graph import Graph
from cartwheel.plugins.control.launch_arguments import launch_arguments
from cartwheel.plugins.control.settings import Settings, merge
from cartwheel.plugins.control.substitution import substitute

if TYPE_CHECKING:
    from cartwheel.plugins.control.controller import Controller

_ROS2 = "ros__parameters"


@dataclass(frozen=True, kw_only=True, slots=True)
class ControllerEntry:
    """A controller in a file."""

    name: str
    type: str
    values: Mapping[str, Any]
    namespace: str
    """As the file has it, without slashes at its ends."""
    source: str
    shared: tuple[str, ...] = ()
    """Parameters that the file gives to all nodes: those that it does not know are no fault."""
    remappings: Mapping[str, str] = field(default_factory=dict)
    """Names of topics, as written, by the names that stand for them."""

    def settings(self) -> Settings:
        """Its parameters, to be read."""
        made = Settings(self.values, self.name, self.source)
        made.ignore("use_sim_time", *self.shared)
        return made


class ControllerFiles:
    """The files whose controllers the next robot starts by itself.

    A robot's manager takes them when it is made.
    """

    def __init__(self) -> None:
        self.paths: tuple[Path, ...] = ()
        self.loaded: list[Controller] = []
        """What managers loaded by themselves, for those who tell the user."""

    @classmethod
    def of(cls, graph: Graph) -> ControllerFiles:
        """Those of a graph, none at first."""
        found = _BY_GRAPH.get(graph)
        if found is None:
            found = _BY_GRAPH[graph] = cls()
        return found

    @property
    def started(self) -> list[Controller]:
        """Those of them that run; others want joints that one of these has."""
        return [controller for controller in self.loaded if controller.running]

    def take(self) -> tuple[Path, ...]:
        """The files, for one robot alone."""
        paths, self.paths = self.paths, ()
        return paths


_BY_GRAPH: weakref.WeakKeyDictionary[Graph, ControllerFiles] = weakref.WeakKeyDictionary()


def read_parameters(path: Path) -> dict[str, Any]:
    """A file's mapping of controllers.

    A file that is one controller itself, which launch files load into a namespace, is named as
    the file is, or as ``NAME=FILE`` says.

    Raises:
        PluginError: As `read_yaml`.
    """
    name, equals, file = str(path).partition("=")
    if not equals or path.exists():
        name, file = "", str(path)
    content = read_yaml(Path(file))
    if name or isinstance(content.get("type"), str):
        return {name or Path(file).stem: content}
    return content


def read_yaml(path: Path) -> dict[str, Any]:
    """A file's mapping.

    Raises:
        PluginError: It cannot be read, is no YAML, or no mapping; with its place.
    """
    # Only robots with controllers pay for the import.
    import yaml

    origin = Origin(file=str(path))
    try:
        text = yaml_text.read(path)
        loader = yaml_text.loader()(text)
        node = loader.get_single_node()
        if node is not None and "ros__parameters" in text:
            _join(node, set())
        content = loader.construct_document(node) if node is not None else None
    except OSError as error:
        raise _unreadable(f"the file cannot be read: {error.strerror or error}", origin) from None
    except UnicodeDecodeError:
        raise _unreadable("the file is not a text file", origin) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = mark.line + 1 if mark is not None else 0
        problem = getattr(error, "problem", None) or "it is not YAML"
        place = Origin(file=str(path), line=line)
        raise _unreadable(f"the file is not valid YAML: {problem}", place) from None
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise _unreadable("the file is not a mapping of parameters", origin)
    return content


def _unreadable(message: str, origin: Origin) -> PluginError:
    return PluginError(message, code=devices.CONTROLLERS_FILE_UNREADABLE, origin=origin)


def _join(node: Any, seen: set[int]) -> None:
    """Joins mappings of a file that stand under the same key, as ROS 2 reads them.

    YAML's own rule, which ROS 1 keeps to, is that the last one counts.
    """
    if node.id == "scalar" or id(node) in seen:
        return
    seen.add(id(node))
    if node.id == "mapping":
        kept: list[tuple[Any, Any]] = []
        first: dict[str, Any] = {}
        for key, value in node.value:
            before = first.get(str(key.value))
            if before is not None and before.id == value.id == "mapping":
                before.value = [*before.value, *value.value]
            else:
                kept.append((key, value))
                first[str(key.value)] = value
        node.value = kept
    for each in node.value:
        _join(each[1] if node.id == "mapping" else each, seen)


def for_robot(content: dict[str, Any], path: Path, robot: RobotDescription) -> dict[str, Any]:
    """A file's content with what launch files put into it.

    Raises:
        PluginError: As `substitute`.
    """
    arguments = launch_arguments(content, robot)
    filled: dict[str, Any] = substitute(content, path, arguments)
    return filled


def read_ros2(path: Path, robot: RobotDescription) -> dict[str, Any]:
    """A file of ROS 2's nodes, with what launch files put into it.

    Args:
        path: Of the file.
        robot: Whose controllers it has.

    Raises:
        PluginError: As `read_yaml` and `for_robot`, or it is no such file.
    """
    content = for_robot(read_yaml(path), path, robot)
    if content and not is_ros2(content):
        raise PluginError(
            "the file has no ros__parameters, but the robot has ros2_control",
            code=devices.CONTROLLERS_FILE_MISMATCH,
            origin=Origin(file=str(path)),
            hint="In ROS 2, parameters belong under the name of their node and ros__parameters.",
        )
    return content


def ros1_entries(content: Mapping[str, Any], source: str) -> list[ControllerEntry]:
    """The controllers of a file for rosparam: mappings with a ``type``, wherever they are."""
    return list(_ros1_entries(content, (), source))


def _ros1_entries(
    content: Mapping[str, Any], path: tuple[str, ...], source: str
) -> Iterator[ControllerEntry]:
    for key, value in content.items():
        if not isinstance(value, Mapping):
            continue
        parts = tuple(part for part in str(key).split("/") if part)
        kind = value.get("type")
        if isinstance(kind, str) and "/" in kind.replace("::", "/"):
            *space, name = (*path, *parts)
            yield ControllerEntry(
                name=name, type=kind, values=value, namespace="/".join(space), source=source
            )
        elif len(path) < 4:
            yield from _ros1_entries(value, (*path, *parts), source)


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2File:
    """What a ros2_control file says."""

    manager: Mapping[str, Any]
    """Parameters of the controller manager."""
    nodes: Mapping[str, Mapping[str, Any]]
    """Parameters of the other nodes, by name."""
    shared: Mapping[str, Any]
    """Parameters of all nodes."""
    elsewhere: tuple[str, ...]
    """Nodes of other namespaces."""


def is_ros2(content: Mapping[str, Any]) -> bool:
    """Whether a file's parameters are those of ROS 2's nodes."""
    return any(
        isinstance(value, Mapping) and (_ROS2 in value or is_ros2(value))
        for value in content.values()
    )


def ros2_file(
    contents: Sequence[Mapping[str, Any]], namespace: str, manager: str = "controller_manager"
) -> Ros2File:
    """Several files' parameters for the nodes of a namespace; later ones win.

    ``/**`` stands for all nodes, ``/ns/node`` and nested names for one. Source:
    rcl_yaml_param_parser.

    Args:
        contents: Of the files.
        namespace: Of the nodes.
        manager: Name of the controller manager's node.
    """
    shared: dict[str, Any] = {}
    nodes: dict[str, dict[str, Any]] = {}
    elsewhere = []
    wanted = namespace.strip("/")
    for content in contents:
        for path, values in _ros2_nodes(content, ()):
            *space, name = path
            inside = "/".join(space)
            if inside and inside != wanted and "**" not in space and "*" not in space:
                elsewhere.append("/".join(("", *path)))
            elif name in ("**", "*"):
                merge(shared, _copy(values))
            else:
                merge(nodes.setdefault(name, {}), _copy(values))
    own = {**shared, **nodes.pop(manager, {})}
    return Ros2File(manager=own, nodes=nodes, shared=shared, elsewhere=tuple(elsewhere))


def _copy(values: Mapping[str, Any]) -> dict[str, Any]:
    """One that can be changed; lists stay what they are."""
    return {key: _copy(one) if isinstance(one, Mapping) else one for key, one in values.items()}


def controller_entries(found: Ros2File, namespace: str, source: str) -> list[ControllerEntry]:
    """The controllers whose type the manager's or their own parameters state."""
    manager = Settings(found.manager, "controller_manager", source)
    return [
        entry
        for name in dict.fromkeys((*manager.names(), *found.nodes))
        if (entry := controller_entry(found, name, namespace, source)).type
    ]


def controller_entry(found: Ros2File, name: str, namespace: str, source: str) -> ControllerEntry:
    """A controller by its name; its type is empty where nothing states it.

    Some files state it below a further ``ros__parameters``: ROS 2 does not find it there, and
    their launch files give it to the spawner.
    """
    own = found.nodes.get(name, {})
    listed = Settings(found.manager, "controller_manager", source).raw(name)
    listed = listed if isinstance(listed, Mapping) else {}
    deeper = listed.get(_ROS2)
    if isinstance(deeper, Mapping):
        listed = {**deeper, **listed}
    kind = listed.get("type") if isinstance(listed.get("type"), str) else own.get("type")
    values = _copy(found.shared)
    merge(values, _copy(own))
    return ControllerEntry(
        name=name,
        type=kind if isinstance(kind, str) else "",
        values=values,
        namespace=namespace,
        source=source,
        shared=tuple(key for key in found.shared if key not in own),
        remappings=remappings(listed.get("node_options_args", [])),
    )


def remappings(arguments: Any) -> dict[str, str]:
    """What ``-r from:=to`` among a node's arguments makes of names. Source: rcl."""
    words = arguments.split() if isinstance(arguments, str) else list(arguments)
    pairs = [
        str(word).partition(":=")
        for flag, word in itertools.pairwise(words)
        if flag in ("-r", "--remap")
    ]
    return {source: target for source, mark, target in pairs if mark}


def _ros2_nodes(
    content: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    for key, value in content.items():
        if not isinstance(value, Mapping):
            continue
        parts = (*path, *(part for part in str(key).split("/") if part))
        found = value.get(_ROS2)
        if isinstance(found, Mapping):
            yield parts or ("**",), found
        else:
            yield from _ros2_nodes(value, parts)
