"""XML parameters of plugins, read once into frozen dataclasses."""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any, TypeVar, get_args, get_origin

from cartwheel.codes import devices
from cartwheel.description.elements import numbers
from cartwheel.description.elements.numbers import LARGEST
from cartwheel.description.model import Element
from cartwheel.dialects.tag_reports import kept, repeated, unknown
from cartwheel.dialects.tag_roles import JOINT_ROLES, Role, TagRole
from cartwheel.errors import Diagnostic, Origin, PluginError, Value

C = TypeVar("C")

_COMMON = {"ros", "robotNamespace", "alwaysOn", "always_on", "robotParam", "rosDebugLevel"}
"""Tags that the base class of all plugins reads, or that have no effect and need no report."""
_SHOWN = 80
"""Maximum length of a value in an error message."""
SMALLEST = 1e-9
"""Smallest value of parameters that must be positive, in SI units."""
_MOST_COUNT = 2**31 - 1
_SIZES: tuple[Role, ...] = ("wheel_separation", "wheel_base", "wheel_radius", "wheel_diameter")
_TRUE = {"true", "1", "yes", "on"}
_FALSE = {"false", "0", "no", "off"}


def tag(
    *names: str,
    default: Any = dataclasses.MISSING,
    unit: str = "",
    least: float | None = None,
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
        least: Smallest value, also of each component of a vector. `SMALLEST` for positive values,
            None for ``-most``.
        most: Largest value. Defaults to `LARGEST`, and for integers to 2**31 - 1.
        optional: Whether the plugin works without the joint that the default names.
        nested: Whether the tag contains other tags, which the plugin reads itself.
        role: Meaning of the tag, for the rules of ``cartwheel check``. A value in Hz is a rate.
        wheels: For a role that is a size: the fields with the joints of the measured wheels, two of
            them for a distance, and those of all wheels for a radius or diameter. Defaults to the
            fields whose roles are wheels.
        obsolete: Spellings that Gazebo 11 ignores.
        doc: Description for the plugin reference, one or two sentences. A last sentence
            ``Default: ...`` describes a default that depends on something else.
    """
    metadata = {
        "tags": names,
        "unit": unit,
        "least": least,
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


def spellings_of(cls: type, tag: str) -> tuple[str, ...]:
    """Returns all tags of the parameter that a tag of a dataclass sets; empty for another tag."""
    tags = (item.metadata["tags"] for item in dataclasses.fields(cls))
    return next((tuple(names) for names in tags if tag in names), ())


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
        roles.append(
            TagRole(
                role=role,
                tags=item.metadata["tags"],
                obsolete=item.metadata["obsolete"],
                default=default if isinstance(default, tuple) else (default,),
                wheels=tuple(measured) if role in _SIZES else (),
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
    hints = _hints(cls)  # type: ignore[arg-type]
    for item in dataclasses.fields(cls):  # type: ignore[arg-type]
        names: tuple[str, ...] = item.metadata["tags"]
        known |= {name.split("/")[0] for name in names}
        stated = next((child for name in names if (child := element.find(name)) is not None), None)
        if stated is not None:
            kind = hints[item.name]
            if get_origin(kind) is tuple and Ellipsis in get_args(kind):
                each = get_args(kind)[0]
                values[item.name] = tuple(
                    _value(each, _cut(each, child, diagnostics), item.metadata)
                    for name in names
                    for child in element.find_all(name)
                )
            else:
                diagnostics += repeated(stated, element.children)
                stated = _cut(kind, stated, diagnostics)
                try:
                    values[item.name] = _value(kind, stated, item.metadata)
                except PluginError as error:
                    if get_origin(kind) is not typing.Literal or not isinstance(item.default, str):
                        raise
                    # Gazebo's plugins warn, and keep the default.
                    diagnostics.append(kept(error, stated, item.default, get_args(kind)))
        elif item.default is dataclasses.MISSING:
            raise missing(element.tag, names[0], element.origin, hint=item.metadata["doc"])
    diagnostics += [unknown(child, known) for child in element.children if child.tag not in known]
    return cls(**values), diagnostics


@lru_cache(maxsize=256)
def _hints(cls: type) -> dict[str, Any]:
    """The types of a dataclass's fields, which take longer to resolve than to use."""
    return typing.get_type_hints(cls)


def _cut(kind: Any, element: Element, diagnostics: list[Diagnostic]) -> Element:
    """Reduces an element to the numbers that Gazebo reads, and reports the rest of its text."""
    kinds = {each for each in get_args(kind) or (kind,) if each is not type(None)}
    if not kinds or not kinds <= {int, float}:
        return element
    size = len(get_args(kind)) if get_origin(kind) is tuple else 1
    text = element.text.strip()
    found = numbers.leading(text, size)
    if found is None:
        return element
    used, rest = found
    if kinds == {int} and size == 1 and not rest:
        value = float(used)
        if math.isfinite(value) and value != int(value):
            used, rest = str(int(value)), text
    if not rest:
        return element
    words = text.split()
    if len(words) > size == 1 and all(numbers.leading(each) == (each, "") for each in words):
        diagnostics.append(
            devices.PLUGIN_PARAMETER_NOT_SINGLE.diagnostic(
                f"<{element.tag}> must be one number, but contains several, so {used} is used",
                origin=element.origin,
                values={"parameter": element.tag, "value": used},
                mark=f"<{element.tag}",
            )
        )
    else:
        diagnostics.append(numbers.text_after(element.tag, text, used, element.origin))
    return dataclasses.replace(element, text=used)


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


def number_at(
    element: Element | None, path: str, default: float = 0.0, *, endless: bool = False
) -> float:
    """Reads the number in a child; the default without the child or its parent. See `number`."""
    child = element.find(path) if element is not None else None
    return number(child, endless=endless) if child is not None else default


def required(element: Element, name: str) -> Element:
    """Returns a child.

    Raises:
        PluginError: The child is missing.
    """
    child = element.find(name)
    if child is None:
        raise missing(element.tag, name, element.origin)
    return child


def vector(element: Element, size: int) -> tuple[float, ...]:
    """Reads the numbers in an element, separated by white space.

    Raises:
        PluginError: There are more or fewer than `size` numbers, or one is invalid; see `number`.
    """
    return _vector(element, size, None, LARGEST)


def _value(kind: Any, element: Element, metadata: Mapping[str, Any]) -> Any:
    least, most = metadata["least"], metadata["most"]
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
        return _number(element, text, least, LARGEST if most is None else most)
    if kind is int:
        number = _number(element, text, least, _MOST_COUNT if most is None else most)
        if number != int(number):
            raise invalid(element.tag, text, "a whole number", element.origin)
        return int(number)
    if get_origin(kind) is tuple:
        return _vector(element, len(options), least, LARGEST if most is None else most)
    return text


def _vector(element: Element, size: int, least: float | None, most: float) -> tuple[float, ...]:
    words = element.text.split()
    if len(words) != size:
        raise invalid(element.tag, element.text.strip(), f"{size} numbers", element.origin)
    return tuple(_number(element, word, least, most) for word in words)


def _number(
    element: Element, text: str, least: float | None, most: float, *, endless: bool = False
) -> float:
    try:
        number = float(text)
    except ValueError:
        raise invalid(element.tag, text, "a number", element.origin) from None
    if endless and abs(number) > LARGEST:
        return math.copysign(math.inf, number)
    if least is not None and number < least:
        raise invalid(element.tag, number, _wanted(number, least, most), element.origin)
    if not (-most if least is None else least) <= number <= most:
        wanted = f"a number between {-most if least is None else least:g} and {most:g}"
        raise invalid(element.tag, text, wanted, element.origin)
    return number


def _wanted(number: float, least: float, most: float) -> str:
    """The allowed values of a number that is too small."""
    if least == SMALLEST:
        return "positive" if number <= 0 else f"at least {least:g}"
    if most in (LARGEST, _MOST_COUNT):
        return f"at least {least:g}"
    return f"between {least:g} and {most:g}"


def shown(text: str) -> str:
    """Returns a value for an error message, shortened if it is long."""
    text = text.strip()
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
