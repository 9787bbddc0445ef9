"""Parameters of controllers: declared in tables, and read into frozen dataclasses.

A controller type declares its parameters as the fields of a dataclass. The same table serves to
load the controller, to check controller files, and to write the tables in ``docs/controllers.md``.
"""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar, get_args

from cartwheel.dialects.ros_control.settings import Settings

C = TypeVar("C")

Role = Literal[
    "",
    "joint",
    "interface",
    "gains",
    "front_steering",
    "wheel_separation",
    "wheel_base",
    "wheel_reach",
    "wheel_radius",
]
"""Meaning of a parameter, for loading and for the rules of ``cartwheel check``.

- ``joint``: one or several joints.
- ``interface``: the interface by which the controller commands its joints.
- ``gains``: the gains of a PID controller; ``{joint}`` in its name stands for each joint.
- ``front_steering``: whether the front axle is steered; defines ``{driven}`` and ``{steered}``.
- ``wheel_separation``: distance between wheels across the robot; ``wheel_base``: along it;
  ``wheel_reach``: half the sum of both.
"""
SIZES: tuple[Role, ...] = ("wheel_separation", "wheel_base", "wheel_reach", "wheel_radius")
OWN = "own"
"""The interface that the controller's type or its parameters name."""
_FRONT = {"driven": "rear", "steered": "front"}
_REAR = {"driven": "front", "steered": "rear"}


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """A parameter in one ROS version."""

    field: str
    names: tuple[str, ...]
    """The name and its alternatives; the first one that exists is read."""
    default: Any
    """`dataclasses.MISSING` for a required parameter."""
    kind: str
    """``number``, ``list of names`` and so on; empty if the parameter has no effect."""
    unit: str
    role: Role
    interface: str
    """For a joint that the controller commands: the interface, or `OWN`."""
    wheels: tuple[str, ...]
    """For a size: the fields with the joints of the measured wheels."""
    doc: str

    def spelled(self, *, front_steering: bool = True) -> tuple[str, ...]:
        """The names without placeholders for axles."""
        return _spelled(self.names, front_steering=front_steering)


def parameter(
    *names: str,
    ros1: tuple[str, ...] | None = None,
    ros2: tuple[str, ...] | None = None,
    default: Any = dataclasses.MISSING,
    unit: str = "",
    role: Role = "",
    interface: str = "",
    wheels: tuple[str, ...] = (),
    positive: bool = False,
    read: Callable[[Settings], Any] | None = None,
    itself: bool = False,
    doc: str,
) -> Any:
    """Declares a dataclass field that is read from a parameter.

    Args:
        names: The parameter and its alternatives; the first one that exists is read.
        ros1: Names in ROS 1, if they are different; empty if it does not exist in ROS 1.
        ros2: Names in ROS 2.
        default: Value if none exists. Without a default, the parameter is required.
        unit: SI unit of the value, unless the documentation states another one.
        role: Its meaning.
        interface: For joints that the controller commands: the interface, or `OWN`.
        wheels: For a size: the fields with the joints of the measured wheels. A distance has two,
            or one if the wheels on the other axle are not driven.
        positive: Whether the number must be positive.
        read: Reads a group of parameters from the section with this name.
        itself: Whether the controller reads the parameter itself, because it depends on others.
        doc: Description for the reference.
    """
    metadata = {
        "ros1": names if ros1 is None else ros1,
        "ros2": names if ros2 is None else ros2,
        "unit": unit,
        "role": role,
        "interface": interface,
        "wheels": wheels,
        "positive": positive,
        "read": read,
        "itself": itself,
        "doc": doc,
    }
    if default is dataclasses.MISSING:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def ros2_parameter(*names: str, **keywords: Any) -> Any:
    """Declares a parameter that exists only in ROS 2; see `parameter`."""
    return parameter(ros1=(), ros2=names, **keywords)


def ignored(
    *names: str, ros2: tuple[str, ...] | None = None, role: Role = "", doc: str = "No effect."
) -> Any:
    """Declares parameters that the table does not read.

    Either they have no effect, but published files contain them, or the controller reads them
    itself because their names contain a joint: ``{joint}``.
    """
    return parameter(*names, ros2=ros2, default=None, role=role, doc=doc)


@functools.cache
def rows(table: type, *, ros2: bool) -> tuple[Row, ...]:
    """The parameters in one ROS version."""
    hints = _hints(table)
    found = []
    for item in dataclasses.fields(table):
        data = item.metadata
        names = data["ros2" if ros2 else "ros1"]
        if names:
            found.append(
                Row(
                    field=item.name,
                    names=names,
                    default=item.default,
                    kind="group" if data["read"] else _kind(hints[item.name]),
                    **{key: data[key] for key in ("unit", "role", "interface", "wheels", "doc")},
                )
            )
    return tuple(found)


def read_parameters_of(table: type[C], settings: Settings, *, ros2: bool) -> C:
    """Fills a table from the parameters of a controller.

    Raises:
        PluginError: A value has the wrong type, or a required parameter is missing.
    """
    hints = _hints(table)
    values: dict[str, Any] = {}
    front = True
    for item in dataclasses.fields(table):  # type: ignore[arg-type]
        data = item.metadata
        names = _spelled(data["ros2" if ros2 else "ros1"], front_steering=front)
        if not names or data["itself"]:
            continue
        if data["read"] is not None:
            values[item.name] = data["read"](settings.section(names[0]))
            continue
        kind = hints[item.name]
        if kind is type(None):
            settings.ignore(*(name for name in names if "{" not in name))
            continue
        # An empty list counts as missing.
        stated = next((each for each in names if settings.raw(each) not in (None, [])), None)
        name = stated or names[0]
        value = _value(kind, settings, name, item.default)
        if data["positive"] and stated and value is not None and value <= 0:
            raise settings.invalid(name, value, "positive")
        values[item.name] = value
        if data["role"] == "front_steering":
            front = value
    return table(**values)


def _value(kind: Any, settings: Settings, name: str, default: Any) -> Any:
    given = () if default is dataclasses.MISSING else (default,)
    if kind == float | None:
        return settings.optional_number(name)
    if kind == str | None:
        return settings.text(name) if settings.has(name) else default
    if kind == tuple[str, ...]:
        return tuple(settings.texts(name, *given))
    if kind == tuple[float, ...]:
        return tuple(settings.numbers(name, *given))
    return _READERS[kind](settings, name, *given)


_READERS: Mapping[Any, Callable[..., Any]] = {
    float: Settings.number,
    int: Settings.integer,
    bool: Settings.boolean,
    str: Settings.text,
}


def _kind(hint: Any) -> str:
    known = {
        float: "number",
        int: "whole number",
        bool: "true or false",
        str: "name",
        tuple[str, ...]: "list of names",
        tuple[float, ...]: "list of numbers",
    }
    plain = next((each for each in get_args(hint) if each in known), hint)
    return known.get(hint, known.get(plain, ""))


def _hints(table: Any) -> dict[str, Any]:
    return typing.get_type_hints(table)


def _spelled(names: tuple[str, ...], *, front_steering: bool) -> tuple[str, ...]:
    axles = _FRONT if front_steering else _REAR
    return tuple(
        name.replace("{driven}", axles["driven"]).replace("{steered}", axles["steered"])
        for name in names
    )
