"""XML parameters of plugins, read once into frozen dataclasses."""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Iterable
from typing import Any, TypeVar, get_args, get_origin

from cartwheel.codes import devices
from cartwheel.description.elements.numbers import LARGEST
from cartwheel.description.model import Element
from cartwheel.dialects.tag_roles import JOINT_ROLES, Role, TagRole
from cartwheel.errors import Diagnostic, Origin, PluginError, Value
from cartwheel.similar_names import meant_one

C = TypeVar("C")

_COMMON = {"ros", "robotNamespace", "alwaysOn", "always_on", "robotParam", "rosDebugLevel"}
"""Tags that the base class of all plugins reads, or that have no effect and need no report."""
_SHOWN = 80
"""Maximum length of a value in an error message."""
SMALLEST = 1e-9
"""Smallest value of parameters that must be positive, in SI units."""
_MOST_COUNT = 2**31 - 1
_TRUE = {"true", "1", "yes", "on"}
_FALSE = {"false", "0", "no", "off"}


def tag(
    *names: str,
    default: Any = dataclasses.MISSING,
    unit: str = "",
    most: float | None = None,
    optional: bool = False,
    nested: bool = False,
    role: Role = "",
    wheels: tuple[str, ...] = (),
    obsolete: tuple[str, ...] = (),
    doc: str,
) -> Any:
    """Declares a dataclass field that is read from a tag.

    Args:
        names: The tag and its alternative spellings; the first one that exists is read. ``a/b`` is
            a nested tag.
        default: Value if none of the tags exists. Without a default, the tag is required.
        unit: SI unit of the value.
        most: Largest magnitude. Defaults to `LARGEST`, and for integers to 2**31 - 1.
        optional: Whether the plugin works without the joint that the default names.
        nested: Whether the tag contains other tags, which the plugin reads itself.
        role: Meaning of the tag, for the rules of ``cartwheel check``. A value in Hz is a rate.
        wheels: For a role that is a size: the fields with the joints of the measured wheels, two of
            them for a distance. Defaults to the fields whose roles are wheels.
        obsolete: Spellings that Gazebo 11 ignores.
        doc: Description for the plugin reference, one or two sentences. A last sentence
            ``Default: ...`` describes a default that depends on something else.
    """
    metadata = {
        "tags": names,
        "unit": unit,
        "most": most,
        "optional": optional,
        "nested": nested,
        "role": role or ("rate" if unit == "Hz" else ""),
        "wheels": wheels,
        "obsolete": obsolete,
        "doc": doc,
    }
    if default is dataclasses.MISSING:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def tags_of(cls: type) -> set[str]:
    """Returns all tags that a parameter dataclass reads."""
    return {name for item in dataclasses.fields(cls) for name in item.metadata["tags"]}


def roles_of(cls: type) -> tuple[TagRole, ...]:
    """Returns the tags of a parameter dataclass that have a role."""
    fields = {item.name: item for item in dataclasses.fields(cls)}
    sides: list[tuple[str, ...]] = [
        tuple(
            name
            for item in fields.values()
            if item.metadata["role"] in (f"{side}_wheel", f"{side}_wheels")
            for name in item.metadata["tags"]
        )
        for side in ("left", "right")
    ]
    roles = []
    for item in fields.values():
        role: Role = item.metadata["role"]
        if not role:
            continue
        default = item.default
        if default in (dataclasses.MISSING, None):
            default = ()
        measured = [fields[name].metadata["tags"] for name in item.metadata["wheels"]] or sides
        count = {"wheel_separation": 2, "wheel_base": 2, "wheel_radius": 1, "wheel_diameter": 1}
        roles.append(
            TagRole(
                role=role,
                tags=item.metadata["tags"],
                obsolete=item.metadata["obsolete"],
                default=default if isinstance(default, tuple) else (default,),
                wheels=tuple(measured[: count.get(role, 0)]),
            )
        )
    return tuple(roles)


def default_joints(cls: type, element: Element) -> list[tuple[tuple[str, ...], str]]:
    """The joints that a plugin uses because no tag names one.

    Returns:
        For each of them the tag's spellings and the joint's name.
    """
    joints = []
    for item in dataclasses.fields(cls):
        names: tuple[str, ...] = item.metadata["tags"]
        if item.metadata["role"] not in JOINT_ROLES or item.metadata["optional"]:
            continue
        if item.default in (dataclasses.MISSING, ""):
            continue
        if not any(element.find(name) is not None for name in names):
            defaults = item.default if isinstance(item.default, tuple) else (item.default,)
            joints += [(names, str(each)) for each in defaults]
    return joints


def read(
    cls: type[C], element: Element, *, ignore: Iterable[str] = ()
) -> tuple[C, list[Diagnostic]]:
    """Fills a parameter dataclass and reports unsupported tags.

    Args:
        cls: The dataclass, with fields from `tag`.
        element: The element that contains the tags.
        ignore: Additional tags to accept without a report.

    Returns:
        The parameters and the diagnostics.

    Raises:
        PluginError: A value has the wrong type, or a required tag is missing.
    """
    values: dict[str, Any] = {}
    diagnostics: list[Diagnostic] = []
    known = set(_COMMON) | set(ignore)
    hints = typing.get_type_hints(cls)
    for item in dataclasses.fields(cls):  # type: ignore[arg-type]
        names: tuple[str, ...] = item.metadata["tags"]
        known |= {name.split("/")[0] for name in names}
        stated = next((child for name in names if (child := element.find(name)) is not None), None)
        if stated is not None:
            kind = hints[item.name]
            if kind in (float, float | None) and len(stated.text.split()) > 1:
                stated, diagnostic = _first(stated)
                diagnostics.append(diagnostic)
            if get_origin(kind) is tuple and Ellipsis in get_args(kind):
                values[item.name] = tuple(
                    _value(get_args(kind)[0], child, item.metadata["most"])
                    for name in names
                    for child in element.find_all(name)
                )
            else:
                values[item.name] = _value(kind, stated, item.metadata["most"])
        elif item.default is dataclasses.MISSING:
            raise missing(element.tag, names[0], element.origin, hint=item.metadata["doc"])
    diagnostics += [_unknown(child, known) for child in element.children if child.tag not in known]
    return cls(**values), diagnostics


def _unknown(element: Element, known: Iterable[str]) -> Diagnostic:
    meant = meant_one(element.tag, sorted(known))
    return devices.PLUGIN_PARAMETER_UNKNOWN.diagnostic(
        f"<{element.tag}> has no effect: the plugin does not support this tag",
        origin=element.origin,
        hint=f"Did you mean <{meant}>?" if meant else "",
        values={"parameter": element.tag, "meant": meant},
        mark=f"<{element.tag}",
    )


def _first(element: Element) -> tuple[Element, Diagnostic]:
    """Reduces an element to its first word, which Gazebo reads if it expects a single number."""
    word = element.text.split()[0]
    return dataclasses.replace(element, text=word), devices.PLUGIN_PARAMETER_NOT_SINGLE.diagnostic(
        f"<{element.tag}> must be one number, but contains several, so {word} is used",
        origin=element.origin,
        values={"parameter": element.tag, "value": word},
        mark=f"<{element.tag}",
    )


def invalid(name: str, value: Value, wanted: str, origin: Origin | None) -> PluginError:
    """Returns the error for a parameter whose value is not allowed.

    Args:
        name: The tag.
        value: The specified value.
        wanted: The allowed values, as they follow "must be" in the message.
        origin: File and line of the tag.
    """
    stated = f"{value:g}" if isinstance(value, float) else f'"{shown(str(value))}"'
    return PluginError(
        f"<{name}> must be {wanted} (got {stated})",
        code=devices.PLUGIN_PARAMETER_INVALID,
        origin=origin,
        values={"parameter": name, "value": value},
        mark=f"<{name}",
    )


def missing(parent: str, name: str, origin: Origin | None, *, hint: str = "") -> PluginError:
    """Returns the error for a required tag that is missing in its parent, which is at `origin`."""
    return PluginError(
        f"<{parent}> requires <{name}>",
        code=devices.PLUGIN_PARAMETER_MISSING,
        origin=origin,
        hint=hint,
        values={"parameter": name},
    )


def number(
    element: Element,
    *,
    least: float = -LARGEST,
    most: float = LARGEST,
    endless: bool = False,
) -> float:
    """Reads the number in an element of a plugin or sensor.

    Args:
        element: The element whose text is the number.
        least: Smallest allowed number.
        most: Largest allowed number.
        endless: Allow infinity. Numbers beyond `LARGEST` become infinite.

    Raises:
        PluginError: The text is not a number, or the number is not between `least` and `most`.
    """
    return _number(element, element.text.strip(), least, most, endless=endless)


def vector(element: Element, size: int) -> tuple[float, ...]:
    """Reads the numbers in an element, separated by white space.

    Raises:
        PluginError: There are more or fewer than `size` numbers, or one is invalid; see `number`.
    """
    return _vector(element, size, LARGEST)


def _value(kind: Any, element: Element, most: float | None) -> Any:
    text = element.text.strip()
    options = get_args(kind)
    if type(None) in options:
        kind = next(option for option in options if option is not type(None))
        options = get_args(kind)
    if get_origin(kind) is typing.Literal:
        if text not in options:
            wanted = f"one of {', '.join(map(str, options))}"
            raise invalid(element.tag, text, wanted, element.origin)
        return text
    if kind is bool:
        if text.lower() in _TRUE | _FALSE:
            return text.lower() in _TRUE
        raise invalid(element.tag, text, "true or false", element.origin)
    if kind is float:
        most = LARGEST if most is None else most
        return _number(element, text, -most, most)
    if kind is int:
        most = _MOST_COUNT if most is None else most
        number = _number(element, text, -most, most)
        if number != int(number):
            raise invalid(element.tag, text, "a whole number", element.origin)
        return int(number)
    if get_origin(kind) is tuple:
        return _vector(element, len(options), LARGEST if most is None else most)
    return text


def _vector(element: Element, size: int, most: float) -> tuple[float, ...]:
    words = element.text.split()
    if len(words) != size:
        raise invalid(element.tag, element.text.strip(), f"{size} numbers", element.origin)
    return tuple(_number(element, word, -most, most) for word in words)


def _number(
    element: Element, text: str, least: float, most: float, *, endless: bool = False
) -> float:
    try:
        number = float(text)
    except ValueError:
        raise invalid(element.tag, text, "a number", element.origin) from None
    if endless and abs(number) > LARGEST:
        return math.copysign(math.inf, number)
    if not least <= number <= most:
        wanted = f"a number between {least:g} and {most:g}"
        raise invalid(element.tag, text, wanted, element.origin)
    return number


def shown(text: str) -> str:
    """Returns a value for an error message, shortened if it is long."""
    text = text.strip()
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
