"""Scenario files as values whose places are known, for messages with file and line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.command import SCENARIO_INVALID
from cartwheel.errors import CartwheelError, Origin, Value

Key = tuple[str | int, ...]
"""The keys and indices that lead to a value."""


class ScenarioError(CartwheelError):
    """An invalid scenario."""

    code = SCENARIO_INVALID


@dataclass(frozen=True, slots=True)
class Document:
    """A scenario file."""

    path: Path
    value: Any
    """Mappings, lists, strings, numbers and booleans."""
    lines: Mapping[Key, int] = field(default_factory=dict)
    """The line of each value, or of its key."""

    def origin(self, key: Key = ()) -> Origin:
        """The place of a value, or of the nearest enclosing value that is in the file."""
        while key and key not in self.lines:
            key = key[:-1]
        return Origin(file=str(self.path), line=self.lines.get(key, 0))

    def error(
        self, key: Key, message: str, *, hint: str = "", values: Mapping[str, Value] | None = None
    ) -> ScenarioError:
        """An error about a value."""
        where = {"key": shown(key), **(values or {})}
        return ScenarioError(message, origin=self.origin(key), hint=hint, values=where)


def shown(key: Key) -> str:
    """A key in messages: ``steps[0].publish``."""
    text = ""
    for part in key:
        text += f"[{part}]" if isinstance(part, int) else f"{'.' if text else ''}{part}"
    return text


def read(path: Path) -> Document:
    """Reads a scenario file.

    Raises:
        ScenarioError: The file cannot be read, or is not valid YAML.
    """
    import yaml

    try:
        return parse(yaml_text.read(path), path)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        text, line = yaml_text.fault(error)
        raise ScenarioError(text, origin=Origin(file=str(path), line=line)) from None


def parse(text: str, path: Path) -> Document:
    """Parses the text of a scenario file.

    Raises:
        yaml.YAMLError: The text is not valid YAML.
        ScenarioError: A mapping has a key twice, or a key that is not a string.
    """
    loader: Any = yaml_text.loader()(text)
    root = loader.get_single_node()
    if root is None:
        return Document(path, None)
    lines: dict[Key, int] = {}
    value = _value(loader, root, (), lines, path)
    return Document(path, value, lines)


def _value(loader: Any, node: Any, key: Key, lines: dict[Key, int], path: Path) -> Any:
    lines.setdefault(key, node.start_mark.line + 1)
    if node.id == "sequence":
        return [
            _value(loader, each, (*key, index), lines, path)
            for index, each in enumerate(node.value)
        ]
    if node.id != "mapping":
        return loader.construct_object(node, deep=True)
    own = [name.value for name, _ in node.value]
    loader.flatten_mapping(node)
    found: dict[str, Any] = {}
    for name_node, each in node.value:
        name = loader.construct_object(name_node, deep=True)
        line = name_node.start_mark.line + 1
        is_text = isinstance(name, str)
        # A key may replace one that it gets by "<<".
        if not is_text or (name in found and own.count(name) > 1):
            raise ScenarioError(
                f'"{name}" is given twice' if is_text else f'the key "{name}" must be a text',
                origin=Origin(file=str(path), line=line),
                values={"key": shown((*key, str(name)))},
                hint="Remove one of them." if is_text else 'Write it in quotation marks: "…".',
            )
        lines[(*key, name)] = line
        found[name] = _value(loader, each, (*key, name), lines, path)
    return found
