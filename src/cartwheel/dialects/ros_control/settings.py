"""The parameters of a controller, with checks of their types."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from operator import getitem
from typing import Any

from cartwheel.codes import devices
from cartwheel.description.elements.numbers import LARGEST
from cartwheel.dialects.tags import shown
from cartwheel.errors import Code, Origin, PluginError, Value
from cartwheel.similar_names import meant_one

_MISSING: Any = object()
_MOST_COUNT = 1_000_000


class Settings:
    """The parameters of one controller.

    Names contain slashes, such as ``linear/x/max_velocity``. ROS 2's dots are equivalent.

    Args:
        values: Values by name; mappings can be nested.
        name: Name of the controller, or the namespace of the parameters.
        source: Their file or parameter server, for errors.
    """

    def __init__(self, values: Mapping[str, Any], name: str, source: str = "") -> None:
        self._values = _nested(values)
        self.name = name
        self.source = source
        self._read: set[str] = set()
        """Full names; shared with all sections."""
        self._prefix = ""
        self.misplaced: frozenset[str] = frozenset()
        """Parameters that the file states among those of the controller manager."""
        self.elsewhere = ""
        """A node of the same name in another namespace, whose parameters the file states."""

    def has(self, name: str) -> bool:
        """Whether a parameter exists."""
        return self._find(name) is not _MISSING

    def raw(self, name: str) -> Any:
        """Returns the value without a check; None if the parameter does not exist."""
        value = self._find(name)
        return None if value is _MISSING else value

    def section(self, name: str) -> Settings:
        """Returns the parameters below a name; empty if there are none."""
        value = self._find(name)
        values = value if isinstance(value, Mapping) else {}
        self._read.discard(self._prefix + name)
        section = Settings({}, self.name, self.source)
        section._values = dict(values)
        section._read = self._read
        section._prefix = f"{self._prefix}{name}/"
        return section

    def names(self) -> list[str]:
        """Returns the names at the top level."""
        return list(self._values)

    def number(self, name: str, default: float = _MISSING) -> float:
        """Returns a number, which can be infinite."""
        value = self._get(name, default)
        if isinstance(value, str):
            # rosparam stores numbers such as 1e-3 as strings, as YAML 1.1 reads them.
            try:
                value = float(value)
            except ValueError:
                raise self.invalid(name, value, "a number") from None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.invalid(name, value, "a number")
        return self._bounded(name, value)

    def optional_number(self, name: str) -> float | None:
        """Returns a number; None if it is missing or NaN, which ROS 2 uses for "not set"."""
        value = self._find(name)
        if value is _MISSING or (isinstance(value, float) and math.isnan(value)):
            return None
        return self.number(name)

    def integer(self, name: str, default: int = _MISSING) -> int:
        """Returns a whole number."""
        value = self.number(name, default)
        if abs(value) > _MOST_COUNT or value != int(value):
            raise self.invalid(
                name, value, f"a whole number between {-_MOST_COUNT:,} and {_MOST_COUNT:,}"
            )
        return int(value)

    def boolean(self, name: str, default: bool = _MISSING) -> bool:
        """Returns true or false."""
        value = self._get(name, default)
        if isinstance(value, str) and value.strip().lower() in ("true", "false"):
            return value.strip().lower() == "true"
        if isinstance(value, bool):
            return value
        if value in (0, 1) and isinstance(value, int):
            return bool(value)
        raise self.invalid(name, value, "true or false")

    def text(self, name: str, default: str = _MISSING) -> str:
        """Returns a string."""
        value = self._get(name, default)
        if not isinstance(value, str):
            raise self.invalid(name, value, "a string")
        return value.strip()

    def texts(self, name: str, default: Sequence[str] = _MISSING) -> list[str]:
        """Returns a list of strings. A single string is a list of one."""
        value = self._get(name, default)
        if isinstance(value, str):
            return [value.strip()]
        if not isinstance(value, list | tuple) or not all(isinstance(one, str) for one in value):
            raise self.invalid(name, value, "a list of strings")
        return [one.strip() for one in value]

    def numbers(self, name: str, default: Sequence[float] = _MISSING) -> list[float]:
        """Returns a list of numbers."""
        value = self._get(name, default)
        good = isinstance(value, list | tuple) and all(
            isinstance(one, int | float) and not isinstance(one, bool) for one in value
        )
        if not good:
            raise self.invalid(name, value, "a list of numbers")
        return [self._bounded(name, one) for one in value]

    def unread(self) -> list[str]:
        """Returns the names of the parameters that have not been read."""
        return [
            name
            for name in _leaves(self._values)
            if not any(name == read or name.startswith(f"{read}/") for read in self._read)
        ]

    def flat(self) -> dict[str, Any]:
        """Returns all values by ROS 2's names, with dots. They do not count as read."""
        return {
            name.replace("/", "."): functools.reduce(getitem, name.split("/"), self._values)
            for name in _leaves(self._values)
        }

    def ignore(self, *names: str) -> None:
        """Counts parameters as read that have no effect here and are no error."""
        self._read.update(self._prefix + name for name in names)

    def error(
        self,
        code: Code,
        message: str,
        *,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
    ) -> PluginError:
        """Returns the error for invalid parameters, with their file. The caller raises it."""
        return PluginError(
            f'controller "{self.name}": {message}',
            code=code,
            origin=Origin(file=self.source) if self.source else None,
            hint=hint,
            values={"controller": self.name, **(values or {})},
        )

    def invalid(self, name: str, value: Any, wanted: str) -> PluginError:
        """Returns the error for a parameter whose value is not allowed. The caller raises it.

        Args:
            name: The parameter.
            value: The specified value.
            wanted: The allowed values, as they follow "must be" in the message.
        """
        stated = f"{value:g}" if isinstance(value, float) else shown(repr(value))
        return self.error(
            devices.CONTROLLER_PARAMETER_INVALID,
            f'the parameter "{self._prefix}{name}" must be {wanted} (got {stated})',
            values={"parameter": self._prefix + name, "value": stated},
        )

    def missing(self, name: str, hint: str = "") -> PluginError:
        """Returns the error for a required parameter that is missing. The caller raises it."""
        meant = meant_one(name, list(_leaves(self._values)))
        if self._prefix + name in self.misplaced:
            hint = "It is among the parameters of the controller manager. Move it to "
            hint += f"{self.name}: ros__parameters."
        elif self.elsewhere:
            hint = f'The file has parameters for "{self.elsewhere}", which is another node. Write '
            hint += f"{self.name}: without a namespace."
        return self.error(
            devices.CONTROLLER_PARAMETER_MISSING,
            f'the parameter "{self._prefix}{name}" is missing',
            hint=f'Did you mean "{meant}"?' if meant else hint,
            values={"parameter": self._prefix + name, "meant": meant},
        )

    def _bounded(self, name: str, value: float) -> float:
        # A YAML integer can be too long for a float.
        unset = isinstance(value, float) and math.isnan(value)
        if unset or LARGEST < abs(value) < math.inf:
            wanted = "a number" if unset else f"between {-LARGEST:g} and {LARGEST:g}"
            raise self.invalid(name, value, wanted)
        return float(value)

    def _find(self, name: str) -> Any:
        self._read.add(self._prefix + name)
        node: Any = self._values
        for part in name.split("/"):
            if not isinstance(node, Mapping) or part not in node:
                return _MISSING
            node = node[part]
        return node

    def _get(self, name: str, default: Any) -> Any:
        value = self._find(name)
        if value is not _MISSING:
            return value
        if default is _MISSING:
            raise self.missing(name)
        return default


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the tree for names with dots and slashes."""
    tree: dict[str, Any] = {}
    for key, value in values.items():
        *parents, last = [part for part in str(key).replace("/", ".").split(".") if part] or [""]
        node = tree
        for part in parents:
            below = node.get(part)
            if not isinstance(below, dict):
                below = node[part] = {}
            node = below
        if isinstance(value, Mapping):
            below = node.setdefault(last, {})
            if isinstance(below, dict):
                merge(below, _nested(value))
        else:
            node[last] = value
    return tree


def merge(tree: dict[str, Any], other: Mapping[str, Any]) -> None:
    """Merges values into a tree. For the same key, `other` wins."""
    for key, value in other.items():
        below = tree.get(key)
        if isinstance(below, dict) and isinstance(value, Mapping):
            merge(below, value)
        else:
            tree[key] = value


def _leaves(values: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, f"{prefix}{key}/")
        else:
            yield f"{prefix}{key}"
