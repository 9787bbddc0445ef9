"""What the classes of launch and launch_ros mean (ROS 2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches.bridging import BRIDGES
from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.evaluation import evaluated
from cartwheel.description.launches.python_values import (
    NOTHING,
    Changed,
    Description,
    is_known,
    joined,
    path_of,
    text,
)
from cartwheel.description.launches.spawning import resolved, split
from cartwheel.description.launches.use import Facts
from cartwheel.description.launches.variants import SUFFIXES
from cartwheel.errors import Origin


class Classes:
    """The classes of launch and launch_ros that a launch file uses.

    Each method has the first argument of the call, all that have no name, and those with names.

    Args:
        path: The launch file.
        defaults: Defaults of the launch arguments that the file declares after their use.
        given: The values of launch arguments.
        facts: Receives what the actions start.
        depth: The number of launch files that include this one.
    """

    def __init__(
        self,
        path: Path,
        defaults: Mapping[str, Any],
        given: Mapping[str, str],
        facts: Facts,
        depth: int,
    ) -> None:
        self.path = path
        self.defaults = dict(defaults)
        """The values of launch arguments that are not given."""
        self._given = given
        self.facts = facts
        """Receives what the actions start."""
        self._depth = depth
        self.line = 0
        """The line of the action that is made."""

    def configuration(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """The value of a launch argument."""
        name = text(words.get("variable_name", first))
        value = self.defaults.get(name, words.get("default", NOTHING))
        value = self._given.get(name, value)
        # Some launch files state an empty default for what the user must state.
        return NOTHING if value == "" and self.facts.strict else value

    def declaration(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Stores the default of a launch argument."""
        name = text(words.get("name", first))
        if not self._depth:
            self.facts.declared.add(name)
        if name not in self.defaults and ("default_value" in words or UNKNOWN in words):
            known = not (self.facts.strict and self.facts.doubts)
            self.defaults[name] = joined(words.get("default_value", NOTHING)) if known else UNKNOWN
        if name not in self._given and name not in self.defaults and UNKNOWN not in name:
            origin = Origin(file=shown_path(self.path), line=self.line)
            self.facts.required[self.path, name] = origin
        if not self._depth and name not in self._given and name in self.defaults:
            self.facts.defaults[name] = joined(self.defaults[name])
            choices = words.get("choices")
            if isinstance(choices, list):
                self.facts.choices[name] = tuple(map(joined, choices))
        return NOTHING

    def setting(self, first: Any, places: list[Any], words: dict[str, Any]) -> Any:
        """Stores the value of a launch argument."""
        if len(places) > 1 or "value" in words:
            value = places[1] if len(places) > 1 else words["value"]
            known = not (self.facts.strict and self.facts.doubts)
            self.defaults[text(words.get("name", first))] = joined(value) if known else UNKNOWN
        return NOTHING

    def executable(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """The name of an executable."""
        return words.get("name", first)

    def command(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Adds the description in a command."""
        origin = Origin(file=str(self.path), line=self.line)
        command = joined(words.get("command", first))
        if self.facts.strict:
            self.facts.need_text(split(command), origin)
        return Description(self.facts.describe(command, origin))

    def expression(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """The value of a Python expression, which consists of substitutions."""
        value = evaluated(joined(words.get("expression", first)).strip(), {}, self.facts.effort)
        return value if is_known(value) else NOTHING

    def inclusion(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Reads an included launch file."""
        source = words.get("launch_description_source", first)
        passed = words.get("launch_arguments", {})
        known = isinstance(passed, dict)
        if isinstance(passed, list):
            pairs = [each for each in passed if isinstance(each, list) and len(each) == 2]
            known = len(pairs) == len(passed)
            passed = {text(key): value for key, value in pairs}
        arguments = (
            {key: joined(value) for key, value in passed.items()}
            if isinstance(passed, dict)
            else {}
        )
        self.facts.effort.spend(len(self.defaults))
        defaults = {name: joined(value) for name, value in self.defaults.items()}
        inherited = {**defaults, **self._given}
        required = dict(self.facts.required)
        origin = Origin(file=str(self.path), line=self.line)
        self.facts.include(joined(source), arguments, self._depth, inherited, origin=origin)
        if not known or UNKNOWN in arguments:
            # The unknown arguments may be those without a default.
            self.facts.required = required
        return NOTHING

    def package_inclusion(self, first: Any, places: list[Any], words: dict[str, Any]) -> Any:
        """Reads a launch file that is stated by its package and the parts of its path in it."""
        parts = words.get("paths", places[1] if len(places) > 1 else NOTHING)
        folder = self.facts.package(text(words.get("pkg_name", first)))
        given = {name: words[name] for name in ("launch_arguments", UNKNOWN) if name in words}
        return self.inclusion(path_of([folder, parts]), [], given)

    def load_controller(self, first: Any, places: list[Any], words: dict[str, Any]) -> Any:
        """Adds what the spawner of one controller starts."""
        # Before Rolling of 2024, the type of the controller was the second argument.
        files = [*places[1:], words.get("controller_params_file", NOTHING)]
        given = {**words, "controller_params_files": [each for each in files if _is_yaml(each)]}
        if "controller_type" in words:
            more = words.get("extra_spawner_args", [])
            kind = ["--controller-type", words["controller_type"]]
            given["extra_spawner_args"] = [*(more if isinstance(more, list) else []), *kind]
        return self.load_controllers([words.get("controller_name", first)], [], given)

    def load_controllers(self, first: Any, places: list[Any], words: dict[str, Any]) -> Any:
        """Adds what the spawner of several controllers starts, whose names may be the keys of a
        dictionary with their files.
        """
        names: Any = words.get("controller_names", words.get("controller_info_dict", first))
        files: Any = words.get("controller_params_files", places[1] if len(places) > 1 else [])
        if isinstance(names, dict):
            names, files = [*names], [*names.values()]
        more = words.get("extra_spawner_args", [])
        lists = [each if isinstance(each, list) else [NOTHING] for each in (names, files, more)]
        flags = [part for each in _flat(lists[1]) for part in ("--param-file", each)]
        spawner = {
            "package": "controller_manager",
            "executable": "spawner",
            "arguments": [*lists[0], *flags, *lists[2]],
        }
        return self.node(NOTHING, [], spawner)

    def push(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Enters a namespace, until the end of the group."""
        stated = joined(words.get("namespace", first))
        self.facts.namespace = resolved(self.facts.namespace, stated)
        return NOTHING

    def node(self, _first: Any, _places: list[Any], words: dict[str, Any]) -> Any:
        """Adds what a node starts."""
        arguments = words.get("arguments", [])
        if not isinstance(arguments, list):
            arguments = [arguments]
        texts = [joined(each) for each in arguments]
        if len(texts) == 1 and " " in texts[0]:
            texts = split(texts[0])
        package = text(words.get("package", ""))
        executable = text(words.get("executable", words.get("node_executable", "")))
        space = resolved(self.facts.namespace, joined(words.get("namespace", "")))
        described = [each for each in arguments if isinstance(each, Description)]
        pairs = words.get("remappings")
        remappings = {
            joined(each[0]): joined(each[1])
            for each in (pairs if isinstance(pairs, list) else [])
            if isinstance(each, list) and len(each) == 2
        }
        given = words.get("parameters")
        values: dict[str, str] = {}
        for each in given if isinstance(given, list) else []:
            if isinstance(each, dict):
                values |= {
                    name: joined(value)
                    for name, value in each.items()
                    if isinstance(name, str) and not isinstance(value, Description)
                }
        self.facts.node(
            package,
            executable,
            texts,
            space,
            described=described[0].number if described else None,
            remappings=remappings,
            values=values,
            origin=Origin(file=str(self.path), line=self.line),
            name=joined(words.get("name", "")),
        )
        parameters = words.get("parameters")
        for each in parameters if isinstance(parameters, list) else []:
            if isinstance(each, dict):
                self._publish(space, each, remappings)
                if package in BRIDGES and "config_file" in each:
                    self.facts.bridge(joined(each["config_file"]))
            elif package == "controller_manager" and isinstance(each, str | list | Changed):
                self.facts.parameters(joined(each))
        return NOTHING

    def bridge(self, _first: Any, _places: list[Any], words: dict[str, Any]) -> Any:
        """Adds the configuration file of ros_gz_bridge's action."""
        self.facts.bridge(joined(words.get("config_file", "")))
        return NOTHING

    def _publish(
        self, space: str, parameters: Mapping[str, Any], remappings: Mapping[str, str]
    ) -> None:
        """Stores the description that a node has as a parameter and publishes."""
        value = parameters.get("robot_description")
        number = value.number if isinstance(value, Description) else None
        if isinstance(value, str) and value.endswith(SUFFIXES):
            # The text of a file that was opened is its path.
            number = self.facts.add(Path(value), {})
        self.facts.store_topic(space, number, remappings)

    def place(self, _first: Any, _places: list[Any], _words: dict[str, Any]) -> Any:
        """The folder of the launch file."""
        return str(self.path.parent)

    def process(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Adds what a command starts."""
        parts = words.get("cmd", first)
        if isinstance(parts, list):
            said = [joined(each) for each in parts]
            origin = Origin(file=str(self.path), line=self.line)
            self.facts.command(split(said[0]) if len(said) == 1 else said, origin)
        return NOTHING


def _is_yaml(value: Any) -> bool:
    return joined(value).endswith((".yaml", ".yml"))


def _flat(files: list[Any]) -> list[Any]:
    """The known files in a list that may contain lists of them."""
    listed = [each for one in files for each in (one if isinstance(one, list) else [one])]
    return [each for each in listed if _is_yaml(each)]


CLASSES: Mapping[str, Callable[[Classes, Any, list[Any], dict[str, Any]], Any]] = {
    "Command": Classes.command,
    "DeclareLaunchArgument": Classes.declaration,
    "ExecuteProcess": Classes.process,
    "FindExecutable": Classes.executable,
    "IncludeLaunchDescription": Classes.inclusion,
    "LaunchConfiguration": Classes.configuration,
    "Node": Classes.node,
    "PushRosNamespace": Classes.push,
    "PushROSNamespace": Classes.push,
    "PythonExpression": Classes.expression,
    "RosGzBridge": Classes.bridge,
    "SetLaunchConfiguration": Classes.setting,
    "ThisLaunchFileDir": Classes.place,
    # Functions of controller_manager.launch_utils and launch_pal.
    "generate_controllers_spawner_launch_description": Classes.load_controllers,
    "generate_controllers_spawner_launch_description_from_dict": Classes.load_controllers,
    "generate_load_controller_launch_description": Classes.load_controller,
    "include_launch_py_description": Classes.package_inclusion,
    "read_launch_argument": Classes.configuration,
}
"""What each class means. Those that call functions of the file are not among them."""
