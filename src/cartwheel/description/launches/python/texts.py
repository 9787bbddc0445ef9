"""Changes that launch files in Python make in the texts of files: nav2_common's ReplaceString and
RewrittenYaml, and the substitutions of launch_ros' ParameterFile.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.python_values import joined
from cartwheel.description.rewritten import rewritten

CHANGES = frozenset({"ReplaceString", "RewrittenYaml", "ParameterFile"})
"""Classes whose value is the path of a file, of which they may change the text."""
_MOST_BYTES = 1_000_000
_VARIABLE = re.compile(r"\$\(var\s+([\w-]+)\s*\)")
_DEEPEST = 20
"""Maximum nesting of a YAML file."""


class ChangedFile:
    """A file whose text is changed.

    Args:
        path: Its path as it is stated.
        effort: What the changes may cost.
    """

    def __init__(self, path: str, effort: Effort) -> None:
        self.path = path
        """The path of the changed file."""
        self.kept = False
        """Whether a part is kept, because its new value is unknown."""
        self._effort = effort

    def replace(self, pairs: Mapping[str, Any]) -> None:
        """Replaces texts, in their order."""

        def changed(text: str) -> str:
            for old, value in pairs.items():
                self._effort.spend(len(text))
                new = joined(value)
                if not old or old not in text:
                    continue
                if UNKNOWN in new or "\n" in new or UNKNOWN in old:
                    self.kept = True
                elif len(text) + text.count(old) * len(new) <= _MOST_BYTES:
                    text = text.replace(old, new)
            return text

        self._change(changed)

    def substitute(self, value_of: Callable[[str], Any]) -> None:
        """Replaces ``$(var NAME)`` by the known values of launch arguments."""

        def value(found: re.Match[str]) -> str:
            new = joined(value_of(found[1]))
            return found[0] if UNKNOWN in new or "\n" in new else new

        self._change(lambda text: _VARIABLE.sub(value, text))

    def rewrite(self, values: Mapping[str, Any], root: str, *, convert: bool) -> None:
        """Replaces the values of keys, which may be paths such as ``a.b``.

        Args:
            values: The new values by key.
            root: The namespace that is put around the content; empty for none.
            convert: Whether numbers and truth values are written as such instead of as texts.
        """
        import yaml

        def changed(text: str) -> str:
            self._effort.load(text)
            try:
                node = yaml_text.loader()(text).get_single_node()
            except yaml.YAMLError:
                return text
            edits: list[tuple[int, int, str]] = []
            if root and isinstance(node, yaml.MappingNode):
                keys = (key for key, _ in node.value if isinstance(key, yaml.ScalarNode))
                edits += [(key.start_mark.index, key.start_mark.index, f"{root}/") for key in keys]
            for name, path, held in self._leaves(node, ()):
                key = name if name in values else ".".join(path)
                if key not in values:
                    continue
                new = joined(values[key])
                if UNKNOWN in new or "\n" in new or held.start_mark.line != held.end_mark.line:
                    self.kept = True
                    continue
                quoted = "'" + new.replace("'", "''") + "'"
                written = new if convert and new.strip() else quoted
                edits.append((held.start_mark.index, held.end_mark.index, written))
            for begin, end, new in sorted(edits, reverse=True):
                text = text[:begin] + new + text[end:]
            return text

        self._change(changed)

    def _leaves(
        self, node: Any, path: tuple[str, ...]
    ) -> Iterator[tuple[str, tuple[str, ...], Any]]:
        """The keys of values that are no mappings, with their paths and values."""
        import yaml

        self._effort.spend()
        if not isinstance(node, yaml.MappingNode) or len(path) > _DEEPEST:
            return
        for key, value in node.value:
            name = str(key.value)
            inner = (*path, name)
            if isinstance(value, yaml.MappingNode):
                yield from self._leaves(value, inner)
            else:
                yield name, inner, value

    def _change(self, changed: Callable[[str], str]) -> None:
        if UNKNOWN in self.path:
            return
        try:
            text = read_regular_text(Path(self.path), _MOST_BYTES)
        except (OSError, ValueError):
            return
        self._effort.spend(len(text))
        new = changed(text)
        if new != text:
            self.path = str(rewritten(Path(self.path), new))
