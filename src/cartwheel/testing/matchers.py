"""Functions for tests that run a world until a condition is met, and state what differed.

Each function runs the world of the model. If the condition is not met, it raises an `UnmetError`,
which is an `AssertionError`, with the expected and the actual values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from cartwheel.api.values import duration
from cartwheel.errors import Pickled
from cartwheel.testing.clearing import KeepsClear
from cartwheel.testing.conditions import (
    Condition,
    JointAt,
    Moves,
    Reaches,
    StaysWithin,
)
from cartwheel.testing.holding import Holds
from cartwheel.testing.publishing import Publishes
from cartwheel.testing.seeing import Sees
from cartwheel.testing.subjects import frame_of, name_of, side_of, topic_of, world_of
from cartwheel.testing.touching import Touches
from cartwheel.testing.watching import Watch, When, run

if TYPE_CHECKING:
    from cartwheel.api import Link, Model, World
    from cartwheel.geometry import Pose

Limits = tuple[float, float]


class UnmetError(Pickled, AssertionError):
    """A condition that was not met.

    Attributes:
        expected: What was expected, as a phrase.
        actual: What was observed, as a phrase.
        values: The observed values by name, in SI units.
        time: Simulation time, s.
    """

    def __init__(self, condition: Condition, time: float) -> None:
        self.expected, self.actual = condition.expected, condition.actual
        self.values: Mapping[str, float | str | None] = dict(condition.values)
        self.time = time
        super().__init__(
            f"at {time:.3f} s of simulation time\n"
            f"  expected: {self.expected}\n  actual:   {self.actual}"
        )


def reaches(
    robot: Model | Link,
    target: Pose | Sequence[float | None],
    *,
    within: float = 0.1,
    timeout: float = 10.0,
    yaw: float | None = None,
    yaw_within: float = 0.1,
) -> float:
    """Runs the world until a model or a link reaches a position.

    Args:
        robot: The model, or one of its links, such as the hand of an arm.
        target: x and y, or x, y and z, in m; None for a coordinate that is not compared. Of a pose,
            position and yaw are compared.
        within: Maximum distance from the target, m.
        timeout: Maximum simulation time, s.
        yaw: Target of the yaw, rad.
        yaw_within: Maximum difference of the yaw, rad.

    Returns:
        The simulation time of the world, s.

    Raises:
        UnmetError: It did not reach the position. `values` contains the closest approach and its
            time.
        CartwheelError: `robot` is not a model or a link, the target is not one of the above, or
            nothing is compared.
    """
    from cartwheel.geometry import Pose

    if isinstance(target, Pose):
        yaw = target.yaw if yaw is None else yaw
        target = target.position
    __tracebackhide__ = True
    condition = Reaches(frame_of(robot), target, within=within, yaw=yaw, yaw_within=yaw_within)
    return _until(world_of(robot), condition, timeout)


def stays_within(
    robot: Model | Link,
    *,
    x: Limits | None = None,
    y: Limits | None = None,
    z: Limits | None = None,
    yaw: Limits | None = None,
    tilt: float | None = None,
    speed: float | None = None,
    seconds: float = 5.0,
) -> None:
    """Runs the world for a time, in which a model or a link must stay within limits.

    Args:
        robot: The model, or one of its links.
        x: Minimum and maximum, m.
        y: Minimum and maximum, m.
        z: Minimum and maximum, m.
        yaw: Minimum and maximum, rad. Full turns are ignored: (3.0, 3.3) contains -3.1.
        tilt: Maximum angle between its z axis and the vertical, rad.
        speed: Maximum speed, m/s.
        seconds: Simulation time, s.

    Raises:
        UnmetError: It left the limits. `values` contains the coordinate, its value and the
            time.
        CartwheelError: There is no limit, or a minimum is above its maximum.
    """
    __tracebackhide__ = True
    given = {"x": x, "y": y, "z": z, "yaw": yaw}
    limits = {name: each for name, each in given.items() if each is not None}
    condition = StaysWithin(frame_of(robot), limits, tilt=tilt, speed=speed)
    _always(world_of(robot), condition, seconds)


def moves(robot: Model | Link, *, distance: float = 0.1, timeout: float = 5.0) -> float:
    """Runs the world until a model or a link has moved.

    Args:
        robot: The model, or one of its links.
        distance: Minimum distance from its current position, m.
        timeout: Maximum simulation time, s.

    Returns:
        The simulation time of the world, s.

    Raises:
        UnmetError: It did not move far enough. `values` contains the distance.
    """
    __tracebackhide__ = True
    return _until(world_of(robot), Moves(frame_of(robot), distance), timeout)


def publishes(
    world: World | Model,
    topic: str,
    *,
    rate: float | None = None,
    tolerance: float = 0.1,
    seconds: float = 2.0,
) -> float:
    """Runs the world and counts the messages on a topic.

    Args:
        world: The world, or one of its models.
        topic: The topic, for a model in its namespace.
        rate: Messages per second of simulation time. Without a rate, the run ends with the first
            message.
        tolerance: Relative tolerance of the rate.
        seconds: Simulation time, s.

    Returns:
        The measured rate, Hz.

    Raises:
        UnmetError: There was no message, or the rate differs. `values` contains the rate, the
            number of messages and the longest gap in s.
        UnknownNameError: The topic does not exist.
    """
    __tracebackhide__ = True
    condition = Publishes(topic_of(world, topic), rate, tolerance=tolerance)
    _check(world_of(world, "world"), condition, "once" if rate is None else "end", seconds)
    return condition.measured


def sees(
    world: World | Model,
    topic: str,
    *,
    range: float | None = None,
    within: float | None = None,
    angle: float | None = None,
    color: Sequence[float] | None = None,
    share: float | None = None,
    model: str | None = None,
    timeout: float = 2.0,
) -> float:
    """Runs the world until a sensor sees an object.

    Args:
        world: The world, or one of its models.
        topic: A topic with images, depth images, laser scans, ranges, point clouds or images of
            logical cameras, for a model in its namespace.
        range: Shortest distance that the sensor measures, m, also to the ground.
        within: Tolerance of the range, m; None is 0.05.
        angle: Angle of the only ray of a laser scan that counts, rad; None is all rays.
        color: Red, green and blue from 0 to 1, for images.
        share: Minimum share of the image's pixels that have the colour; None is 0.01.
        model: Name of the detected model, for logical cameras.
        timeout: Maximum simulation time, s.

    Returns:
        The simulation time of the world, s.

    Raises:
        UnmetError: The sensor did not see it. `values` contains the most similar range or share.
        UnknownNameError: The topic does not exist.
        GraphError: Messages of the topic's type contain no view, or cannot be tested for what is
            given: a laser scan has no colour.
        CartwheelError: The colour is invalid, no ray has the angle, or `within` or `share` is given
            without the range or colour to which it belongs.
    """
    __tracebackhide__ = True
    name = topic_of(world, topic)
    condition = Sees(
        name, range=range, within=within, angle=angle, color=color, share=share, model=model
    )
    return _until(world_of(world, "world"), condition, timeout)


def touches(
    robot: Model | Link, other: Model | Link | str | None = None, *, timeout: float = 5.0
) -> float:
    """Runs the world until a model or a link touches another one.

    Args:
        robot: The model, or one of its links.
        other: The other model or link, or a pattern such as ``wall*`` or ``cart::*_bumper``; None
            for any other model but the ground plane.
        timeout: Maximum simulation time, s.

    Returns:
        The simulation time of the world, s.

    Raises:
        UnmetError: They did not touch.
        UnknownNameError: No model or link has this name.
    """
    __tracebackhide__ = True
    condition = Touches(side_of(robot, "robot"), None if other is None else side_of(other, "other"))
    return _until(world_of(robot), condition, timeout)


def touches_nothing(
    robot: Model | Link, other: Model | Link | str | None = None, *, seconds: float = 5.0
) -> None:
    """Runs the world for a time, in which a model or a link must not touch another one.

    Args:
        robot: The model, or one of its links.
        other: As for `touches`.
        seconds: Simulation time, s.

    Raises:
        UnmetError: They touched. `values` contains the links, the force in N and the time.
        UnknownNameError: No model or link has this name.
    """
    __tracebackhide__ = True
    sides = side_of(robot, "robot"), None if other is None else side_of(other, "other")
    _always(world_of(robot), Touches(*sides, inverted=True), seconds)


def holds(
    world: World,
    condition: Callable[[], object] | Callable[[World], object],
    *,
    seconds: float = 5.0,
    period: float | None = None,
) -> None:
    """Runs the world for a time, in which a condition must always hold.

    `World.run_until` runs the world until a condition holds.

    Args:
        world: The world.
        condition: Returns a true value while it holds. Takes no arguments, or the world.
        seconds: Simulation time, s.
        period: Simulation time between two evaluations, s; None for one step.

    Raises:
        UnmetError: The condition did not hold. `values` contains, for a lambda, the values that it
            compares.
        CartwheelError: An argument is invalid.
    """
    __tracebackhide__ = True
    condition_of = Holds(condition, world)
    broken = world._until(lambda: not condition_of.holds(), timeout=seconds, period=period)
    if broken and not condition_of.holds():
        raise UnmetError(condition_of, world.time)


def keeps_clear(
    robot: Model | Link,
    other: Model | Link | str | None = None,
    *,
    distance: float = 0.1,
    seconds: float = 5.0,
    ignore: Sequence[str] = ("ground_plane",),
) -> None:
    """Runs the world for a time, in which surfaces must keep a distance; see `World.clearance`.

    Args:
        robot: The model, or one of its links.
        other: The other model or link, or a pattern as for `touches`; None for all other models.
        distance: Minimum distance, m.
        seconds: Simulation time, s.
        ignore: Models, links and patterns that do not count, if `other` is None.

    Raises:
        UnmetError: They came closer. `values` contains the distance, its time and the other model.
        UnknownNameError: No model or link has this name.
        CartwheelError: One of them has no collision.
    """
    __tracebackhide__ = True
    one = side_of(robot, "robot")
    two = None if other is None else side_of(other, "other")
    condition = KeepsClear(one, two, distance, ignore=ignore if two is None else ())
    _always(world_of(robot), condition, seconds)


def joint_reaches(
    robot: Model, joint: str, position: float, *, within: float = 0.05, timeout: float = 10.0
) -> float:
    """Runs the world until a joint reaches a position.

    Args:
        robot: The model.
        joint: Name of the joint.
        position: Target, rad or m.
        within: Tolerance, rad or m.
        timeout: Maximum simulation time, s.

    Returns:
        The simulation time of the world, s.

    Raises:
        UnmetError: The joint did not reach the position. `values` contains the closest approach.
        UnknownNameError: The joint does not exist.
    """
    __tracebackhide__ = True
    return _until(world_of(robot), JointAt(name_of(robot), joint, position, within=within), timeout)


def _until(world: World, condition: Condition, timeout: float) -> float:
    __tracebackhide__ = True
    _check(world, condition, "once", timeout, name="timeout")
    return world.time


def _always(world: World, condition: Condition, seconds: float) -> None:
    __tracebackhide__ = True
    _check(world, condition, "always", seconds)


def _check(
    world: World, condition: Condition, when: When, seconds: float, *, name: str = "seconds"
) -> None:
    __tracebackhide__ = True
    seconds = duration(seconds, name)
    watch = Watch(condition, when)
    try:
        watch.begin(world)
        run(world, [watch], seconds, until=lambda: watch.met is not None)
        watch.end(world)
    finally:
        condition.close()
    if not watch.met:
        raise UnmetError(condition, world.time)
