"""Reads launch files in Python (ROS 2) by their syntax tree. They are never executed."""

from __future__ import annotations

import ast
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.use import UNKNOWN, Facts

_JOINS = frozenset({"join", "joinpath", "PathJoinSubstitution"})
_SHARES = frozenset(
    {
        "get_package_share_directory",
        "get_package_share_path",
        "FindPackageShare",
        "FindPackage",
        "get_package_prefix",
        "FindPackagePrefix",
    }
)
_SAME = frozenset(
    {
        "str",
        "Path",
        "TextSubstitution",
        "ParameterValue",
        "ParameterFile",
        "PythonLaunchDescriptionSource",
        "XMLLaunchDescriptionSource",
        "AnyLaunchDescriptionSource",
        "FrontendLaunchDescriptionSource",
        "abspath",
        "realpath",
        "normpath",
        "expanduser",
        "dict",
        "list",
        "RewrittenYaml",
        "ReplaceString",
    }
)
"""Functions whose value is that of their first argument, or of a keyword in `_FIRST`."""
_FIRST = ("text", "source_file", "value", "param_file")
_PASSED = frozenset(
    {
        "items",
        "perform",
        "toxml",
        "toprettyxml",
        "read",
        "read_text",
        "as_posix",
        "strip",
        "resolve",
    }
)
"""Methods whose value is that of the object."""


class _Unknown:
    """A value that cannot be determined."""


_NOTHING = _Unknown()


class _Description:
    """The text that xacro produces from a file."""

    def __init__(self, file: str, arguments: Mapping[str, str]) -> None:
        self.file = file
        self.arguments = arguments


def read_python(path: Path, arguments: Mapping[str, str], facts: Facts, depth: int) -> None:
    """Adds the contents of a launch file to `facts`."""
    try:
        tree = ast.parse(read_regular_text(path))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    # Declared defaults may follow their use, so the file is read twice.
    defaults = _Reader(
        path, {}, arguments, Facts(find=facts.find, read=_ignore, home=facts.home), depth
    )
    defaults.block(tree.body)
    _Reader(path, defaults.defaults, arguments, facts, depth).block(tree.body)


def _ignore(_path: Path, _arguments: Mapping[str, str], _facts: Facts, _depth: int) -> None:
    """Included files are irrelevant for the declared defaults."""


class _Reader:
    def __init__(
        self,
        path: Path,
        defaults: Mapping[str, Any],
        given: Mapping[str, str],
        facts: Facts,
        depth: int,
    ) -> None:
        self.defaults = dict(defaults)
        self._given = given
        self._facts = facts
        self._depth = depth
        self._names: dict[str, Any] = {"__file__": str(path)}

    def block(self, statements: Iterable[ast.stmt]) -> None:
        """Evaluates statements in their order; of branches, all, and of loops, the body once."""
        for each in statements:
            if isinstance(each, ast.Assign):
                value = self.value(each.value)
                for target in each.targets:
                    self._assign(target, value)
            elif isinstance(each, ast.AnnAssign) and each.value is not None:
                self._assign(each.target, self.value(each.value))
            elif isinstance(each, ast.Expr | ast.Return | ast.AugAssign):
                if each.value is not None:
                    self.value(each.value)
            elif isinstance(each, ast.With):
                for item in each.items:
                    if item.optional_vars is not None:
                        self._assign(item.optional_vars, self.value(item.context_expr))
                self.block(each.body)
            else:
                for name in ("body", "orelse", "finalbody"):
                    self.block(getattr(each, name, ()) or ())

    def _assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self._names[target.id] = value
        elif (
            isinstance(target, ast.Subscript)
            and isinstance(holder := self.value(target.value), dict)
            and isinstance(key := self.value(target.slice), str)
        ):
            holder[key] = value

    def value(self, node: ast.expr) -> Any:
        """The value of an expression; `_NOTHING` if it is unknown."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            return self._names.get(node.id, _NOTHING)
        if isinstance(node, ast.JoinedStr):
            return "".join(_text(self.value(each)) for each in node.values)
        if isinstance(node, ast.FormattedValue):
            return self.value(node.value)
        if isinstance(node, ast.List | ast.Tuple | ast.Set):
            return [self.value(each) for each in node.elts]
        if isinstance(node, ast.Dict):
            return {
                _text(self.value(key)): self.value(value)
                for key, value in zip(node.keys, node.values, strict=True)
                if key is not None
            }
        if isinstance(node, ast.BinOp):
            return _combined(node.op, self.value(node.left), self.value(node.right))
        if isinstance(node, ast.IfExp):
            return self.value(node.orelse if self._holds(node.test) is False else node.body)
        if isinstance(node, ast.Attribute):
            value = self.value(node.value)
            if node.attr == "parent" and isinstance(value, str):
                return str(PurePosixPath(value).parent)
            return _NOTHING
        if isinstance(node, ast.Subscript):
            held, key = self.value(node.value), self.value(node.slice)
            return held.get(key, _NOTHING) if isinstance(held, dict) else _NOTHING
        if isinstance(node, ast.Call):
            return self._call(node)
        return _NOTHING

    def _holds(self, test: ast.expr) -> bool | None:
        """Whether a condition on texts holds; None if it is unknown."""
        if isinstance(test, ast.Compare) and len(test.ops) == 1:
            left, right = self.value(test.left), self.value(test.comparators[0])
            if isinstance(test.ops[0], ast.Eq | ast.NotEq) and _is_known(left, right):
                return bool((left == right) == isinstance(test.ops[0], ast.Eq))
            return None
        value = self.value(test)
        return value != "" if _is_known(value) else None

    def _call(self, node: ast.Call) -> Any:
        named = isinstance(node.func, ast.Name | ast.Attribute)
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        holder: Any = _NOTHING
        if isinstance(node.func, ast.Attribute):
            name = node.func.attr
            holder = self.value(node.func.value)
        places = [
            self.value(each.value if isinstance(each, ast.Starred) else each) for each in node.args
        ]
        words = {each.arg: self.value(each.value) for each in node.keywords if each.arg}
        if not named:
            return _NOTHING
        first = places[0] if places else next((words[w] for w in _FIRST if w in words), _NOTHING)
        if name in _JOINS:
            parts = [*([] if isinstance(holder, _Unknown) else [holder]), *places]
            # A part may be a list of substitutions, as in [folder, [name, ".xacro"]].
            steps = [
                step for each in parts for step in (each if isinstance(each, list) else [each])
            ]
            return str(PurePosixPath(*map(_joined, steps)))
        if name in _SHARES:
            return self._facts.package(_text(words.get("package", first)))
        if name in _SAME:
            return words if name == "dict" and words else first
        if name == "dirname":
            return str(PurePosixPath(_text(first)).parent)
        if name == "open" or name in _PASSED:
            return first if name == "open" else holder
        if name in ("process_file", "process", "process_doc"):
            # For process_doc, the document is the text of the file that xacro.parse has read.
            return self._processed(_text(first), words.get("mappings", {}))
        if name == "parse" and isinstance(node.func, ast.Attribute):
            module = node.func.value
            return first if isinstance(module, ast.Name) and module.id == "xacro" else _NOTHING
        maker = _ACTIONS.get(name)
        return _NOTHING if maker is None else maker(self, first, places, words)

    def _processed(self, file: str, mappings: Any) -> _Description:
        arguments = (
            {key: _text(value) for key, value in mappings.items()}
            if isinstance(mappings, dict)
            else {}
        )
        self._facts.add(Path(file), arguments)
        return _Description(file, arguments)

    def configuration(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """The value of a launch argument."""
        name = _text(words.get("variable_name", first))
        if name in self._given:
            return self._given[name]
        return self.defaults.get(name, words.get("default", _NOTHING))

    def declaration(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Stores the default of a launch argument."""
        name = _text(words.get("name", first))
        if "default_value" in words and name not in self.defaults:
            self.defaults[name] = _joined(words["default_value"])
        if not self._depth and name not in self._given and name in self.defaults:
            self._facts.defaults[name] = _joined(self.defaults[name])
        return _NOTHING

    def setting(self, first: Any, places: list[Any], _: dict[str, Any]) -> Any:
        """Stores the value of a launch argument."""
        if len(places) > 1:
            self.defaults[_text(first)] = _joined(places[1])
        return _NOTHING

    def executable(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """The name of an executable."""
        return words.get("name", first)

    def command(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Adds the description in a command."""
        self._facts.describe(_joined(words.get("command", first)))
        return _NOTHING

    def inclusion(self, first: Any, _: list[Any], words: dict[str, Any]) -> Any:
        """Reads an included launch file."""
        source = words.get("launch_description_source", first)
        passed = words.get("launch_arguments", {})
        if isinstance(passed, list):
            pairs = [each for each in passed if isinstance(each, list) and len(each) == 2]
            passed = {_text(key): value for key, value in pairs}
        arguments = (
            {key: _joined(value) for key, value in passed.items()}
            if isinstance(passed, dict)
            else {}
        )
        self._facts.include(_joined(source), arguments, self._depth)
        return _NOTHING

    def node(self, _first: Any, _places: list[Any], words: dict[str, Any]) -> Any:
        """Adds what a node starts."""
        arguments = words.get("arguments", [])
        texts = [_joined(each) for each in arguments] if isinstance(arguments, list) else []
        if len(texts) == 1 and " " in texts[0]:
            try:
                texts = shlex.split(texts[0])
            except ValueError:
                texts = []
        package = _text(words.get("package", ""))
        executable = _text(words.get("executable", words.get("node_executable", "")))
        self._facts.node(package, executable, texts)
        if package == "controller_manager" and isinstance(words.get("parameters"), list):
            for each in words["parameters"]:
                if isinstance(each, str | list):
                    self._facts.parameters(_joined(each))
        return _NOTHING


_ACTIONS: Mapping[str, Callable[[_Reader, Any, list[Any], dict[str, Any]], Any]] = {
    "Command": _Reader.command,
    "DeclareLaunchArgument": _Reader.declaration,
    "FindExecutable": _Reader.executable,
    "IncludeLaunchDescription": _Reader.inclusion,
    "LaunchConfiguration": _Reader.configuration,
    "Node": _Reader.node,
    "SetLaunchConfiguration": _Reader.setting,
}
"""What the classes of launch and launch_ros mean."""


def _text(value: Any) -> str:
    """A value as text; `UNKNOWN` for an unknown one."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool | int | float):
        return str(value)
    if isinstance(value, list):
        return _joined(value)
    return UNKNOWN


def _joined(value: Any) -> str:
    """The text of substitutions, which launch concatenates."""
    return "".join(_text(each) for each in _flat([value]))


def _flat(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        if isinstance(value, list):
            yield from _flat(value)
        else:
            yield value


def _combined(operator: ast.operator, left: Any, right: Any) -> Any:
    if isinstance(operator, ast.Div):
        return str(PurePosixPath(_text(left), _text(right)))
    if isinstance(operator, ast.Add):
        if isinstance(left, list) and isinstance(right, list):
            return left + right
        return _text(left) + _text(right)
    return _NOTHING


def _is_known(*values: Any) -> bool:
    return all(isinstance(each, str) and UNKNOWN not in each for each in values)
