"""Many environments that run together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from cartwheel.batch import Batch
from cartwheel.batch.lane import Values
from cartwheel.batch.plan import Backend
from cartwheel.batch.processes import Method
from cartwheel.gym.task import Task

_SEEDS = 2**31


class VectorEnv(gymnasium.vector.VectorEnv[dict[str, Any], Any, Any]):
    """Worlds as environments of Gymnasium, in several processes.

    Environment i behaves as an `Env` that was reset with the seed i higher.

    Args:
        task: What is learned.
        n: Number of environments.
        autoreset: When an environment whose episode has ended starts the next one: with
            ``NEXT_STEP`` in the next step, which ignores its action; with ``SAME_STEP`` at once,
            and the last observations are in the infos as ``final_obs``; with ``DISABLED`` when
            `reset` is called with the option ``reset_mask``.
        workers: As for `cartwheel.batch.Batch`.
        start_method: As for `cartwheel.batch.Batch`.
        backend: As for `cartwheel.batch.Batch`.
        device: As for `cartwheel.batch.Batch`.

    Raises:
        CartwheelError: The task is invalid.
    """

    def __init__(
        self,
        task: Task,
        n: int,
        *,
        autoreset: AutoresetMode = AutoresetMode.NEXT_STEP,
        workers: int | None = None,
        start_method: Method = "spawn",
        backend: Backend = "mujoco",
        device: str = "cuda:0",
    ) -> None:
        self.task, self.num_envs = task, n
        self.metadata = {"render_modes": [], "autoreset_mode": autoreset}
        self._autoreset = autoreset
        self._batch = Batch(
            task.built, n, act=task.fields(), obs=task.obs, period=task.period, vary=task.vary,
            workers=workers, start_method=start_method, backend=backend, device=device,
        )  # fmt: skip
        self._randoms = [np.random.default_rng() for _ in range(n)]
        self._values: Values = task.limited(self._batch.reset())
        self._steps = np.zeros(n, dtype=int)
        self._over = np.zeros(n, dtype=bool)
        self.single_action_space = task.action_space()
        self.single_observation_space = task.observation_space(self._values)
        self.action_space = batch_space(self.single_action_space, n)
        self.observation_space = batch_space(self.single_observation_space, n)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Starts an episode in each environment.

        Args:
            seed: Seed of the first environment, or of each one; None continues.
            options: With ``reset_mask``, an array of bool of shape (n,), only these environments
                start an episode.
        """
        given: Sequence[int | None]
        if seed is None or isinstance(seed, int):
            given = [None if seed is None else seed + index for index in range(self.num_envs)]
        else:
            given = seed
        mask = (options or {}).get("reset_mask")
        chosen = [index for index in range(self.num_envs) if mask is None or mask[index]]
        for index in chosen:
            own = given[index]
            if own is not None:
                self._randoms[index] = np.random.default_rng(own)
        self._values = {name: each.copy() for name, each in self._values.items()}
        self._start(chosen)
        return self._copied(), {}

    def step(self, actions: Any) -> tuple[dict[str, Any], Any, Any, Any, dict[str, Any]]:
        """Runs each environment for a period, or starts its next episode."""
        table = np.asarray(actions, dtype=float)
        rewards = np.zeros(self.num_envs)
        ended = np.zeros(self.num_envs, dtype=bool)
        waits = self._over if self._autoreset is AutoresetMode.NEXT_STEP else self._over & False
        going = [index for index in range(self.num_envs) if not waits[index]]
        before = self._values
        self._values = {name: each.copy() for name, each in before.items()}
        self._start(np.flatnonzero(waits).tolist())
        if going:
            self._put(going, self._batch.step(table[going], which=going))
            self._steps[going] += 1
            rewards[going], ended[going] = self.task.judge(
                _some(before, going), table[going], _some(self._values, going)
            )
        late = self._steps >= self.task.steps
        self._over = ended | late
        infos: dict[str, Any] = {}
        if self._autoreset is AutoresetMode.SAME_STEP:
            over = np.flatnonzero(self._over).tolist()
            for index in over:
                last = {name: each[index].copy() for name, each in self._values.items()}
                infos = self._add_info(infos, {"final_obs": last, "final_info": {}}, index)
            self._start(over)
        return self._copied(), rewards, ended, late, infos

    def _start(self, chosen: list[int]) -> None:
        """Starts an episode in some environments."""
        if chosen:
            seeds = [int(self._randoms[index].integers(_SEEDS)) for index in chosen]
            self._put(chosen, self._batch.reset(which=chosen, seeds=seeds))
            self._steps[chosen], self._over[chosen] = 0, False

    def close_extras(self, **_: Any) -> None:
        """Closes all worlds and ends all processes."""
        self._batch.close()

    def _put(self, rows: Any, values: Values) -> None:
        for name, each in self.task.limited(values).items():
            self._values[name][rows] = each

    def _copied(self) -> dict[str, Any]:
        return {name: each.copy() for name, each in self._values.items()}


def _some(values: Values, rows: Any) -> Values:
    return {name: each[rows] for name, each in values.items()}
