"""Many worlds of the same models that run together."""

from __future__ import annotations

import functools
import itertools
import math
import multiprocessing
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from cartwheel.batch.lane import Values, check_alike
from cartwheel.batch.plan import BACKENDS, Actions, Backend, Observations, Plan, Vary, invalid
from cartwheel.batch.processes import Lanes, Method, Process
from cartwheel.codes.world import BATCH_CLOSED
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array
from cartwheel.jobs import AT_TOP_LEVEL, cores, unpicklable

if TYPE_CHECKING:
    from cartwheel.api import Built, World

_SEEDS = 2**31
"""Number of seeds that follow others."""


@dataclass(frozen=True, slots=True)
class _Share:
    """Those of some worlds that are in one process."""

    process: int
    """Number of the process, from this one on."""
    worlds: list[int]
    """Their numbers in the process."""
    rows: slice | list[int]
    """Their places among the worlds."""


class Batch:
    """Worlds that receive actions and return observations as arrays.

    World i is the world that ``built.world(seed=seed + i)`` makes, whatever the number of worlds
    and processes: with MuJoCo with the same bits, with MuJoCo Warp within tolerances. Each has all
    sensors, plugins and controllers of its robots.

    Args:
        built: What `cartwheel.build` returned.
        n: Number of worlds.
        act: For each topic, the fields that the columns of the actions set, such as
            ``{"/cmd_vel": ["linear.x", "angular.z"]}``. ``data[0]`` is an element of an array, and
            ``data[:3]`` are its first three. Or for any name, a tuple of a function and its number
            of columns: it receives the `World` and the columns as an array before each step.
        obs: The observations by name. Each is a field of the newest message of the topic of this
            name, a list of fields, a tuple of a topic and its fields, the pose of a model
            (`PoseOf`), or a function that receives the `World` and returns numbers.
            ``ranges[:90]`` is a part of an array, as for `Topic.values`. The field ``data`` of an
            image is its picture, of shape (height, width, 3), uint8, or its depths in m. All other
            numbers are float64.
        period: Simulation time of a step, s.
        seed: Seed of the first world.
        vary: Called with the world and a random generator after each reset, to change masses,
            poses or lights.
        workers: Number of other processes. This one runs a share of the worlds as well, and all
            of them with 0. By default one fewer than there are cores.
        start_method: How processes are started, as in `multiprocessing`. With ``spawn``, a script
            must make the batch below ``if __name__ == "__main__":``, and functions must be those of
            a module.
        backend: What computes the physics: ``mujoco``, or ``warp`` for MuJoCo Warp, which
            simulates many worlds on a GPU in single precision. Plugins and sensors run on the
            processor in both cases. With ``warp``, all worlds are in this process by default.
        device: With ``warp``, Warp's name of the device. The device ``cpu`` is only a test.

    Raises:
        CartwheelError: An argument is invalid, a world cannot be made, or MuJoCo Warp cannot
            simulate it.
        UnknownNameError: A topic does not exist.
    """

    def __init__(
        self,
        built: Built,
        n: int,
        *,
        act: Actions,
        obs: Observations,
        period: float = 0.1,
        seed: int = 0,
        vary: Vary | None = None,
        workers: int | None = None,
        start_method: Method = "spawn",
        backend: Backend = "mujoco",
        device: str = "cuda:0",
    ) -> None:
        from cartwheel.api import Built

        if not isinstance(built, Built):
            raise invalid(
                f"built must be the result of cartwheel.build (got {built!r:.60})", "built"
            )
        if isinstance(n, bool) or not isinstance(n, int) or n < 1:
            raise invalid(f"a batch must have at least one world (got {n!r:.60})", "n")
        if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
            raise invalid(f"the seed must be an integer of at least 0 (got {seed!r:.60})", "seed")
        if backend not in BACKENDS:
            raise invalid(f"the backend must be one of {', '.join(BACKENDS)}", "backend")
        on_device = device if backend == "warp" else None
        if on_device is not None:
            workers = workers or 0
            if workers and start_method == "fork":
                raise invalid("processes with a GPU cannot be forked", "start_method")
        self._plan = Plan.of(act, obs, period=period, vary=vary)
        self._columns = len(self._plan.action_names)
        self.n = n
        self.seed = seed = int(seed)
        # multiprocessing starts no processes from a process of a pool.
        daemon = multiprocessing.current_process().daemon
        if workers is None:
            workers = 0 if daemon else cores() - 1
        count = min(n - 1, workers)
        if count < 0:
            raise invalid(f"the number of processes must be at least 0 (got {count})", "workers")
        if count and daemon:
            raise invalid("a daemonic process cannot start processes: use workers=0", "workers")
        seeds = [seed + index for index in range(n)]
        self._seeds = [*seeds]
        self._begun = [False] * n
        """Whether each world has been reset."""
        self._closed = False
        self._lock = threading.Lock()
        self._pid = os.getpid()
        self._here: Lanes | None = None
        self._processes: list[Process] = []
        self._edges = np.linspace(0, n, count + 2).astype(int).tolist()
        """The first world of each process, from this one on, and the number of worlds."""
        self._every = list(range(n))
        self._all = [
            _Share(index, list(range(last - first)), slice(first, last))
            for index, (first, last) in enumerate(itertools.pairwise(self._edges))
        ]
        if count and start_method != "fork" and (reason := unpicklable(self._plan)):
            error = invalid(f"act, obs or vary cannot be passed to processes: {reason}", "workers")
            error.hint = f"{AT_TOP_LEVEL}, or pass workers=0."
            raise error
        try:
            for first, last in itertools.pairwise(self._edges[1:]):
                own = seeds[first:last]
                self._processes.append(Process(built, self._plan, own, start_method, on_device))
            self._here = Lanes(built, self._plan, seeds[: self._edges[1]], on_device)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def action_names(self) -> tuple[str, ...]:
        """Topic and field of each column of the actions, or name and number of a function's."""
        return self._plan.action_names

    @property
    def seeds(self) -> tuple[int, ...]:
        """The seed of each world, with which its current episode can be repeated."""
        return tuple(self._seeds)

    def world(self, index: int) -> World:
        """A world, if all worlds are in this process.

        Raises:
            CartwheelError: It is in another process, or does not exist.
        """
        (chosen,) = self._chosen([index])
        if self._here is None or self._processes:
            raise invalid("worlds are in other processes: use workers=0", "workers")
        return self._here.lanes[chosen].world

    def reset(
        self, seed: int | None = None, *, which: Sequence[int] | Array | None = None,
        seeds: Sequence[int] | Array | None = None,
    ) -> Values:  # fmt: skip
        """Returns worlds to their start, and runs a step without an action.

        Args:
            seed: New seed of world 0; world i has this seed plus i. None: the first reset keeps
                the seed of a world, and each further one takes the next seed, which depends only
                on the one before it. `seeds` contains them.
            which: Indices of the worlds; None is all of them.
            seeds: Instead of `seed`, the seed of each of these worlds.

        Returns:
            The observations of these worlds by name, each of shape (number of worlds, …).

        Raises:
            CartwheelError: An argument is invalid, or a topic has had no message.
        """
        chosen = self._chosen(which)
        if seeds is not None:
            given = [int(each) for each in seeds]
            if len(given) != len(chosen):
                raise invalid(f"{len(chosen)} seeds are required (got {len(given)})", "seeds")
        elif seed is not None:
            given = [seed + index for index in chosen]
        else:
            given = [
                _after(self._seeds[index]) if self._begun[index] else self._seeds[index]
                for index in chosen
            ]
        values = self._call(
            "reset",
            chosen,
            lambda rows: given[rows] if isinstance(rows, slice) else [given[row] for row in rows],
        )
        for index, each in zip(chosen, given, strict=True):
            self._seeds[index], self._begun[index] = each, True
        return values

    def step(self, actions: Array, *, which: Sequence[int] | Array | None = None) -> Values:
        """Publishes actions, and runs the worlds for a period.

        Args:
            actions: Shape (number of worlds, number of actions), in the order of `action_names`.
            which: Indices of the worlds; None is all of them.

        Returns:
            As for `reset`.

        Raises:
            CartwheelError: The actions have the wrong shape or are not finite, or a world has
                failed.
        """
        chosen = self._chosen(which)
        table = np.asarray(actions, dtype=float)
        wanted = (len(chosen), self._columns)
        if table.shape != wanted:
            raise invalid(
                f"the actions must have the shape {wanted} (got {table.shape})", "actions"
            )
        # The sum of squares takes a third of the time of a look at each number.
        if not math.isfinite(np.vdot(table, table)) and not np.isfinite(table).all():
            raise invalid("the actions must be finite", "actions")
        # Lists of a few numbers are passed to processes faster than arrays.
        return self._call("step", chosen, lambda rows: table[rows].tolist())

    def _chosen(self, which: Sequence[int] | Array | None) -> list[int]:
        if self._closed:
            raise CartwheelError("the batch is closed", code=BATCH_CLOSED)
        if self._processes and self._pid != os.getpid():
            raise CartwheelError(
                "the batch cannot be used in a process that was forked after it", code=BATCH_CLOSED
            )
        if which is None:
            return self._every
        found = np.asarray(which)
        if found.dtype == bool:
            found = np.flatnonzero(found)
        chosen = [int(each) for each in found]
        if not chosen or len(set(chosen)) < len(chosen) or not all(
            0 <= each < self.n for each in chosen
        ):  # fmt: skip
            raise invalid(f"the worlds must be different numbers from 0 to {self.n - 1}", "which")
        return chosen

    def _shares(self, chosen: list[int]) -> list[_Share]:
        """The processes that have some of these worlds."""
        if chosen is self._every:
            return self._all
        found = []
        for index, (first, last) in enumerate(itertools.pairwise(self._edges)):
            rows = [row for row, world in enumerate(chosen) if first <= world < last]
            if rows:
                found.append(_Share(index, [chosen[row] - first for row in rows], rows))
        return found

    def _call(
        self, name: str, chosen: list[int], part_of: Callable[[slice | list[int]], Any]
    ) -> Values:
        """Calls a method of `Lanes` for some worlds, each in its process.

        Args:
            name: The method.
            chosen: Indices of the worlds.
            part_of: The argument for some of the chosen worlds.
        """
        asked: list[tuple[Callable[[], Values], slice | list[int]]] = []
        with self._lock:  # one thread after the other
            for share in self._shares(chosen):
                arguments = share.worlds, part_of(share.rows)
                if share.process == 0:
                    here = functools.partial(getattr(self._here, name), *arguments)
                    asked.append((here, share.rows))
                else:
                    process = self._processes[share.process - 1]
                    process.ask(name, *arguments)
                    asked.append((process.answer, share.rows))
            return _joined(asked, len(chosen))

    def close(self) -> None:
        """Closes all worlds and ends all processes."""
        self._closed = True
        if self._here is not None:
            self._here.close()
        for process in self._processes if self._pid == os.getpid() else ():
            process.close()
        self._processes.clear()


def _joined(asked: Sequence[tuple[Callable[[], Values], slice | list[int]]], count: int) -> Values:
    """The answers of the processes in the order of the worlds."""
    if len(asked) == 1:
        return asked[0][0]()
    answers: list[tuple[slice | list[int], Values]] = []
    failure: Exception | None = None
    for answer, rows in asked:
        try:
            answers.append((rows, answer()))
        except Exception as error:  # noqa: BLE001 - raised below, after all have answered
            failure = failure or error
    if failure is not None:
        raise failure
    found: Values = {}
    for name, first in answers[0][1].items():
        parts = [part[name] for _, part in answers]
        for each in parts:
            if each.shape[1:] != first.shape[1:] or each.dtype != first.dtype:
                check_alike(name, first[0], each[0])
        if isinstance(asked[0][1], slice):  # all worlds, in their order
            found[name] = np.concatenate(parts)
            continue
        found[name] = np.empty((count, *first.shape[1:]), first.dtype)
        for (rows, _), each in zip(answers, parts, strict=True):
            found[name][rows] = each
    return found


def _after(seed: int) -> int:
    """The seed that follows another one, at random, so that worlds do not share episodes."""
    return int(np.random.default_rng(seed).integers(_SEEDS))
