"""What is learned: actions, observations, rewards and ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.batch import Actions, Apply, Observations, Vary
from cartwheel.batch.lane import Values
from cartwheel.batch.plan import columns_of, invalid
from cartwheel.geometry import Array

if TYPE_CHECKING:
    from gymnasium import spaces

    from cartwheel.api import Built

Range = tuple[float, float]
Action = Mapping[str, Range] | tuple[Apply, Sequence[Range]]
"""The fields of a topic's messages with their limits, or a function with the limits of each column
that it receives."""
Reward = Callable[[Values, Array, Values], Any]
"""Receives the observations before a step, the actions, and the observations after it, each with
the world as the first axis. Returns the reward of each world."""
Ended = Callable[[Values], Any]
"""Receives observations. Returns whether the task of each world has ended, well or badly."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """The description of environments.

    Attributes:
        built: What `cartwheel.build` returned.
        act: For each topic, the fields that actions set, each with its smallest and largest value,
            such as ``{"/cmd_vel": {"linear.x": (0.0, 0.22), "angular.z": (-2.8, 2.8)}}``. The
            limits of ``data[:3]`` apply to each of the three elements. Or for any name, a tuple of
            a function, as for `cartwheel.batch.Batch`, and a list with the limits of each column.
        obs: The observations, as for `cartwheel.batch.Batch`.
        reward: See `Reward`.
        ended: See `Ended`; None if the task only ends after a time.
        limits: The smallest and largest value of observations. Values beyond it are moved to it, as
            the infinite ranges of lasers must be.
        period: Simulation time of a step, s.
        seconds: Simulation time after which an episode is truncated; None is no limit.
        vary: As for `cartwheel.batch.Batch`. Its random numbers are new in each episode.
    """

    built: Built
    act: Mapping[str, Action]
    obs: Observations
    reward: Reward
    ended: Ended | None = None
    limits: Mapping[str, Range] = field(default_factory=dict)
    period: float = 0.1
    seconds: float | None = None
    vary: Vary | None = None

    @property
    def steps(self) -> float:
        """Number of steps after which an episode is truncated."""
        return math.inf if self.seconds is None else max(1, round(self.seconds / self.period))

    def fields(self) -> Actions:
        """The actions as `Batch` expects them.

        Raises:
            CartwheelError: Limits are not a lower and a higher number.
        """
        made: dict[str, list[str] | tuple[Apply, int]] = {}
        for name, action in self.act.items():
            if isinstance(action, Mapping):
                named = action
                made[name] = list(action)
            elif len(action) != 2 or not callable(action[0]):
                raise invalid(
                    f'the action "{name}" must be a mapping of fields to their limits, or a '
                    "function with a list of limits",
                    "act",
                )
            else:
                function, limits = action
                named = {str(index): each for index, each in enumerate(limits)}
                made[name] = (function, len(limits))
            for each, limit in named.items():
                if len(limit) != 2 or not limit[0] < limit[1]:
                    raise invalid(f'"{name} {each}" must have a lower and a higher limit', "act")
        return made

    def _limits(self) -> Iterator[Range]:
        """The limits of each column of the actions."""
        for action in self.act.values():
            if isinstance(action, Mapping):
                for field, limit in action.items():
                    yield from [limit] * len(columns_of([field]))
            else:
                yield from action[1]

    def action_space(self) -> spaces.Box:
        """The actions of one world."""
        from gymnasium import spaces

        limits = list(self._limits())
        low, high = (np.array([limit[end] for limit in limits], np.float32) for end in (0, 1))
        return spaces.Box(low, high, dtype=np.float32)

    def observation_space(self, example: Values) -> spaces.Dict:
        """The observations of one world, from those of some worlds.

        Raises:
            CartwheelError: A limit is not that of an observation.
        """
        from gymnasium import spaces

        for name in self.limits:
            if name not in example:
                raise invalid(f'there is no observation "{name}" to limit', "limits")
        found: dict[str, spaces.Space[Any]] = {}
        for name, values in example.items():
            picture = values.dtype == np.uint8
            low, high = (0, 255) if picture else self.limits.get(name, (-np.inf, np.inf))
            kind = np.uint8 if picture else np.float32
            found[name] = spaces.Box(low, high, values.shape[1:], kind)
        return spaces.Dict(found)

    def limited(self, values: Values) -> Values:
        """Observations within their limits, as 32-bit numbers, or uint8 without limits.

        Raises:
            CartwheelError: A number is not finite.
        """
        found: Values = {}
        for name, each in values.items():
            limit = self.limits.get(name)
            if limit is None and each.dtype == np.uint8:
                found[name] = each
                continue
            inside = each if limit is None else np.clip(each, *limit)
            if not np.isfinite(inside).all():
                raise invalid(
                    f'the observation "{name}" is not finite: give it limits, such as '
                    f"limits={{{name!r}: (0.0, 3.5)}}",
                    "limits",
                )
            found[name] = inside.astype(np.float32)
        return found

    def judge(self, before: Values, actions: Array, after: Values) -> tuple[Array, Any]:
        """Rewards, and whether the tasks have ended.

        Raises:
            CartwheelError: A function has returned a wrong number of values.
        """
        count = len(actions)
        rewards = np.asarray(self.reward(before, actions, after), dtype=float)
        ended = np.zeros(count, bool) if self.ended is None else np.asarray(self.ended(after))
        for name, each in (("reward", rewards), ("ended", ended)):
            if each.shape != (count,):
                raise invalid(
                    f"{name} must return one value for each world, of shape ({count},) "
                    f"(got shape {each.shape})",
                    name,
                )
        return rewards, ended.astype(bool)
