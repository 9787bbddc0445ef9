"""Parameters of ROS 2 whose values have another type than the one that their node declares.

A node of ROS 2 does not convert the value of a parameter. If a controller declares a double, and
the file states ``50``, which is an integer, an exception ends its initialisation, so that the
controller manager does not load it. Cartwheel converts the value. Source: rclcpp, which throws an
InvalidParameterTypeException, and generate_parameter_library.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.devices import CONTROLLER_PARAMETER_TYPE
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.plugin_xml import exporting_file
from cartwheel.dialects.ros2_control.declared_types import CLASSIC, CONTROLLERS, EVERY, Type
from cartwheel.dialects.ros2_control.scalars import type_of
from cartwheel.dialects.ros_control.files import ControllerEntry
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.dialects.tags import shown
from cartwheel.errors import Diagnostic, Origin

_LIST = re.compile(r"\{(\w+)\}")
_ROS2 = "ros__parameters"
_SHOWN = 3
_LONGEST = 300
"""Maximum number of characters of a parameter's name, and of a line with other values."""
_DEEPEST = 8
"""Maximum nesting of namespaces around a node."""
_TEXTS: Mapping[str, str] = {
    "double": "a double",
    "integer": "an integer",
    "bool": "a bool",
    "string": "a string",
    "double_array": "a list of doubles",
    "integer_array": "a list of integers",
    "bool_array": "a list of bools",
    "string_array": "a list of strings",
}
_CONVERTED: Mapping[Type, frozenset[str]] = {
    "double": frozenset({"integer", "string"}),
    "integer": frozenset({"double", "string"}),
    "bool": frozenset({"integer", "string"}),
    "double_array": frozenset({"integer_array"}),
    "string_array": frozenset({"string"}),
}
"""The types that Cartwheel converts. Any other one is a mistake here as well."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Wrong:
    """A value of the wrong type."""

    name: str
    wanted: Type
    given: str
    node: Any
    path: Path

    @property
    def text(self) -> str:
        """The value as the file states it, in one line."""
        node = self.node
        if node.id == "scalar":
            text = " ".join(str(node.value).split())
            return f'"{text}"' if node.style else text
        return f"[{', '.join(str(each.value) for each in node.value)}]"

    @property
    def mended(self) -> str:
        """The value with the right type; empty if it is unknown."""
        return _converted(self.node, self.wanted)


def mistyped(
    entry: ControllerEntry, files: Sequence[Path], *, classic: bool
) -> Iterator[Diagnostic]:
    """The parameters of a controller for which ROS 2 does not start it, one finding for each line.

    Args:
        entry: The controller.
        files: The files with its parameters; later ones win.
        classic: Whether the robot is for Gazebo Classic.
    """
    kind = entry.type.strip().replace("::", "/")
    declared = {**EVERY, **CONTROLLERS.get(kind, {})}
    declared |= CLASSIC.get(kind, {}) if classic else {}
    values = Settings(entry.values, entry.name).flat()
    if "front_left_wheel_name" in values:
        # Husarion's controller has the same name.
        return
    found = list(_wrong(entry.name, values, declared, files))
    if not found or any(exporting_file(path, kind) for path in files):
        # The repository's own controller may declare other types.
        return
    yield from _by_line(found, f'the controller "{entry.name}"', {"controller": entry.name})


def mistyped_manager(
    name: str, values: Mapping[str, Any], files: Sequence[Path]
) -> Iterator[Diagnostic]:
    """The parameters for which the controller manager does not start in Gazebo.

    Args:
        name: The name of its node.
        values: Its parameters.
        files: The files with its parameters; later ones win.
    """
    found = list(_wrong(name, {key: values.get(key) for key in EVERY}, EVERY, files))
    yield from _by_line(found, "the controller manager", {"stops": True})


def _wrong(
    node: str, values: Mapping[str, Any], declared: Mapping[str, Type], files: Sequence[Path]
) -> Iterator[_Wrong]:
    """The values with types that Cartwheel converts, and ROS 2 does not."""
    contents: list[tuple[Path, Mapping[str, Any]]] | None = None
    for name, wanted in _expanded(declared, values):
        if not _may_differ(values.get(name), wanted):
            continue
        if contents is None:
            contents = [(path, _parameters(path, node)) for path in reversed(files)]
        for path, stated in contents:
            written = stated.get(name)
            if written is None:
                continue
            given = type_of(written)
            if given in _CONVERTED[wanted] and (given != "string" or _converted(written, wanted)):
                yield _Wrong(name=name, wanted=wanted, given=given, node=written, path=path)
            break


def _expanded(
    declared: Mapping[str, Type], values: Mapping[str, Any]
) -> Iterator[tuple[str, Type]]:
    """The declared parameters, with the names of joints."""
    for name, wanted in declared.items():
        listed = _LIST.search(name)
        if listed is None:
            yield name, wanted
            continue
        joints = values.get(listed[1])
        for joint in joints if isinstance(joints, list) else [joints]:
            if isinstance(joint, str):
                yield name.replace(listed[0], joint), wanted


def _may_differ(value: Any, wanted: Type) -> bool:
    """Whether a value may have another type, of which the file decides, such as by its quotes."""
    if value is None or wanted == "string_array":
        return isinstance(value, str)
    if wanted == "double_array":
        return isinstance(value, list) and any(isinstance(each, int) for each in value)
    right = {"double": float, "integer": int, "bool": bool}[wanted]
    return isinstance(value, str | bool | int | float) and type(value) is not right


def _parameters(path: Path, node: str) -> Mapping[str, Any]:
    """The nodes of the parameters that a file states for a node of ROS 2, by their names."""
    try:
        state = path.stat()
    except OSError:
        return {}
    sections = _sections_of(path, state.st_mtime_ns, state.st_size)
    found: dict[str, Any] = {}
    for shared in (True, False):
        for name, parameters in sections:
            if (name in ("**", "*")) if shared else name == node:
                found.update(_flat(parameters, ""))
    return found


@functools.lru_cache(maxsize=4)
def _sections_of(path: Path, _changed: int, _size: int) -> Sequence[tuple[str, Any]]:
    """The names of the nodes in a file, with their parameters; none if it cannot be read.

    A file with many controllers is read once. `_changed` and `_size` are those of the file.
    """
    import yaml

    if path.suffix not in (".yaml", ".yml"):
        return ()
    try:
        root = yaml.compose(yaml_text.read(path), Loader=yaml_text.loader())
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return ()
    if root is None:
        return ()
    yaml_text.as_ros2(root)
    return tuple(_sections(root, ()))


def _sections(node: Any, path: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """The names of the nodes in a file, with their parameters."""
    for key, value in _pairs(node):
        if key == _ROS2:
            yield path[-1] if path else "**", value
        elif len(path) < _DEEPEST:
            yield from _sections(value, (*path, *(part for part in key.split("/") if part)))


def _flat(node: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    """The nodes of values by the names of the parameters, with dots."""
    for key, value in _pairs(node):
        name = f"{prefix}{key}"
        if len(name) > _LONGEST:
            continue
        if value.id == "mapping":
            yield from _flat(value, f"{name}.")
        else:
            yield name, value


def _pairs(node: Any) -> list[tuple[str, Any]]:
    if node is None or node.id != "mapping":
        return []
    return [(str(key.value), value) for key, value in node.value if key.id == "scalar"]


def _by_line(
    found: Sequence[_Wrong], who: str, values: Mapping[str, str | bool]
) -> Iterator[Diagnostic]:
    lines: dict[tuple[Path, int], list[_Wrong]] = {}
    texts = {path: yaml_text.read(path).splitlines() for path in {each.path for each in found}}
    for each in found:
        lines.setdefault((each.path, each.node.start_mark.line), []).append(each)
    for (path, line), wrong in lines.items():
        listed = [
            f'"{each.name}" must be {_TEXTS[each.wanted]} (got {_TEXTS[each.given]}, '
            f"{shown(each.text)})"
            for each in wrong[:_SHOWN]
        ]
        more = f", and {len(wrong) - _SHOWN} more" if len(wrong) > _SHOWN else ""
        mended = [each.mended for each in wrong]
        instead = _replaced(texts[path][line], wrong) if all(mended) else ""
        yield CONTROLLER_PARAMETER_TYPE.diagnostic(
            f"{who} does not start in ROS 2, because {', '.join(listed)}{more}",
            origin=Origin(file=shown_path(path), line=line + 1),
            hint=f"Write {', '.join(mended[:_SHOWN])}." if all(mended) and not instead else "",
            values={
                **values,
                "parameter": wrong[0].name,
                "parameters": tuple(each.name for each in wrong),
                "value": shown(wrong[0].text),
                "wanted": wrong[0].wanted,
                "meant": mended[0],
            },
            instead=instead,
            place="line" if instead else "",
            mark=wrong[0].text,
        )


def _converted(node: Any, wanted: Type) -> str:
    """The text of a value with another type; empty if it is unknown."""
    if node.id == "sequence":
        return f"[{', '.join(_converted(each, 'double') for each in node.value)}]"
    text = str(node.value).strip()
    if wanted == "string_array":
        return f"[{text}]"
    if wanted == "bool":
        return {"0": "false", "1": "true", "false": "false", "true": "true"}.get(text.lower(), "")
    try:
        number = float(int(text, 0)) if text.lstrip("+-").startswith("0x") else float(text)
    except (ValueError, OverflowError):
        return ""
    if wanted == "double" and not math.isfinite(number):
        return ".nan" if math.isnan(number) else "-.inf" if number < 0 else ".inf"
    if wanted == "double":
        return f"{text}.0" if re.fullmatch(r"[-+]?\d+", text) else repr(number)
    return str(int(number)) if number.is_integer() else ""


def _replaced(line: str, wrong: Sequence[_Wrong]) -> str:
    """The line with other values, without indentation; empty if a value has several lines, or if
    the line is very long.
    """
    if len(line) > _LONGEST:
        return ""
    for each in sorted(wrong, key=lambda one: one.node.start_mark.column, reverse=True):
        start, end = each.node.start_mark, each.node.end_mark
        if end.line != start.line:
            return ""
        line = "".join((line[: start.column], each.mended, line[end.column :]))
    return line.strip()
