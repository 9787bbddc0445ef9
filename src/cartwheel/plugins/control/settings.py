"""A controller's parameters, read with their kinds checked and their file named."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from operator import getitem
from typing import Any

from cartwheel.codes import devices
from cartwheel.description.numbers import LARGEST
from cartwheel.errors import Code, Origin, PluginError, Value, meant_one
from cartwheel.plugins.parameters import shown

_MISSING: Any = object()
_MOST_COUNT = 1_000_000


class Settings:
    """The parameters of one controller.

    Names have slashes: ``linear/x/max_velocity``. What ROS 2 writes with dots is the same.

    Args:
        values: By name; mappings may be nested.
        name: Of the controller, or the parameters' namespace.
        source: The file or server they come from, for errors.
    """

    def __init__(self, values: Mapping[str, Any], name: str, source: str = "") -> None:
        self._values = _nested(values)
        self.name = name
        self.source = source
        self._asked: set[str] = set()
        """Full names; shared with all sections."""
        self._prefix = ""

    def has(self, name: str) -> bool:
        """Whether there is a value of that name."""
        return self._find(name) is not _MISSING

    def raw(self, name: str) -> Any:
        """The value as it is; None where there is none."""
        found = self._find(name)
        return None if found is _MISSING else found

    def section(self, name: str) -> Settings:
        """The parameters below a name; empty where there are none."""
        found = self._find(name)
        values = found if isinstance(found, Mapping) else {}
        self._asked.discard(self._prefix + name)
        made = Settings({}, self.name, self.source)
        made._values = dict(values)
        made._asked = self._asked
        made._prefix = f"{self._prefix}{name}/"
        return made

    def names(self) -> list[str]:
        """The top names."""
        return list(self._values)

    def number(self, name: str, default: float = _MISSING) -> float:
        """A number, or either infinity."""
        value = self._get(name, default)
        if isinstance(value, str):
            # rosparam keeps numbers such as 1e-3, which YAML takes for text.
            try:
                value = float(value)
            except ValueError:
                raise self.invalid(name, value, "a number") from None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.invalid(name, value, "a number")
        return self._bounded(name, value)

    def optional_number(self, name: str) -> float | None:
        """A number, or None where there is none, or a nan, by which ROS 2 leaves it open."""
        value = self._find(name)
        if value is _MISSING or (isinstance(value, float) and math.isnan(value)):
            return None
        return self.number(name)

    def integer(self, name: str, default: int = _MISSING) -> int:
        """A whole number."""
        value = self.number(name, default)
        if abs(value) > _MOST_COUNT or value != int(value):
            raise self.invalid(
                name, value, f"a whole number from {-_MOST_COUNT:,} to {_MOST_COUNT:,}"
            )
        return int(value)

    def boolean(self, name: str, default: bool = _MISSING) -> bool:
        """True or false."""
        value = self._get(name, default)
        if isinstance(value, str) and value.strip().lower() in ("true", "false"):
            return value.strip().lower() == "true"
        if isinstance(value, bool):
            return value
        if value in (0, 1) and isinstance(value, int):
            return bool(value)
        raise self.invalid(name, value, "true or false")

    def text(self, name: str, default: str = _MISSING) -> str:
        """A text."""
        value = self._get(name, default)
        if not isinstance(value, str):
            raise self.invalid(name, value, "a string")
        return value.strip()

    def texts(self, name: str, default: Sequence[str] = _MISSING) -> list[str]:
        """A list of texts; a single one is a list of one."""
        value = self._get(name, default)
        if isinstance(value, str):
            return [value.strip()]
        if not isinstance(value, list | tuple) or not all(isinstance(one, str) for one in value):
            raise self.invalid(name, value, "a list of strings")
        return [one.strip() for one in value]

    def numbers(self, name: str, default: Sequence[float] = _MISSING) -> list[float]:
        """A list of numbers."""
        value = self._get(name, default)
        good = isinstance(value, list | tuple) and all(
            isinstance(one, int | float) and not isinstance(one, bool) for one in value
        )
        if not good:
            raise self.invalid(name, value, "a list of numbers")
        return [self._bounded(name, one) for one in value]

    def unread(self) -> list[str]:
        """Names of the values that nobody asked for."""
        return [
            name
            for name in _leaves(self._values)
            if not any(name == asked or name.startswith(f"{asked}/") for asked in self._asked)
        ]

    def flat(self) -> dict[str, Any]:
        """All values by the names that ROS 2 gives them, with dots; none of it counts as read."""
        return {
            name.replace("/", "."): functools.reduce(getitem, name.split("/"), self._values)
            for name in _leaves(self._values)
        }

    def ignore(self, *names: str) -> None:
        """Counts names as read: they have no meaning here and do no harm."""
        self._asked.update(self._prefix + name for name in names)

    def error(
        self,
        code: Code,
        message: str,
        *,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
    ) -> PluginError:
        """The error for parameters that cannot be used, with their file; the caller raises it."""
        return PluginError(
            f'controller "{self.name}": {message}',
            code=code,
            origin=Origin(file=self.source) if self.source else None,
            hint=hint,
            values={"controller": self.name, **(values or {})},
        )

    def invalid(self, name: str, value: Any, wanted: str) -> PluginError:
        """The error for a parameter whose value is not allowed; the caller raises it.

        Args:
            name: The parameter.
            value: As it is stated.
            wanted: What is allowed, behind "must be".
        """
        stated = f"{value:g}" if isinstance(value, float) else shown(repr(value))
        return self.error(
            devices.CONTROLLER_PARAMETER_INVALID,
            f'the parameter "{self._prefix}{name}" must be {wanted} (got {stated})',
            values={"parameter": self._prefix + name, "value": stated},
        )

    def missing(self, name: str, hint: str = "") -> PluginError:
        """The error for a parameter that is needed; the caller raises it."""
        meant = meant_one(name, list(_leaves(self._values)))
        return self.error(
            devices.CONTROLLER_PARAMETER_MISSING,
            f'the parameter "{self._prefix}{name}" is missing',
            hint=f'Did you mean "{meant}"?' if meant else hint,
            values={"parameter": self._prefix + name, "meant": meant},
        )

    def _bounded(self, name: str, value: float) -> float:
        # A whole number of YAML can be too long for a float.
        unset = isinstance(value, float) and math.isnan(value)
        if unset or LARGEST < abs(value) < math.inf:
            wanted = "a number" if unset else f"from {-LARGEST:g} to {LARGEST:g}"
            raise self.invalid(name, value, wanted)
        return float(value)

    def _find(self, name: str) -> Any:
        self._asked.add(self._prefix + name)
        node: Any = self._values
        for part in name.split("/"):
            if not isinstance(node, Mapping) or part not in node:
                return _MISSING
            node = node[part]
        return node

    def _get(self, name: str, default: Any) -> Any:
        found = self._find(name)
        if found is not _MISSING:
            return found
        if default is _MISSING:
            raise self.missing(name)
        return default


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """The tree that dotted and slashed names stand for."""
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
    """Puts values into a tree, beside those that it has; where both have one, `other` wins."""
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
