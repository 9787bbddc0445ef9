"""Wrenches on links and efforts on joints for an interval of simulation time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cartwheel.geometry import Array, Vec3
from cartwheel.simulation.clock import NEVER
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.limits import STRONGEST, number, numbers


@dataclass(frozen=True, kw_only=True, slots=True)
class Push:
    """A wrench or an effort."""

    model: str
    part: str
    """A link or a joint."""
    turns: bool
    """Whether it is an effort on a joint."""
    value: Array
    """Shape (6,): force and torque in world axes at the centre of mass; or (1,): effort."""
    start_ns: int
    end_ns: int | None

    def weight(self, time_ns: int, step_ns: int) -> float:
        """The fraction of the step at `time_ns` during which the push acts."""
        end = time_ns + step_ns
        if self.end_ns is not None:
            end = min(end, self.end_ns)
        return max(0, end - max(time_ns, self.start_ns)) / step_ns

    def steady(self, time_ns: int, step_ns: int) -> int:
        """Number of steps from `time_ns` with a constant weight; at least 1."""
        if self.start_ns > time_ns:
            return max(1, (self.start_ns - time_ns) // step_ns)
        if self.end_ns is None:
            return NEVER
        return max(1, (self.end_ns - time_ns) // step_ns)


class Forces:
    """Applies pushes for their exact duration, at no cost while there are none.

    A push that begins or ends within a step is scaled by its fraction of the step, so that the
    impulse is force times duration, whatever the step length. Use it only on the simulation's
    thread.

    Args:
        engine: The engine with the pushed bodies.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._pushes: list[Push] = []
        self._due = 0
        """The step of the next change."""
        self._wrenches: dict[int, Array] = {}
        self._efforts: dict[int, Array] = {}
        """Current pushes by body and by degree of freedom."""
        self.active = False
        """Whether `serve` has anything to do."""

    def wrench(
        self,
        model: str,
        link: str,
        *,
        force: Vec3,
        torque: Vec3,
        start_ns: int = 0,
        duration_ns: int | None = None,
    ) -> None:
        """Applies a force and torque at a link's centre of mass.

        Args:
            model: Model name.
            link: Link name.
            force: N, in world axes.
            torque: N m, in world axes.
            start_ns: Simulation time; a past time means now.
            duration_ns: None for no end, 0 for one step.

        Raises:
            CartwheelError: A number is not finite or too large.
        """
        numbers((*force, *torque), f'the wrench on link "{link}"', most=STRONGEST)
        self._add(model, link, np.array([*force, *torque], dtype=float), start_ns, duration_ns)

    def effort(
        self,
        model: str,
        joint: str,
        effort: float,
        *,
        start_ns: int = 0,
        duration_ns: int | None = None,
    ) -> None:
        """Applies an effort to a joint with one degree of freedom, N m or N; see `wrench`."""
        number(effort, f'the effort on joint "{joint}"', most=STRONGEST)
        self._add(model, joint, np.array([effort], dtype=float), start_ns, duration_ns)

    def effort_on(self, model: str, joint: str) -> float:
        """The effort of all pushes on a joint in the step that begins now, N m or N."""
        time_ns, step_ns = self._engine.time_ns, self._engine.step_ns
        return sum(
            push.weight(time_ns, step_ns) * float(push.value[0])
            for push in self._pushes
            if push.turns and (push.model, push.part) == (model, joint)
        )

    def clear_wrenches(self, model: str, link: str) -> None:
        """Removes all pushes on a link."""
        self._keep(lambda push: push.turns or (push.model, push.part) != (model, link))

    def clear_efforts(self, model: str, joint: str) -> None:
        """Removes all efforts on a joint."""
        self._keep(lambda push: not push.turns or (push.model, push.part) != (model, joint))

    def drop(self, model: str) -> None:
        """Removes all pushes on a deleted model."""
        self._keep(lambda push: push.model != model)

    def forget(self) -> None:
        """Removes all pushes."""
        self._keep(lambda _: False)

    def bind(self) -> None:
        """Recomputes all forces after the engine's state was replaced, which cleared them."""
        self._wrenches, self._efforts, self._due = {}, {}, 0
        self.active = bool(self._pushes)

    def serve(self) -> int:
        """Sets the forces for the step that begins now.

        Returns:
            The step of the next change.
        """
        engine = self._engine
        if engine.step < self._due:
            return self._due
        time_ns, step_ns = engine.time_ns, engine.step_ns
        self._pushes = [p for p in self._pushes if p.end_ns is None or p.end_ns > time_ns]
        wrenches: dict[int, Array] = {}
        efforts: dict[int, Array] = {}
        steady = NEVER
        for push in self._pushes:
            steady = min(steady, push.steady(time_ns, step_ns))
            weight = push.weight(time_ns, step_ns)
            if not weight:
                continue
            if push.turns:
                joint = engine.joint_id(push.model, push.part)
                dof = int(engine.model.jnt_dofadr[joint])
                efforts[dof] = efforts.get(dof, np.zeros(1)) + weight * push.value
            else:
                body = engine.body_id(push.model, push.part)
                wrenches[body] = wrenches.get(body, np.zeros(6)) + weight * push.value
        _exchange(engine.data.xfrc_applied, self._wrenches, wrenches)
        _exchange(engine.data.qfrc_applied.reshape(-1, 1), self._efforts, efforts)
        self._wrenches, self._efforts = wrenches, efforts
        self.active = bool(self._pushes or wrenches or efforts)
        self._due = engine.step + steady
        return self._due

    def _add(
        self, model: str, part: str, value: Array, start_ns: int, duration_ns: int | None
    ) -> None:
        engine = self._engine
        start = max(start_ns, engine.time_ns)
        end = None if duration_ns is None else start + (duration_ns or engine.step_ns)
        self._pushes.append(
            Push(
                model=model,
                part=part,
                turns=value.size == 1,
                value=value,
                start_ns=start,
                end_ns=end,
            )
        )
        self._due = 0
        self.active = True
        engine.commanded += 1

    def _keep(self, wanted: Callable[[Push], bool]) -> None:
        kept = [push for push in self._pushes if wanted(push)]
        if len(kept) != len(self._pushes):
            self._pushes, self._due = kept, 0


def _exchange(rows: Array, old: dict[int, Array], new: dict[int, Array]) -> None:
    """Replaces our previous contributions to each row; rows may have other contributions."""
    for index in sorted(old.keys() | new.keys()):
        row = rows[index]
        before, after = old.get(index, 0.0), new.get(index, 0.0)
        row += np.subtract(after, before)
        # Rounding errors would keep a body awake.
        row[np.abs(row) <= 1e-14 * (np.abs(before) + np.abs(after))] = 0.0
