"""Which controllers can start and stop together, and the order of their updates."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from cartwheel.codes import running
from cartwheel.dialects.ros_control.chaining import Reference, owners
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.errors import CartwheelError, GraphError


class SharedJoints:
    """Which of its controllers each joint follows.

    In ROS 2, a controller claims interfaces of joints. Two controllers may therefore run that
    command the position and the velocity of one joint. Gazebo's hardware then follows one of both.

    Args:
        priorities: The command interfaces. A joint follows the first one that is commanded.
    """

    def __init__(self, priorities: Sequence[str]) -> None:
        self._priorities = tuple(priorities)
        self._commanded: dict[JointHardware, list[tuple[str, Controller]]] = {}
        """The commanded interfaces of each joint with their controllers, the followed one first."""
        self.any = False
        """Whether two controllers command a joint."""

    def begin(self, controller: Controller) -> None:
        """Lets a controller command its joints."""
        for name, joint in controller.claims.items():
            by = self._commanded.setdefault(joint, [])
            by.append((controller.interfaces[name], controller))
            by.sort(key=lambda each: self._rank(each[0]))
            if by[0][1] is controller:
                joint.activate(by[0][0])
        self._count()

    def lost(self, controller: Controller) -> Iterator[tuple[JointHardware, str, Controller, str]]:
        """The commands that a controller's joints do not follow, or those that they follow instead.

        Yields:
            A joint that it shares, the interface and the controller that it does not follow, and
            the interface that it follows.
        """
        for joint in controller.claims.values():
            by = self._commanded.get(joint, [])
            for interface, other in by[1:]:
                if controller in (other, by[0][1]):
                    yield joint, interface, other, by[0][0]

    def end(self, controller: Controller) -> None:
        """Takes its joints from a controller. They follow the others that command them, if any."""
        for joint in controller.claims.values():
            before = self._commanded.pop(joint, [])
            by = [each for each in before if each[1] is not controller]
            if not by:
                joint.release()
                continue
            self._commanded[joint] = by
            if by[0] != before[0]:
                joint.activate(by[0][0])
        self._count()

    def clear(self) -> None:
        """Forgets all controllers."""
        self._commanded.clear()
        self._count()

    @contextlib.contextmanager
    def kept(self, controller: Controller) -> Iterator[None]:
        """Within the block, a controller's commands to joints that follow another one are lost."""
        lost = [
            (joint, joint.command, joint.rate, joint.damping, joint.strength)
            for joint in (controller.claims.values() if self.any else ())
            if (by := self._commanded.get(joint)) and by[0][1] is not controller
        ]
        yield
        for joint, command, rate, damping, strength in lost:
            joint.command, joint.rate = command, rate
            joint.damping, joint.strength = damping, strength

    def _rank(self, interface: str) -> int:
        known = interface in self._priorities
        return self._priorities.index(interface) if known else len(self._priorities)

    def _count(self) -> None:
        self.any = any(len(each) > 1 for each in self._commanded.values())


@dataclass(frozen=True, kw_only=True, slots=True)
class Switch:
    """The controllers whose states change together."""

    stopping: list[Controller]
    starting: list[Controller]


def plan_switch(
    controllers: Mapping[str, Controller],
    order: Sequence[Controller],
    *,
    start: Sequence[str],
    stop: Sequence[str],
    report: Callable[[CartwheelError], None] | None,
    sharing: Collection[str] = (),
) -> Switch:
    """Returns the controllers that can stop and start.

    Args:
        controllers: The loaded controllers by name.
        order: The same controllers in the order of their updates.
        start: Names of the controllers to start.
        stop: Names of the controllers to stop.
        report: Reports conflicts, and the other controllers are switched. None: a conflict is
            raised.
        sharing: Names of controllers that may command one joint together, by different interfaces,
            as in ROS 2.

    Raises:
        GraphError: Without `report`, if a controller is not loaded, already is in the requested
            state, or would command a joint of another controller.
    """
    strict = report is None

    def refuse(conflict: GraphError) -> None:
        if report is None:
            raise conflict
        report(conflict)

    stopping = [each for name in stop if (each := _switchable(controllers, name, True, strict))]
    for name in with_leaders(order, stop)[len(stop) :]:
        led = [each for each in led_by(controllers[name]) if each in stop]
        if led:
            problem = f'controller "{led[0]}" cannot stop because "{name}" commands it'
            refuse(_conflict(led[0], problem, by=name))
        stopping = [each for each in stopping if each.name not in led]
    starting = [each for name in start if (each := _switchable(controllers, name, False, strict))]
    # A controller that is both stopped and started is restarted.
    for name in start:
        controller = controllers.get(name)
        if controller in stopping and controller not in starting and controller is not None:
            starting.append(controller)
    commanded: dict[str, list[Controller]] = {}
    for each in controllers.values():
        if each.running and each not in stopping:
            _claim(each, commanded)
    # References of these controllers can be commanded.
    remaining = [
        each
        for each in controllers.values()
        if each in starting or (each.running and each not in stopping)
    ]
    able = []
    for controller in starting:
        conflict = _conflict_of(controller, remaining, commanded, sharing)
        if conflict is not None:
            refuse(conflict)
            continue
        _claim(controller, commanded)
        able.append(controller)
    return Switch(stopping=stopping, starting=able)


def led_by(controller: Controller) -> list[str]:
    """Returns the names of the controllers that this one commands."""
    return owners(controller.claims.values())


def with_leaders(order: Sequence[Controller], names: Sequence[str]) -> list[str]:
    """Returns the names, and those of all running controllers that command them.

    These must stop together.

    Args:
        order: All controllers in the order of their updates.
        names: Names of some controllers.
    """
    together = list(names)
    for each in reversed(order):
        led = led_by(each)
        if each.running and each.name not in together and any(name in together for name in led):
            together.append(each.name)
    return together


def update_order(controllers: Mapping[str, Controller]) -> list[Controller]:
    """Returns the controllers in the order of their updates: each precedes those it commands."""

    def levels_below(name: str) -> int:
        led = (other for other in led_by(controllers[name]) if other in controllers)
        return 1 + max((levels_below(other) for other in led), default=-1)

    return [controllers[name] for name in sorted(controllers, key=levels_below, reverse=True)]


def wrong_state(name: str, problem: str, *, hint: str = "") -> GraphError:
    """Returns the error for a request that does not fit the state of a controller.

    Args:
        name: The controller.
        problem: Its state, as it follows the name in the message.
        hint: What to do.
    """
    return GraphError(
        f'controller "{name}" {problem}',
        code=running.CONTROLLER_STATE,
        hint=hint,
        values={"controller": name},
    )


def _switchable(
    controllers: Mapping[str, Controller], name: str, runs: bool, strict: bool
) -> Controller | None:
    """Returns a controller whose state is to change; None if it cannot or need not change.

    Args:
        controllers: The loaded controllers by name.
        name: Name of the controller.
        runs: Whether it must be running now.
        strict: Raise an error if the controller is not loaded or must be running and is not.
    """
    controller = controllers.get(name)
    problem = ""
    if controller is None:
        problem = "is not loaded"
    elif controller.running != runs:
        if not runs and not strict:
            return None
        problem = "is not running" if runs else "is already running"
    if not problem:
        return controller
    if strict and (controller is None or runs):
        raise wrong_state(name, problem)
    return None


def _claim(controller: Controller, commanded: dict[str, list[Controller]]) -> None:
    for joint in controller.claims:
        commanded.setdefault(joint, []).append(controller)


def _conflict_of(
    controller: Controller,
    remaining: Sequence[Controller],
    commanded: Mapping[str, Sequence[Controller]],
    sharing: Collection[str],
) -> GraphError | None:
    """Returns why a controller cannot start; None if it can.

    Args:
        controller: The controller.
        remaining: Controllers that will run.
        commanded: The commanding controllers of each commanded joint.
        sharing: See `plan_switch`.
    """
    for name, claim in controller.claims.items():
        rival = next(
            (each for each in commanded.get(name, ()) if _rivals(controller, each, name, sharing)),
            None,
        )
        if rival is not None:
            by, why = rival.name, f'joint "{name}" is commanded by "{rival.name}"'
        elif isinstance(claim, Reference) and not _offered(claim, remaining):
            by, why = claim.owner, f'it commands "{claim.owner}", which is not running'
        else:
            continue
        message = f'controller "{controller.name}" cannot start: {why}'
        return _conflict(controller.name, message, by=by)
    return None


def _rivals(one: Controller, other: Controller, joint: str, sharing: Collection[str]) -> bool:
    """Whether two controllers cannot command a joint at the same time."""
    if one.name not in sharing or other.name not in sharing:
        return True
    return not one.required(joint).isdisjoint(other.required(joint))


def _offered(claim: Reference, remaining: Sequence[Controller]) -> bool:
    """Whether the reference's controller will run and was not reloaded since the claim."""
    return any(claim is each for owner in remaining for each in owner.references)


def _conflict(name: str, message: str, *, by: str) -> GraphError:
    return GraphError(
        message, code=running.CONTROLLER_CONFLICT, values={"controller": name, "by": by}
    )
