"""The conditions of a scenario."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from cartwheel.arrays import single
from cartwheel.codes.command import SCENARIO_EXPRESSION, SCENARIO_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.messages import zero
from cartwheel.scenarios.expressions import NAME_HINT, ExpressionFaultError, evaluate, function
from cartwheel.testing.conditions import (
    Condition,
    JointAt,
    Moves,
    Reaches,
    StaysWithin,
    tilt_of,
)
from cartwheel.testing.publishing import Publishes
from cartwheel.testing.seeing import Sees
from cartwheel.testing.subjects import others, pose_of
from cartwheel.testing.touching import GROUND, Touches
from cartwheel.testing.watching import Watch, default_when

if TYPE_CHECKING:
    from cartwheel.api import ContactRecord, World
    from cartwheel.geometry import Pose

T = TypeVar("T")
_AXES = ("x", "y", "z")


class Expression(Condition):
    """An expression is true.

    Args:
        text: The expression; `names_of` lists its functions.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text
        self._names: dict[str, Any] = {}
        self._value: Any = None
        self._seen: dict[str, Any] = {}
        self._messages: dict[str, Any] = {}
        self._records: dict[str, ContactRecord] = {}
        self._ends: list[Callable[[], None]] = []

    def begin(self, world: World) -> None:
        super().begin(world)
        self._names = self._names_of(world)
        # Subscribes to the topics of the expression, and finds mistakes.
        self.holds()

    def close(self) -> None:
        for end in self._ends:
            end()
        self._ends.clear()
        self._records.clear()
        self._names = {}
        super().close()

    def holds(self) -> bool:
        self._seen = {}
        names = {**self._names, "time": self.world.time}
        try:
            self._value = evaluate(self.text, names)
        except ExpressionFaultError as error:
            raise CartwheelError(
                f'the expression "{self.text}" cannot be evaluated: {error.reason}',
                code=SCENARIO_EXPRESSION,
                hint=f"{error.hint} {NAME_HINT}".strip()
                if "is not defined" in error.reason
                else error.hint,
                values={"expression": self.text},
            ) from None
        if not isinstance(self._value, bool | np.bool_):
            raise CartwheelError(
                f'the value of the expression "{self.text}" must be true or false '
                f"(got {_brief(self._value):.60})",
                code=SCENARIO_EXPRESSION,
                hint="Compare it with something, such as x('cart') > 1.",
                values={"expression": self.text},
            )
        return bool(self._value)

    def _names_of(self, world: World) -> dict[str, Any]:
        def place(name: str) -> Pose:
            return pose_of(world, str(name))

        def of(name: str, value_of: Callable[[Pose], float]) -> Any:
            def run(model: str) -> float:
                return self._noted(f"{name}('{model}')", value_of(place(model)))

            return function(name, run)

        def distance(one: str, other: str) -> float:
            value = math.dist(place(one).position, place(other).position)
            return self._noted(f"distance('{one}', '{other}')", value)

        def clearance(one: str, other: str) -> float:
            # NaN if a pattern matches only the model or link itself.
            found = others(world, str(one), str(other))
            value = world.clearance(str(one), found).distance if found else math.nan
            return self._noted(f"clearance('{one}', '{other}')", value)

        def peak_force(one: str, other: str | None = None) -> float:
            key = one if other is None else f"{one}', '{other}"
            if key not in self._records:
                record = self._records[key] = world.record_contacts(
                    between=one if other is None else (one, other),
                    ignore=GROUND if other is None and GROUND in world.models else (),
                )
                self._ends.append(record.close)
            return self._noted(f"peak_force('{key}')", self._records[key].peak_force)

        def joint(model: str, name: str) -> float:
            value = world.model(str(model)).joint(str(name))
            return self._noted(f"joint('{model}', '{name}')", value)

        def count(topic: str) -> int:
            return int(self._noted(f"count('{topic}')", self._box(str(topic))[0]))

        def field(topic: str, path: str, default: float = math.nan) -> Any:
            message = self._box(str(topic))[1]
            if message is None:
                single(zero(world.graph.topic(str(topic)).type), str(path))  # finds mistakes
            value = default if message is None else single(message, str(path))
            return self._noted(f"field('{topic}', '{path}')", value)

        values: dict[str, Callable[[Pose], float]] = {
            "x": lambda pose: pose.x,
            "y": lambda pose: pose.y,
            "z": lambda pose: pose.z,
            "roll": lambda pose: pose.rpy[0],
            "pitch": lambda pose: pose.rpy[1],
            "yaw": lambda pose: pose.yaw,
            "tilt": tilt_of,
        }
        plain: dict[str, Callable[..., Any]] = {
            "clearance": clearance,
            "distance": distance,
            "joint": joint,
            "peak_force": peak_force,
            "count": count,
            "field": field,
        }
        return {
            **{name: of(name, value_of) for name, value_of in values.items()},
            **{name: function(name, each) for name, each in plain.items()},
        }

    def _box(self, topic: str) -> tuple[int, Any]:
        if topic not in self._messages:
            self._messages[topic] = (0, None)

            def take(message: Any) -> None:
                self._messages[topic] = (self._messages[topic][0] + 1, message)

            self._ends.append(self.world.graph.subscribe(topic, take).close)
        found: tuple[int, Any] = self._messages[topic]
        return found

    def _noted(self, name: str, value: T) -> T:
        self._seen[name] = value
        return value

    @property
    def expected(self) -> str:
        return self.text

    @property
    def actual(self) -> str:
        seen = ", ".join(f"{name} is {_brief(value)}" for name, value in self._seen.items())
        return f"it is {_brief(self._value)}{f': {seen}' if seen else ''}"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return {
            name: value if isinstance(value, int | float) else str(value)
            for name, value in self._seen.items()
        }


def watch_of(value: Mapping[str, Any]) -> Watch:
    """The watch of a condition in a scenario.

    Raises:
        CartwheelError: A value is invalid.
    """
    condition = condition_of(value)
    when: Any = value.get("when") or ("end" if isinstance(condition, Expression) else "")
    return Watch(
        condition,
        when or default_when(condition),
        timeout=value.get("timeout"),
        after=value.get("after", 0.0),
    )


def condition_of(value: Mapping[str, Any]) -> Condition:
    """A condition in a scenario.

    Raises:
        CartwheelError: A value is invalid.
    """
    kind = next(name for name in _MAKERS if name in value)
    return _MAKERS[kind](value)


def _some(value: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: value[name] for name in names if name in value}


def _reaches(value: Mapping[str, Any]) -> Condition:
    if not any(name in value for name in (*_AXES, "yaw")):
        raise _invalid('"reaches" requires at least one of the keys x, y, z and yaw', "x")
    target = [value.get(axis) for axis in _AXES]
    more = _some(value, "within", "yaw", "yaw_within")
    return Reaches(value["reaches"], target, **more)


def _stays_within(value: Mapping[str, Any]) -> Condition:
    limits, more = _some(value, *_AXES, "yaw"), _some(value, "tilt", "speed")
    if not limits and not more:
        raise _invalid('"stays_within" requires at least one of x, y, z, yaw, tilt and speed', "x")
    return StaysWithin(value["stays_within"], limits, **more)


def _pair(value: str | list[str]) -> tuple[str, str | None]:
    names = [value] if isinstance(value, str) else value
    return names[0], names[1] if len(names) > 1 else None


def _joint(value: Mapping[str, Any]) -> Condition:
    model, _, joint = value["joint"].partition("::")
    if not joint or "position" not in value:
        raise _invalid('"joint" requires model::joint and the key "position"', "position")
    return JointAt(model, joint, value["position"], **_some(value, "within"))


_MAKERS: dict[str, Callable[[Mapping[str, Any]], Condition]] = {
    "reaches": _reaches,
    "stays_within": _stays_within,
    "moves": lambda value: Moves(value["moves"], **_some(value, "distance")),
    "publishes": lambda value: Publishes(
        value["publishes"], **_some(value, "rate", "tolerance")
    ),
    "touches": lambda value: Touches(*_pair(value["touches"])),
    "no_contact": lambda value: Touches(*_pair(value["no_contact"]), inverted=True),
    "joint": _joint,
    "sees": lambda value: Sees(
        value["sees"], **_some(value, "range", "within", "angle", "color", "share", "model")
    ),
    "expression": lambda value: Expression(value["expression"]),
}  # fmt: skip


def _invalid(message: str, missing: str) -> CartwheelError:
    return CartwheelError(message, code=SCENARIO_INVALID, values={"missing": missing})


def _brief(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
