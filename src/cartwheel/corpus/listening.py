"""The controllers of a robot on trial, the wheels that they drive, and which topics publish."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from cartwheel.api import World
from cartwheel.checks.robot import Robot, Sides
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.files import ControllerFiles
from cartwheel.dialects.ros_control.parameters import Row, rows
from cartwheel.graph import Publisher, Subscription

LISTENING = 1.0
"""Time in which a topic with a stated rate of some Hz must publish, s."""
_LONGEST = 5.0
_PATIENCE = 20.0
"""Time in which a topic with a lower rate must publish, s."""
_PERIODS = 1.5
"""Periods of a topic's stated rate in which it must publish."""


def controllers_of(world: World) -> ControllerFiles:
    """The controllers of the models in a world, with their files."""
    return world.session.shared.get(ControllerFiles)


def idle(world: World) -> set[str]:
    """Nodes of controllers that do not run: two controllers of one joint are used alternately."""
    return {each.node for each in controllers_of(world).loaded if not each.running}


def _periods(topics: Iterable[Publisher]) -> float:
    """Time in which topics must publish by their stated rates, s."""
    return max((_PERIODS / each.rate for each in topics if each.rate), default=0.0)


def listened(world: World) -> tuple[int, tuple[str, ...]]:
    """The number of topics with a stated rate, and those without messages."""
    graph = world.graph
    waiting = idle(world)
    rated = {
        each.topic: each for each in graph.publishers() if each.rate and each.node not in waiting
    }
    subscriptions: dict[str, Subscription] = {}
    silent = set(rated)

    def hear(topic: str, _message: object) -> None:
        silent.discard(topic)
        # One message is enough, and to render more images takes most of a trial's time.
        if topic in subscriptions:
            subscriptions.pop(topic).close()

    for topic in rated:
        subscriptions[topic] = graph.subscribe(topic, partial(hear, topic))
    slowest = min([each.rate or 1.0 for each in rated.values()], default=1.0)
    waited = min(_LONGEST, max(LISTENING, 3.0 / slowest))
    if rated:
        world.run(waited)
    late = _periods(rated[each] for each in silent)
    if late > waited:
        more = min(_PATIENCE, late) - waited
        world.run(more)
        waited += more
    silent = {each for each in silent if _periods([rated[each]]) <= waited}
    for subscription in subscriptions.values():
        subscription.close()
    return len(rated), tuple(sorted(silent))


def controlled_sides(robot: Robot, started: Sequence[Controller]) -> tuple[Sides, ...]:
    """Joints of the left and right wheels of each controller that drives a base.

    Args:
        robot: The robot.
        started: The controllers that run.
    """
    found = (sides for each in started for sides in _sides(robot, each))
    return tuple(dict.fromkeys(found))


def _sides(robot: Robot, controller: Controller) -> Iterator[Sides]:
    table = rows(type(controller).parameters, ros2=controller.robot.ros2)
    fields = {row.field: row for row in table}
    for row in table:
        if row.role != "wheel_separation" or len(set(row.wheels)) != 2:
            continue
        left, right = (_joints(controller, fields[field]) for field in row.wheels)
        known = all(robot.joints[name].turns for name in left + right if name in robot.joints)
        if left and right and known and {*left, *right} <= robot.joints.keys():
            yield left, right


def _joints(controller: Controller, row: Row) -> tuple[str, ...]:
    """The names of joints in a parameter."""
    values = (controller.settings.raw(name) for name in row.spelled())
    stated = next((value for value in values if value), ())
    names = [stated] if isinstance(stated, str) else stated
    return tuple(map(str, names)) if isinstance(names, list | tuple) else ()
