"""Conversion between messages and plain mappings, as in YAML and JSON."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cartwheel.codes.graph import FIELD_UNKNOWN, FIELD_VALUE_INVALID
from cartwheel.errors import GraphError, Value
from cartwheel.messages.classes import FILLER
from cartwheel.messages.field import Field, empty
from cartwheel.messages.fields import fields
from cartwheel.messages.fitting import fits
from cartwheel.messages.singles import single
from cartwheel.messages.store import message_class
from cartwheel.similar_names import meant, suggestion

_ROS1_NAMES: dict[str, dict[str, str | None]] = {
    "builtin_interfaces/msg/Time": {"secs": "sec", "nsecs": "nanosec"},
    "builtin_interfaces/msg/Duration": {"secs": "sec", "nsecs": "nanosec"},
    "std_msgs/msg/Header": {"seq": None},
    "sensor_msgs/msg/CameraInfo": {"D": "d", "K": "k", "R": "r", "P": "p"},
}
"""ROS 1 names of fields, for values pasted from ROS 1. None means that the field is ignored."""
TIMES = frozenset({"builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"})
"""Types for which a number of seconds can be given."""


def to_dict(message: Any) -> dict[str, Any]:
    """Converts a message to mappings, lists, numbers and strings.

    Args:
        message: Instance of a class from `message_class`.
    """
    return {field.name: _plain(field, getattr(message, field.name)) for field in _of(message)}


def from_dict(
    type_name: str, mapping: Mapping[str, Any] | Sequence[Any], *, strict: bool = False
) -> Any:
    """Creates a message from YAML or JSON values.

    Omitted fields have their default values: those that the definition states in ROS 2, such as 1
    for the w of a quaternion; otherwise zero or empty.

    ROS 1 field names (``secs``, ``seq``, ``K``) are accepted. A list contains the fields of a
    message in order, as in ``rostopic pub``. A number stands for a time or duration in s.

    Args:
        type_name: ``geometry_msgs/msg/Twist`` or ``geometry_msgs/Twist``.
        mapping: Values by field, which may contain numpy arrays and messages.
        strict: Whether the values come from a Python program instead of YAML. Then None is not a
            value, a text such as ``1e-3`` is not a number, and messages are checked.

    Raises:
        UnknownNameError: The type does not exist.
        GraphError: A field does not exist, or a value does not fit. The error names the field.
    """
    return _message(message_class(type_name), mapping, "", strict)


def from_flat(type_name: str, values: Mapping[str, Any], *, strict: bool = False) -> Any:
    """Creates a message from nested fields, whose names are joined by ``_``.

    Args:
        type_name: ``geometry_msgs/msg/Twist`` or ``geometry_msgs/Twist``.
        values: Values as keyword arguments provide them: ``{"linear_x": 0.5}``.
        strict: See `from_dict`.

    Raises:
        UnknownNameError: The type does not exist.
        GraphError: A field does not exist, or a value does not fit. The error names the field.
    """
    mapping: dict[str, Any] = {}
    full = message_class(type_name).__msgtype__
    for name, value in values.items():
        inner = mapping
        *outer, last = _split(full, name)
        for part in outer:
            inner = inner.setdefault(part, {})
        inner[last] = value
    return from_dict(full, mapping, strict=strict)


def checked(message: Any) -> Any:
    """The message of a Python program, with the types of its fields.

    Values are converted as those of `from_dict`: a list of numbers becomes an array, and a number
    of seconds a duration. A message that needs no conversion is returned itself.

    Raises:
        GraphError: A value does not fit. The error names the field.
    """
    return message if fits(message) else _fitted(message, "")


def _fitted(message: Any, path: str) -> Any:
    """A copy of a message, with the types of its fields."""
    cls = message_class(message.__msgtype__)
    values = {
        field.name: _value(field, getattr(message, field.name), f"{path}{field.name}", True)
        for field in fields(cls.__msgtype__)
    }
    return cls(**values) if values else message


def _split(type_name: str, name: str, outer: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The field path of a joined name. Field names may contain ``_`` themselves."""
    known = fields(type_name)
    inner = [
        field
        for field in known
        if field.kind == "message" and not field.array and name.startswith(f"{field.name}_")
    ]
    if any(field.name == name for field in known):
        return (*outer, name)
    if inner:
        longest = max(inner, key=lambda field: len(field.name))
        rest = name.removeprefix(f"{longest.name}_")
        return _split(longest.type, rest, (*outer, longest.name))
    written = f'"{"_".join((*outer, name))}": ' if outer else ""
    names = [field.name for field in known]
    path = ".".join((*outer, name))
    raise GraphError(
        f'{written}{type_name} has no field "{path}"',
        code=FIELD_UNKNOWN,
        hint=suggestion(name, names),
        values={"type": type_name, "field": path, "meant": meant(name, names)},
    )


def zero(type_name: str) -> Any:
    """Creates a message whose fields have their default values; see `from_dict`.

    Raises:
        UnknownNameError: The type does not exist.
    """
    return _message(message_class(type_name), {}, "", False)


def recast(message: Any, type_name: str) -> Any:
    """Converts a message to a different type. Fields that only that type has have their defaults.

    Nested values are not converted. Use it for types that differ in their package or in
    missing fields.

    Raises:
        UnknownNameError: The type does not exist.
    """
    made = zero(type_name)
    for field in fields(type_name):
        if hasattr(message, field.name):
            setattr(made, field.name, getattr(message, field.name))
    return made


def _of(message: Any) -> tuple[Field, ...]:
    name = getattr(message, "__msgtype__", None)
    if name is None:
        raise GraphError(
            f"{type(message).__name__} is not a message",
            code=FIELD_VALUE_INVALID,
            values={"type": type(message).__name__},
        )
    return fields(name)


def _plain(field: Field, value: Any) -> Any:
    if not field.array:
        return _plain_one(field, value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain_one(field, item) for item in value]


def _plain_one(field: Field, value: Any) -> Any:
    if field.kind == "message":
        return to_dict(value)
    return _plain_number(value)


def _message(cls: Any, given: Any, path: str, strict: bool) -> Any:
    if isinstance(given, cls):
        return _fitted(given, path) if strict and not fits(given) else given
    given = _plain_number(given)
    wanted = fields(cls.__msgtype__)
    values = dict.fromkeys(field.name for field in wanted)
    for name, value in _by_name(cls.__msgtype__, given, path, strict).items():
        field = next(field for field in wanted if field.name == name)
        values[name] = _value(field, value, f"{path}{name}", strict)
    for field in wanted:
        if values[field.name] is None:
            values[field.name] = empty(field, zero)
    if FILLER in cls.__dataclass_fields__:
        return cls(**{FILLER: 0})
    return cls(**values)


def _by_name(type_name: str, given: Any, path: str, strict: bool) -> dict[str, Any]:
    """The given values, by the field names of the message classes."""
    names = [field.name for field in fields(type_name)]
    if type_name in TIMES and isinstance(given, int | float) and not isinstance(given, bool):
        return _parts(float(given))
    if isinstance(given, Mapping):
        aliases = _ROS1_NAMES.get(type_name, {})
        result = {}
        for key, value in given.items():
            name = aliases.get(key, key) if key not in names else key
            if name is None:
                continue
            if name not in names:
                raise GraphError(
                    f'{type_name} has no field "{path}{key}"',
                    code=FIELD_UNKNOWN,
                    hint=suggestion(str(key), names),
                    values={
                        "type": type_name,
                        "field": f"{path}{key}",
                        "meant": meant(str(key), names),
                    },
                )
            result[name] = value
        return result
    if isinstance(given, Sequence) and not isinstance(given, str | bytes):
        if len(given) != len(names):
            raise _invalid(
                path,
                f"{type_name} has {len(names)} fields, but the list has {len(given)} values",
                hint=f"Fields: {', '.join(names) or 'none'}.",
                type=type_name,
                count=len(given),
            )
        return dict(zip(names, given, strict=True))
    if given is None and not strict:
        return {}
    raise _invalid(
        path,
        f"{_shown(given)} is not a valid {type_name}",
        hint=f"Use the form {{{', '.join(f'{name}: …' for name in names)}}}.",
        type=type_name,
        value=_shown(given),
    )


def _parts(seconds: float) -> dict[str, Any]:
    """The fields of a time or duration in seconds."""
    if not math.isfinite(seconds):
        return {"sec": seconds}  # refused as any other value
    whole, rest = divmod(round(seconds * 1_000_000_000), 1_000_000_000)
    return {"sec": whole, "nanosec": rest}


def _value(field: Field, value: Any, path: str, strict: bool) -> Any:
    if value is None and not strict:
        return None
    if not field.array:
        return _one(field, value, path, strict)
    if isinstance(value, bytes | bytearray | memoryview) and field.type == "uint8":
        value = np.frombuffer(value, dtype=np.uint8)
    value = _plain_number(value)
    if isinstance(value, str | Mapping) or not isinstance(value, Sequence | np.ndarray):
        raise _unexpected(path, f"a list for {field.described}", value, "Use the form [a, b, …].")
    if field.length is not None and len(value) != field.length:
        raise _miscounted(path, f"{field.length} values for {field.described}", value)
    if field.most and len(value) > field.most:
        raise _miscounted(path, f"at most {field.most} values for {field.described}", value)
    if field.kind in ("message", "string"):
        return [_one(field, item, f"{path}[{index}]", strict) for index, item in enumerate(value)]
    return _numbers(field, value, path, strict)


def _numbers(field: Field, value: Any, path: str, strict: bool) -> Any:
    dtype = np.dtype(field.type)
    try:
        array = np.asarray(value)
    except ValueError:
        # Nested lists with different lengths.
        array = np.array([], dtype=object)
    alike = array.dtype == dtype or (field.kind == "float" and array.dtype.kind in "iuf")
    if array.ndim == 1 and alike:
        return array.astype(dtype, copy=False)
    # Values that are checked one by one have their index in the error.
    items = [_one(field, item, f"{path}[{index}]", strict) for index, item in enumerate(value)]
    return np.array(items, dtype=dtype)


def _plain_number(value: Any) -> Any:
    """A number of numpy, also an array without dimensions, as one of Python."""
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        return value.item()
    return value


def _one(field: Field, value: Any, path: str, strict: bool) -> Any:
    if field.kind == "message":
        return _message(message_class(field.type), value, f"{path}.", strict)
    value = _plain_number(value)
    if field.kind == "string":
        if isinstance(value, str) and field.longest and len(value) > field.longest:
            raise _miscounted(path, f"at most {field.longest} characters", value)
        if isinstance(value, str):
            return value
        quoted = f'Put the value in quotes: "{value}".' if isinstance(value, int | float) else None
        raise _unexpected(path, "a string", value, quoted)
    if field.kind == "bool":
        if isinstance(value, bool) or (isinstance(value, int) and value in (0, 1)):
            return bool(value)
        raise _unexpected(path, "true or false", value)
    if field.kind == "float":
        return _float(field, value, path, strict)
    return _int(field, value, path)


def _float(field: Field, value: Any, path: str, strict: bool) -> float:
    convert = single if field.type == "float32" else float
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return convert(value)
        except OverflowError:
            shown = _shown(value)
            raise _invalid(path, f"{shown} is too large for {field.type}", value=shown) from None
    if isinstance(value, str) and not strict:
        # YAML 1.1 reads 1e-3 and nan as strings.
        with contextlib.suppress(ValueError):
            number = float(value.strip().replace(".inf", "inf").replace(".nan", "nan"))
            return _float(field, number, path, strict)
    raise _unexpected(path, "a number", value)


def _int(field: Field, value: Any, path: str) -> int:
    if isinstance(value, float) and math.isfinite(value) and value == int(value):
        value = int(value)
    if not isinstance(value, int):
        raise _unexpected(path, f"a whole number for {field.type}", value)
    limits = np.iinfo(field.type)
    if not limits.min <= int(value) <= limits.max:
        why = f"{value} is out of range for {field.type}: {limits.min} to {limits.max}"
        raise _invalid(path, why, value=_shown(value))
    return int(value)


def _unexpected(path: str, wanted: str, value: Any, hint: str | None = None) -> GraphError:
    shown = _shown(value)
    return _invalid(path, f"expected {wanted}, got {shown}", hint=hint, value=shown)


def _miscounted(path: str, wanted: str, value: Any) -> GraphError:
    return _invalid(path, f"expected {wanted}, got {len(value)}", count=len(value))


def _invalid(path: str, why: str, *, hint: str | None = None, **values: Value) -> GraphError:
    """The error for a value that does not fit its field, or the message if `path` is empty."""
    field = path.rstrip(".")
    return GraphError(
        f"{field or 'the message'}: {why}",
        code=FIELD_VALUE_INVALID,
        hint=hint,
        values={"field": field, **values},
    )


def _shown(value: Any) -> str:
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "…"
