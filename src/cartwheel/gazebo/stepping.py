"""Single steps of a paused simulation: the service and action of simulation_interfaces."""

from __future__ import annotations

import threading
import time
from functools import partial
from typing import Any

from cartwheel.errors import CartwheelError, one_line
from cartwheel.gazebo.results import FAILED, INCORRECT_STATE, OK, PACKAGE, Handler, Refusal
from cartwheel.gazebo.spawning import Spawning
from cartwheel.graph import Action, Goal
from cartwheel.messages import message_class, zero
from cartwheel.session import Session
from cartwheel.simulation import RunState

_LOOK = 0.002
"""Interval of the checks whether steps are done, s."""
_INTERRUPTED = "the simulation was resumed or reset before the steps were completed"
_AT_A_TIME = 20
"""Steps of an action between two checks for cancellation."""


class Stepping:
    """Runs steps and waits for them.

    Args:
        session: The session.
        spawning: Runs functions on the owner's thread.
    """

    def __init__(self, session: Session, spawning: Spawning) -> None:
        self._session = session
        self._simulation = session.simulation
        self._spawning = spawning
        self._action: Action | None = None
        self._stepping = False

    def start(self, node: str, prefix: str) -> None:
        """Advertises the action."""
        self._action = Action(
            self._session.graph,
            f"{prefix}/simulate_steps",
            f"{PACKAGE}/action/SimulateSteps",
            node=node,
            time_ns=lambda: self._simulation.time_ns,
            on_goal=self._simulate_steps,
            on_cancel=lambda goal: goal.cancel(_ended(FAILED, "the goal was canceled")),
            dropped=partial(_ended, FAILED, _INTERRUPTED),
        )

    def close(self) -> None:
        """Removes the action; the caller removes the service."""
        if self._action is not None:
            self._action.close()
            self._action = None

    def offers(self) -> list[tuple[str, str, Handler, bool]]:
        """The service: name, type, handler, and whether the handler runs on a separate thread."""
        return [("step_simulation", "StepSimulation", self._step, True)]

    def _step(self, request: Any, _: Any) -> None:
        steps, simulation = int(request.steps), self._simulation

        def begin() -> int:
            if simulation.run_state is not RunState.PAUSED:
                raise Refusal(INCORRECT_STATE, "the simulation must be paused to be stepped")
            simulation.step(steps)
            return simulation.current_step + steps

        if steps < 1:
            return
        target = self._spawning.on_owner(begin)
        while not self._spawning.on_owner(lambda: self._reached(target)):
            time.sleep(_LOOK)

    def _simulate_steps(self, goal: Goal) -> None:
        """Accepts a goal; on the owner's thread."""
        goal.accept()
        if self._simulation.run_state is not RunState.PAUSED:
            goal.abort(_ended(FAILED, "the simulation must be paused to be stepped"))
        elif self._stepping:
            goal.abort(_ended(FAILED, "steps for a different goal are in progress"))
        else:
            self._stepping = True
            threading.Thread(
                target=self._make_steps, args=(goal,), name="simulate_steps", daemon=True
            ).start()

    def _make_steps(self, goal: Goal) -> None:
        """Runs the steps of a goal in batches, on a separate thread."""
        total, made, simulation = int(goal.goal.steps), 0, self._simulation
        on_owner = self._spawning.on_owner

        def allow(count: int, begin: int | None) -> int | None:
            if goal.done:
                return None
            moved = begin is not None and simulation.current_step != begin
            if moved or simulation.run_state is not RunState.PAUSED:
                raise Refusal(FAILED, _INTERRUPTED)
            simulation.step(count)
            return simulation.current_step + count

        def tell(first: int, last: int) -> None:
            for done in range(first, last + 1):
                if goal.done:
                    return
                goal.feedback(
                    message_class(f"{PACKAGE}/action/SimulateSteps_Feedback")(
                        completed_steps=done, remaining_steps=total - done
                    )
                )

        def end() -> None:
            self._stepping = False
            if not goal.done:
                (goal.succeed if result == OK else goal.abort)(_ended(result, text))

        result, text = OK, ""
        target: int | None = None
        try:
            while made < total:
                count = min(_AT_A_TIME, total - made)
                target = on_owner(partial(allow, count, target))
                if target is None:
                    break
                while not on_owner(partial(self._reached, target)):
                    time.sleep(_LOOK)
                on_owner(partial(tell, made + 1, made + count))
                made += count
        except Refusal as refusal:
            result, text = refusal.result, str(refusal)
        except CartwheelError as error:
            result, text = FAILED, one_line(error)
        self._session.graph.post(end)

    def _reached(self, step: int) -> bool:
        """Whether a step has been reached; called between steps, on the owner's thread."""
        simulation = self._simulation
        if simulation.current_step == step:
            return True
        if simulation.run_state is not RunState.PAUSED or not simulation.steps_allowed:
            raise Refusal(FAILED, _INTERRUPTED)
        return False


def _ended(result: int, text: str) -> Any:
    """The result of an action."""
    made = zero(f"{PACKAGE}/action/SimulateSteps_Result")
    made.result.result, made.result.error_message = result, text
    return made
