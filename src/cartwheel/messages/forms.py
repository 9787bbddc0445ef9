"""Messages of one topic, of which only some fields differ: as objects, or at once as bytes."""

from __future__ import annotations

import functools
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cartwheel.codes.graph import MESSAGE_NOT_ENCODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.cdr.places import cdr_places
from cartwheel.messages.cdr.writing import encode_cdr
from cartwheel.messages.common import header, newest_headers, stamp
from cartwheel.messages.fields import fields
from cartwheel.messages.places import Place
from cartwheel.messages.ros1.places import SEQ, ros1_places
from cartwheel.messages.ros1.writing import encode_ros1
from cartwheel.messages.store import message_class

_TIME = "builtin_interfaces/msg/Time"
_HEADER = "std_msgs/msg/Header"
_SECOND = 1_000_000_000

PACKING_ERRORS = (struct.error, TypeError, AttributeError, ValueError, OverflowError)
"""Errors of values that do not fit their fields."""

Pack = Callable[..., bytes]
"""Returns the bytes of a message with the given values."""


class Form:
    """Messages that equal a template except in some fields.

    The bytes of all these messages have the same layout, so they are packed from the values in one
    call. This takes a third of the time of creating a message and encoding it.

    Args:
        template: The message with the constant values, or a function that creates it when it is
            first needed. It must not change. Its lists and arrays have the lengths of those of all
            messages.
        varying: The fields that differ, in the order of the values. Names and indices are joined
            with dots, such as ``transforms.0.header.stamp``. A tuple of fields has one value in
            common. A value is a time in ns for a ``Time``, a sequence of numbers for a message that
            consists of numbers, a numpy array of the field's type for an array, and otherwise a
            number.

    If the template has no such field, or if the field consists of something else, the first use
    raises a ValueError.
    """

    def __init__(self, template: Any | Callable[[], Any], *varying: str | tuple[str, ...]) -> None:
        self._template = template
        self._paths = [(each,) if isinstance(each, str) else each for each in varying]
        self._argument = {path: i for i, paths in enumerate(self._paths) for path in paths}

    @functools.cached_property
    def template(self) -> Any:
        """The message with the constant values."""
        made = self._template
        if not hasattr(made, "__msgtype__"):
            made = made()
        self._template = None
        return made

    @functools.cached_property
    def message(self) -> Callable[[Sequence[Any]], Any]:
        """Creates the message with the given values."""
        names: dict[str, Any] = {
            "header": header, "newest": newest_headers.get, "stamp": stamp
        }  # fmt: skip
        assert self._leaves
        headers: dict[tuple[str, str], str] = {}
        made = self._expression(self.template, "", names, headers)
        # Python calls a function with one argument faster than one with a sequence of arguments.
        lines = [f"[{', '.join(self._arguments())}] = values"]
        for (time, frame), local in headers.items():
            # Mostly, another message had the same header. A call of `header` takes longer.
            lines += (
                f"{local} = newest({frame}, (None, None, None, None))",
                f"{local} = {local}[1] if {local}[0] == {time} else {local}[3] if "
                f"{local}[2] == {time} else header({time}, {frame})",
            )
        created: Callable[[Sequence[Any]], Any] = _function(
            "message", ("values",), (*lines, f"return {made}"), names
        )
        return created

    @functools.cached_property
    def cdr(self) -> Pack:
        """Returns the bytes that `encode_cdr` returns for the message."""
        return self._packer("cdr", encode_cdr(self.template), cdr_places(self.template))

    @functools.cached_property
    def ros1(self) -> Pack:
        """Returns the bytes that `encode_ros1` returns for the message.

        The first argument is the sequence number of the header.

        Raises:
            UnknownNameError: ROS 1 does not have this type.
        """
        return self._packer("ros1", encode_ros1(self.template), ros1_places(self.template))

    def encode(self, values: Sequence[Any]) -> bytes:
        """CDR bytes of a message.

        Raises:
            GraphError: A value does not fit its field.
        """
        try:
            return self.cdr(*values)
        except PACKING_ERRORS as error:
            raise self.refused(error, "ROS 2") from error

    def encode_ros1(self, values: Sequence[Any], *, seq: int = 0) -> bytes:
        """ROS 1 bytes of a message.

        Raises:
            UnknownNameError: ROS 1 does not have this type.
            GraphError: A value does not fit its field.
        """
        try:
            return self.ros1(seq & 0xFFFFFFFF, *values)
        except PACKING_ERRORS as error:
            raise self.refused(error, "ROS 1") from error

    def refused(self, error: Exception, version: str) -> GraphError:
        """The error for values that do not fit their fields."""
        return GraphError(
            f"{version} cannot represent this {self.template.__msgtype__}: {error}",
            code=MESSAGE_NOT_ENCODABLE,
            values={"type": self.template.__msgtype__},
        )

    def _arguments(self) -> list[str]:
        return [f"a{index}" for index in range(len(self._paths))]

    def _expression(
        self, value: Any, path: str, names: dict[str, Any], headers: dict[tuple[str, str], str]
    ) -> str:
        """The expression for a part of the message.

        Args:
            value: This part of the template.
            path: Its path in the message.
            names: Receives the global names that the expression uses.
            headers: Receives the local names of headers by the expressions of their time and frame.
        """
        index = self._argument.get(path)
        kind = getattr(value, "__msgtype__", None)
        if index is not None:
            if kind == _TIME:
                return f"stamp(a{index})"
            return f"a{index}" if kind is None else f"{_named(names, type(value))}(*a{index})"
        within = f"{path}." if path else ""
        if not any(each.startswith(within) for each in self._argument):
            return _named(names, value)
        if kind is None:
            parts = [
                self._expression(each, f"{within}{i}", names, headers)
                for i, each in enumerate(value)
            ]
            return f"[{', '.join(parts)}]"
        if kind == _HEADER and f"{within}stamp" in self._argument:
            frame = self._expression(value.frame_id, f"{within}frame_id", names, headers)
            time = f"a{self._argument[f'{within}stamp']}"
            return headers.setdefault((time, frame), f"h{len(headers)}")
        parts = [
            self._expression(getattr(value, field.name), f"{within}{field.name}", names, headers)
            for field in fields(kind)
        ]
        return f"{_named(names, message_class(kind))}({', '.join(parts)})"

    def _packer(self, name: str, data: bytes, places: Sequence[Place]) -> Pack:
        """The function that packs the values between the constant bytes of the template."""
        lines, leaves = list(self._leaves[0]), self._leaves[1]
        names: dict[str, Any] = {}
        given: list[str] = []
        form, at = "<", 0
        for place in places:
            if place.path not in leaves:
                continue
            local = leaves[place.path]
            form += _constant(names, given, data[at : place.at])
            at = place.at + place.size
            given.append(local)
            if place.count is None:
                form += place.code
                continue
            form += f"{place.size}s"
            if local in given[:-1]:
                continue
            lines += (
                f"{local} = {local}.tobytes()",
                f"if len({local}) != {place.size}:",
                f"    raise ValueError('{place.path} must have {place.count} values')",
            )
        form += _constant(names, given, data[at:])
        names["pack"] = struct.Struct(form).pack
        arguments = self._arguments()
        if name == "ros1":
            arguments.insert(0, leaves[SEQ])
        lines.append(f"return pack({', '.join(given)})")
        packer: Pack = _function(name, arguments, lines, names)
        return packer

    @functools.cached_property
    def _leaves(self) -> tuple[list[str], dict[str, str]]:
        """Lines that split values into numbers, and the variables by the paths of the numbers."""
        lines, leaves = [], {SEQ: "seq"}
        for index, paths in enumerate(self._paths):
            own = [_numbers(_value_at(self.template, path), path) for path in paths]
            value = _value_at(self.template, paths[0])
            kind = getattr(value, "__msgtype__", None)
            parts = [f"a{index}_{number}" for number in range(len(own[0]))]
            if kind is None:
                parts = [f"a{index}"]
            elif kind == _TIME:
                lines.append(f"{', '.join(parts)} = divmod(a{index}, {_SECOND})")
            else:
                lines.append(f"{', '.join(parts)}, = a{index}")
            for each in own:
                leaves |= dict(zip(each, parts, strict=True))
        return lines, leaves


def _value_at(message: Any, path: str) -> Any:
    """The value of a field of a message.

    Raises:
        ValueError: The message has no such field.
    """
    value = message
    for step in path.split("."):
        try:
            value = value[int(step)] if step.isdecimal() else getattr(value, step)
        except (AttributeError, LookupError) as error:
            raise ValueError(f"{message.__msgtype__} has no field {path}") from error
    return value


def _numbers(value: Any, path: str) -> list[str]:
    """The paths of the numbers or the array of which a value consists.

    Raises:
        ValueError: It consists of something else.
    """
    kind = getattr(value, "__msgtype__", None)
    if kind is None:
        if not isinstance(value, int | float | np.ndarray):
            raise ValueError(f"{path} does not consist of numbers")
        return [path]
    described = fields(kind)
    if any(field.array or field.kind in ("string", "message") for field in described):
        raise ValueError(f"{path} does not consist of numbers")
    return [f"{path}.{field.name}" for field in described]


def _named(names: dict[str, Any], value: Any) -> str:
    """The global name of a constant value. Equal texts, such as frames, have the same name, and so
    has each class.
    """
    if isinstance(value, str | type):
        for name, known in names.items():
            if isinstance(known, str | type) and known == value:
                return name
    name = f"c{len(names)}"
    names[name] = value
    return name


def _constant(names: dict[str, Any], given: list[str], data: bytes) -> str:
    """The `struct` code of constant bytes, which are one more argument unless all are zero."""
    if not any(data):
        return f"{len(data)}x" if data else ""
    given.append(_named(names, data))
    return f"{len(data)}s"


def _function(
    name: str, arguments: Sequence[str], lines: Sequence[str], names: dict[str, Any]
) -> Any:
    """Compiles a function with constant values.

    They are variables of an enclosing function. Many forms share the code, so Python would have to
    look up global names in each call.
    """
    inner = "\n        ".join((f"def {name}({', '.join(arguments)}):", *lines))
    text = f"def enclosing({', '.join(names)}):\n    {inner}\n    return {name}"
    if all(isinstance(value, str) or callable(value) for value in names.values()):
        return _shared(text, tuple(names.items()))
    return _enclosed(text, names)


@functools.lru_cache(256)
def _shared(text: str, names: tuple[tuple[str, Any], ...]) -> Any:
    """The function of all robots with the same frames: for the others, it is in the processor's
    caches.
    """
    return _enclosed(text, dict(names))


def _enclosed(text: str, names: dict[str, Any]) -> Any:
    made: dict[str, Any] = {}
    exec(_compiled(text), made)  # noqa: S102 - all names in it are made here
    return made["enclosing"](**names)


@functools.lru_cache(256)
def _compiled(text: str) -> Any:
    """The code of a function. Forms of the same type mostly share it, which saves most time."""
    return compile(text, "<form>", "exec")
