"""The steps of a scenario."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from cartwheel.codes.command import SCENARIO_INVALID
from cartwheel.codes.graph import SERVICE_UNKNOWN
from cartwheel.errors import CartwheelError, UnknownNameError
from cartwheel.geometry import Pose
from cartwheel.graph import absolute_name
from cartwheel.graph.action import GoalState
from cartwheel.messages import from_dict, to_dict
from cartwheel.scenarios.trial import UNTIL, StepFailedError, Trial

if TYPE_CHECKING:
    from cartwheel.api import Model

HOLD_RATE = 10.0
"""Default rate of a ``hold`` step, Hz."""
_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_LINK = ("mass", "center_of_mass", "friction", "gravity", "color")
_JOINT = {
    "damping": "damping",
    "joint_friction": "friction",
    "effort_limit": "effort_limit",
    "velocity_limit": "velocity_limit",
}
"""Keys of a step, and properties of `cartwheel.api.Joint`."""
_LIGHT = {"enabled": "on", "intensity": "intensity", "color": "color"}
"""Keys of a step, and properties of `cartwheel.api.Light`. YAML reads the key ``on`` as true."""


class Steps:
    """Performs the steps of a case.

    Args:
        place_of: Returns the path of a file that the scenario names.
    """

    def __init__(self, place_of: Callable[[str], Any]) -> None:
        self._place_of = place_of
        self._held: dict[str, Callable[[], None]] = {}
        self._faults: dict[str, Callable[[], None]] = {}

    def perform(self, trial: Trial, step: Mapping[str, Any]) -> None:
        """Performs a step.

        Raises:
            StepFailedError: The step did not succeed.
            CartwheelError: The step is invalid.
        """
        kind = next(name for name in _KINDS if name in step)
        getattr(self, f"_{kind}")(trial, step)

    def _wait(self, trial: Trial, step: Mapping[str, Any]) -> None:
        trial.advance(step["wait"])

    def _until(self, trial: Trial, step: Mapping[str, Any]) -> None:
        trial.until(step["until"], step.get("timeout", UNTIL))

    def _publish(self, trial: Trial, step: Mapping[str, Any]) -> None:
        name = step["publish"]
        kind = trial.world.graph.topic(name).type
        trial.world.publish(name, from_dict(kind, step.get("message") or {}))

    def _hold(self, trial: Trial, step: Mapping[str, Any]) -> None:
        topic = absolute_name(step["hold"])
        self._end_hold(topic)
        held = trial.world.topic(topic)
        message = from_dict(held.type, step.get("message") or {})
        hold = held.hold(message, rate=step.get("rate", HOLD_RATE))
        self._held[topic] = hold.stop
        trial.ends.append(lambda: self._end_hold(topic))

    def _end_hold(self, topic: str) -> None:
        self._held.pop(topic, lambda: None)()

    def _release(self, trial: Trial, step: Mapping[str, Any]) -> None:  # noqa: ARG002
        topic = absolute_name(step["release"])
        if topic not in self._held:
            raise UnknownNameError("hold", topic, self._held, code=SCENARIO_INVALID)
        self._end_hold(topic)

    def _fault(self, trial: Trial, step: Mapping[str, Any]) -> None:
        topic = absolute_name(step["fault"])
        self._end_fault_of(topic)
        names = ("drop", "delay", "frozen", "noise", "bias")
        fault = trial.world.fault(topic, **{name: step[name] for name in names if name in step})
        self._faults[topic] = fault.end
        trial.ends.append(lambda: self._end_fault_of(topic))

    def _end_fault_of(self, topic: str) -> None:
        self._faults.pop(topic, lambda: None)()

    def _end_fault(self, trial: Trial, step: Mapping[str, Any]) -> None:  # noqa: ARG002
        topic = absolute_name(step["end_fault"])
        if topic not in self._faults:
            raise UnknownNameError("fault", topic, self._faults, code=SCENARIO_INVALID)
        self._end_fault_of(topic)

    def _call(self, trial: Trial, step: Mapping[str, Any]) -> None:
        graph, name = trial.world.graph, step["call"]
        kind = graph.service(name).type
        future = graph.call(name, from_dict(f"{kind}_Request", step.get("request") or {}))
        trial.advance(UNTIL, future.done)
        if not future.done():
            if trial.decided:
                return
            raise StepFailedError(f"a response of {name}", f"none within {UNTIL:g} s", {})
        response = to_dict(future.result())
        for field, wanted in (step.get("response") or {}).items():
            if field not in response:
                raise UnknownNameError("field", field, response, code=SCENARIO_INVALID)
            if response[field] != wanted:
                raise StepFailedError(
                    f"{name} responds {field}: {wanted}",
                    f"it responded {field}: {response[field]}",
                    {"field": field, "value": str(response[field])},
                )

    def _send_goal(self, trial: Trial, step: Mapping[str, Any]) -> None:
        name = absolute_name(step["send_goal"])
        actions = {each.name: each for each in trial.world.graph.actions()}
        if name not in actions:
            raise UnknownNameError("action", name, actions, code=SERVICE_UNKNOWN)
        action = actions[name]
        goal = action.submit(from_dict(f"{action.type}_Goal", step.get("goal") or {}))
        if goal is None or not step.get("wait", True):
            return
        timeout = step.get("timeout", UNTIL)
        trial.advance(timeout, lambda: goal.done)
        if goal.state is not GoalState.SUCCEEDED and not trial.decided:
            state = goal.state.name.lower()
            raise StepFailedError(
                f"the goal of {name} succeeds within {timeout:g} s",
                f"its state is {state}{f': {goal.text}' if goal.text else ''}",
                {"state": state},
            )

    def _push(self, trial: Trial, step: Mapping[str, Any]) -> None:
        model, link = _part(trial, step["push"])
        given = {name: step[name] for name in ("force", "torque", "at", "seconds") if name in step}
        if link is None:
            model.push(**given)
        else:
            model.link(link).push(**given)

    def _set(self, trial: Trial, step: Mapping[str, Any]) -> None:
        model, link = _part(trial, step["set"])
        if link is not None:
            _only(step, "set", _LINK)
            for name in _LINK:
                if name in step:
                    setattr(model.link(link), name, step[name])
            return
        of_link = [name for name in _LINK if name in step]
        allowed = (*_POSE, "joints", "velocity", *_JOINT)
        hint = (
            f"For {of_link[0]}, name a link: set: {model.name}::{model.links[0]}."
            if of_link
            else ""
        )
        _only(step, "set", allowed, hint=hint)
        if any(name in step for name in _POSE):
            model.pose = _changed(model.pose, step)
        for name, position in step.get("joints", {}).items():
            model.joints.positions[name] = position
        for key, quantity in _JOINT.items():
            for name, value in step.get(key, {}).items():
                setattr(model.joints[name], quantity, value)
        if "velocity" in step:
            from cartwheel.api import Twist

            model.velocity = Twist(tuple(step["velocity"]), (0.0, 0.0, 0.0))

    def _set_gravity(self, trial: Trial, step: Mapping[str, Any]) -> None:
        trial.world.gravity = tuple(step["set_gravity"])

    def _set_light(self, trial: Trial, step: Mapping[str, Any]) -> None:
        light = trial.world.light(step["set_light"])
        _only(step, "set_light", tuple(_LIGHT))
        for key, name in _LIGHT.items():
            if key in step:
                setattr(light, name, step[key])

    def _spawn(self, trial: Trial, step: Mapping[str, Any]) -> None:
        options = spawn_options(step)
        trial.world.spawn(self._place_of(step["spawn"]), **options)

    def _delete(self, trial: Trial, step: Mapping[str, Any]) -> None:
        trial.world.model(step["delete"]).delete()


_KINDS = (
    "publish", "hold", "release", "fault", "end_fault", "wait", "until", "call", "send_goal",
    "push", "set", "set_gravity", "set_light", "spawn", "delete",
)  # fmt: skip


def spawn_options(value: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of `World.spawn` for a robot or a step, except the file and controllers."""
    from cartwheel.scenarios.cases import xacro_value

    names = (*_POSE, "name", "namespace", "frame_prefix")
    options = {name: value[name] for name in names if name in value}
    if "arguments" in value:
        given = value["arguments"].items()
        options["arguments"] = {name: xacro_value(each) for name, each in given}
    return options


def _part(trial: Trial, name: str) -> tuple[Model, str | None]:
    """A model, or the link of a model."""
    model, _, link = name.partition("::")
    return trial.world.model(model), link or None


def _changed(pose: Pose, step: Mapping[str, Any]) -> Pose:
    old = dict(zip(_POSE, (*pose.position, *pose.rpy), strict=True))
    new = {name: step.get(name, value) for name, value in old.items()}
    return Pose.from_xyz_rpy(
        (new["x"], new["y"], new["z"]), (new["roll"], new["pitch"], new["yaw"])
    )


def _only(step: Mapping[str, Any], kind: str, allowed: Sequence[str], *, hint: str = "") -> None:
    given = set(step) - {kind}
    wrong = sorted(given - set(allowed))
    if wrong or not given:
        raise CartwheelError(
            f'"{wrong[0]}" cannot be set for "{step[kind]}"'
            if wrong
            else f'"{kind}: {step[kind]}" changes nothing',
            code=SCENARIO_INVALID,
            hint=hint or f"Use {', '.join(allowed)}.",
            values={"name": wrong[0] if wrong else ""},
        )
