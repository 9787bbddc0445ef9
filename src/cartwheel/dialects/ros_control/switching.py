"""Which controllers can start and stop together, and the order of their updates."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from cartwheel.codes import running
from cartwheel.dialects.ros_control.chaining import Reference, owners
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.errors import CartwheelError, GraphError


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
