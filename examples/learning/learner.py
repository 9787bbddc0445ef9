"""Environments of Cartwheel for Stable-Baselines3, which has an interface of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
from stable_baselines3.common.vec_env import VecEnv

from cartwheel.gym import VectorEnv


class Worlds(VecEnv):
    """A `VectorEnv` with ``AutoresetMode.SAME_STEP``."""

    def __init__(self, worlds: VectorEnv) -> None:
        self._worlds = worlds
        self._actions: Any = None
        super().__init__(
            worlds.num_envs, worlds.single_observation_space, worlds.single_action_space
        )

    def reset(self) -> Any:
        """Starts an episode in each world."""
        return self._worlds.reset(seed=self._seeds[0])[0]

    def step_async(self, actions: Any) -> None:
        """Stores the actions."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Runs all worlds."""
        values, rewards, ended, late, found = self._worlds.step(self._actions)
        over = ended | late
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(over):
            infos[index] = {
                "terminal_observation": found["final_obs"][index],
                "TimeLimit.truncated": bool(late[index] and not ended[index]),
            }
        return values, rewards, over, infos

    def close(self) -> None:
        """Closes all worlds."""
        self._worlds.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute for each world."""
        return [getattr(self._worlds, attr_name, None) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Worlds have no attributes of their own."""
        raise NotImplementedError

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        """Worlds have no methods of their own."""
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:  # noqa: ARG002
        """Worlds have no wrappers."""
        return [False for _ in self._get_indices(indices)]
