"""One environment."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from cartwheel.batch import Batch
from cartwheel.batch.lane import Values
from cartwheel.batch.plan import invalid
from cartwheel.gym.task import Task

_SEEDS = 2**31
_SIZE = (640, 480)


class Env(gymnasium.Env[dict[str, Any], Any]):
    """A world as an environment of Gymnasium.

    Args:
        task: What is learned.
        render_mode: ``rgb_array`` for pictures, or None.

    Raises:
        CartwheelError: The task is invalid.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012 - as in Gymnasium

    def __init__(self, task: Task, *, render_mode: str | None = None) -> None:
        self.task, self.render_mode = task, render_mode
        self.metadata = {**type(self).metadata, "render_fps": round(1 / task.period)}
        self._batch = Batch(
            task.built, 1, act=task.fields(), obs=task.obs, period=task.period, vary=task.vary,
            workers=0,
        )  # fmt: skip
        self._values: Values = task.limited(self._batch.reset())
        self._steps = 0
        self.action_space = task.action_space()
        self.observation_space = task.observation_space(self._values)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Starts an episode with new noise and variations."""
        super().reset(seed=seed, options=options)
        self._steps = 0
        self._values = self.task.limited(
            self._batch.reset(seeds=[int(self.np_random.integers(_SEEDS))])
        )
        return _first(self._values), {}

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Runs the world for a period."""
        actions = np.asarray(action, dtype=float)[None]
        if actions.shape[1:] != self.action_space.shape:
            raise invalid(
                f"an action must have the shape {self.action_space.shape} "
                f"(got {actions.shape[1:]})",
                "actions",
            )
        before = self._values
        self._values = self.task.limited(self._batch.step(actions))
        rewards, ended = self.task.judge(before, actions, self._values)
        self._steps += 1
        late = self._steps >= self.task.steps
        return _first(self._values), float(rewards[0]), bool(ended[0]), late, {}

    def render(self) -> Any:
        """A picture of the world, shape (480, 640, 3), if `render_mode` is ``rgb_array``."""
        if self.render_mode != "rgb_array":
            return None
        return self._batch.world(0).picture(*_SIZE).pixels

    def close(self) -> None:
        """Closes the world."""
        self._batch.close()


def _first(values: Values) -> dict[str, Any]:
    return {name: each[0] for name, each in values.items()}
