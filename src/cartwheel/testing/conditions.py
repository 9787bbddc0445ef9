"""Conditions on the state of a world, with the values that explain why one is not met."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cartwheel.api.arguments import refused
from cartwheel.api.values import scalar
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.testing.subjects import pose_of

if TYPE_CHECKING:
    from cartwheel.api import World
    from cartwheel.geometry import Pose

Range = tuple[float, float]
_AXES = ("x", "y", "z")


def shown(value: float) -> str:
    """A number with three digits, without an exponent for what is far away."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


class Condition(ABC):
    """A condition on a world. `begin` starts it, and `holds` evaluates it at the current time."""

    every_step = False
    """Whether the condition must be evaluated at each time step, because it may hold briefly."""

    def __init__(self) -> None:
        self._world: World | None = None

    @property
    def world(self) -> World:
        """The world, between `begin` and `close`."""
        assert self._world is not None
        return self._world

    def begin(self, world: World) -> None:
        """Starts the condition.

        Raises:
            UnknownNameError: A model, joint or topic does not exist.
        """
        self._world = world

    def close(self) -> None:
        """Ends the condition. Its texts and values remain."""
        self._world = None

    @abstractmethod
    def holds(self) -> bool:
        """Whether the condition is met now."""

    @property
    @abstractmethod
    def expected(self) -> str:
        """What is expected, as a phrase."""

    @property
    @abstractmethod
    def actual(self) -> str:
        """What was observed, as a phrase."""

    @property
    def values(self) -> Mapping[str, float | str | None]:
        """The observed values, for programs."""
        return {}


class Reaches(Condition):
    """A model or a link reaches a position, and a yaw if one is given.

    Args:
        model: Name of the model, or scoped name of the link.
        target: x, y and z in m; None is not compared.
        within: Maximum distance from the target, m.
        yaw: Target of the yaw, rad; None is not compared.
        yaw_within: Maximum difference of the yaw, rad.

    Raises:
        CartwheelError: The target is not two or three numbers or None, or nothing is compared.
    """

    def __init__(
        self,
        model: str,
        target: Sequence[float | None],
        *,
        within: float = 0.1,
        yaw: float | None = None,
        yaw_within: float = 0.1,
    ) -> None:
        super().__init__()
        self.model, self.within = model, scalar(within, "within", least=0.0)
        self.target = _target(target)
        self.yaw = None if yaw is None else scalar(yaw, "yaw")
        self.yaw_within = scalar(yaw_within, "yaw_within", least=0.0)
        if yaw is None and all(each is None for each in self.target):
            raise refused("target", "at least one number if there is no yaw", target)
        self.closest, self.closest_time = math.inf, 0.0
        self._closest_yaw: float | None = None
        self._last: Pose | None = None

    def begin(self, world: World) -> None:
        super().begin(world)
        pose_of(world, self.model)

    def holds(self) -> bool:
        pose = pose_of(self.world, self.model)
        self._last = pose
        distance = math.sqrt(
            sum(
                (at - to) ** 2
                for at, to in zip(pose.position, self.target, strict=True)
                if to is not None
            )
        )
        turn = 0.0 if self.yaw is None else abs(angle_between(pose.yaw, self.yaw))
        # Among poses at the target, the one with the best yaw is the closest.
        best = (max(self.closest, self.within), self._closest_yaw or 0.0)
        if self._closest_yaw is None or (max(distance, self.within), turn) < best:
            self.closest, self._closest_yaw = distance, turn
            self.closest_time = self.world.time
        return distance <= self.within and turn <= self.yaw_within

    @property
    def expected(self) -> str:
        place = ", ".join(
            f"{axis} = {to:g} m"
            for axis, to in zip(_AXES, self.target, strict=True)
            if to is not None
        )
        parts = [f"{place} within {self.within:g} m"] if place else []
        if self.yaw is not None:
            parts.append(f"yaw = {self.yaw:g} rad within {self.yaw_within:g} rad")
        return f"{self.model} reaches {' and '.join(parts)}"

    @property
    def actual(self) -> str:
        if self._last is None:
            return "no time passed"
        x, y, z = self._last.position
        turn = (
            "" if self.yaw is None else f" with a yaw error of {self._closest_yaw or 0.0:.3g} rad"
        )
        return (
            f"the closest approach was {shown(self.closest)} m{turn} at {self.closest_time:.3f} s; "
            f"the last pose was x = {x:z.3f}, y = {y:z.3f}, z = {z:z.3f} m, "
            f"yaw = {self._last.yaw:z.3f} rad"
        )

    @property
    def values(self) -> Mapping[str, float | str | None]:
        pose = self._last
        return {
            "closest": self.closest,
            "closest_time": self.closest_time,
            "yaw_error": self._closest_yaw if self.yaw is not None else None,
            "x": pose.x if pose else None,
            "y": pose.y if pose else None,
            "yaw": pose.yaw if pose else None,
        }


class StaysWithin(Condition):
    """A model or a link stays within limits.

    Args:
        model: Name of the model, or scoped name of the link.
        limits: Minimum and maximum of ``x``, ``y`` and ``z`` in m, and of ``yaw`` in rad, to which
            full turns can be added.
        tilt: Maximum angle between the model's z axis and the vertical, rad.
        speed: Maximum speed, m/s.

    Raises:
        CartwheelError: There is no limit, or a minimum is above its maximum.
    """

    def __init__(
        self,
        model: str,
        limits: Mapping[str, Sequence[float]],
        *,
        tilt: float | None = None,
        speed: float | None = None,
    ) -> None:
        super().__init__()
        self.model = model
        self.tilt = None if tilt is None else scalar(tilt, "tilt", least=0.0)
        self.speed = None if speed is None else scalar(speed, "speed", least=0.0)
        self.limits = {name: _limits(name, each) for name, each in limits.items()}
        if not limits and tilt is None and speed is None:
            raise CartwheelError(
                "a model needs limits to stay within",
                code=OPTION_INVALID,
                hint="Give at least one of x, y, z, yaw, tilt and speed.",
                values={"name": "limits"},
            )
        self._seen: dict[str, Range] = {}
        self._broken: tuple[str, float, float] | None = None
        self._before: tuple[float, Pose] | None = None

    def begin(self, world: World) -> None:
        super().begin(world)
        pose_of(world, self.model)

    def holds(self) -> bool:
        pose, now = pose_of(self.world, self.model), self.world.time
        found = dict(zip(_AXES, pose.position, strict=True))
        bounds: dict[str, Sequence[float]] = dict(self.limits)
        if "yaw" in bounds:
            middle = sum(bounds["yaw"]) / 2
            found["yaw"] = middle + angle_between(pose.yaw, middle)
        if self.tilt is not None:
            found["tilt"], bounds["tilt"] = tilt_of(pose), (0.0, self.tilt)
        if self.speed is not None and self._before is not None and now > self._before[0]:
            moved = math.dist(pose.position, self._before[1].position)
            found["speed"], bounds["speed"] = moved / (now - self._before[0]), (0.0, self.speed)
        self._before = (now, pose)
        good = True
        for name, (low, high) in bounds.items():
            if name not in found:
                continue
            value = found[name]
            least, most = self._seen.get(name, (value, value))
            self._seen[name] = (min(least, value), max(most, value))
            if not low <= value <= high:
                good = False
                if self._broken is None:
                    self._broken = (name, value, now)
        return good

    @property
    def expected(self) -> str:
        parts = [
            f"{low:g} ≤ {name} ≤ {high:g} {'rad' if name == 'yaw' else 'm'}"
            for name, (low, high) in self.limits.items()
        ]
        if self.tilt is not None:
            parts.append(f"tilt ≤ {self.tilt:g} rad")
        if self.speed is not None:
            parts.append(f"speed ≤ {self.speed:g} m/s")
        return f"{self.model} stays within {', '.join(parts)}"

    @property
    def actual(self) -> str:
        seen = ", ".join(f"{name} {low:.3f} to {high:.3f}" for name, (low, high) in
                         self._seen.items())  # fmt: skip
        if self._broken is None:
            return f"observed: {seen}" if seen else "no time passed"
        name, value, time = self._broken
        return f"{name} was {value:.3f} at {time:.3f} s; observed: {seen}"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        if self._broken is None:
            return {}
        name, value, time = self._broken
        return {"coordinate": name, "value": value, "time": time}


class Moves(Condition):
    """A model or a link moves away from its pose at `begin`.

    Args:
        model: Name of the model, or scoped name of the link.
        distance: Minimum distance, m.
    """

    def __init__(self, model: str, distance: float = 0.1) -> None:
        super().__init__()
        self.model, self.distance = model, scalar(distance, "distance", least=0.0)
        self.moved = 0.0
        self._start: Pose | None = None

    def begin(self, world: World) -> None:
        super().begin(world)
        self._start = pose_of(world, self.model)

    def holds(self) -> bool:
        assert self._start is not None
        now = pose_of(self.world, self.model).position
        self.moved = max(self.moved, math.dist(now, self._start.position))
        return self.moved >= self.distance

    @property
    def expected(self) -> str:
        return f"{self.model} moves by at least {self.distance:g} m"

    @property
    def actual(self) -> str:
        return f"it moved by {shown(self.moved)} m"

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return {"moved": self.moved}


class JointAt(Condition):
    """A joint has a position.

    Args:
        model: Name of the model.
        joint: Name of the joint.
        position: Target, rad or m.
        within: Tolerance, rad or m.
    """

    def __init__(self, model: str, joint: str, position: float, *, within: float = 0.05) -> None:
        super().__init__()
        self.model, self.joint = model, joint
        self.position = scalar(position, "position")
        self.within = scalar(within, "within", least=0.0)
        self.closest, self.closest_time, self.last = math.inf, 0.0, math.nan

    def begin(self, world: World) -> None:
        super().begin(world)
        self.last = world.model(self.model).joint(self.joint)

    def holds(self) -> bool:
        self.last = self.world.model(self.model).joint(self.joint)
        error = abs(self.last - self.position)
        if error < self.closest:
            self.closest, self.closest_time = error, self.world.time
        return error <= self.within

    @property
    def expected(self) -> str:
        return f"{self.model}::{self.joint} is at {self.position:g} within {self.within:g}"

    @property
    def actual(self) -> str:
        return (
            f"it is at {self.last:.4g}; its smallest distance from it was {self.closest:.3g} "
            f"at {self.closest_time:.3f} s"
        )

    @property
    def values(self) -> Mapping[str, float | str | None]:
        return {"position": self.last, "closest": self.closest, "closest_time": self.closest_time}


def _target(target: Sequence[float | None]) -> tuple[float | None, ...]:
    """x, y and z, each a number or None."""
    try:
        found = tuple(None if each is None else float(each) for each in target)
    except (TypeError, ValueError):
        found = ()
    if len(found) not in (2, 3) or not all(each is None or math.isfinite(each) for each in found):
        raise refused("target", "x and y, or x, y and z, in m", target)
    return found + (None,) * (3 - len(found))


def _limits(name: str, limits: Sequence[float]) -> Range:
    """Minimum and maximum."""
    try:
        low, high = map(float, limits)
    except (TypeError, ValueError):
        unit = "rad" if name == "yaw" else "m"
        raise refused(name, f"a minimum and a maximum in {unit}", limits) from None
    if math.isnan(low) or math.isnan(high):
        raise refused(name, "two numbers", limits)
    if low > high:
        error = refused(name, "a minimum and a maximum, in this order", limits)
        error.hint = f"The limits are swapped. Write ({high:g}, {low:g})."
        raise error
    return low, high


def angle_between(a: float, b: float) -> float:
    """The difference of two angles, -π to π rad."""
    return math.remainder(a - b, math.tau)


def tilt_of(pose: Pose) -> float:
    """Angle between a pose's z axis and the vertical, rad."""
    x, y, _, _ = pose.orientation
    return math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y))))
