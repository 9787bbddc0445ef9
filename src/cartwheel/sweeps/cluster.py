"""Processes of a Ray cluster that do the jobs of a sweep.

Each process is a Ray actor. Ray's tasks are not used: an actor prepares itself only once, and the
time limit of a job must not include the start of its process.
"""

from __future__ import annotations

import contextlib
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any, Generic, TypeVar

from cartwheel.sweeps.connection import connected, unusable

Job = TypeVar("Job")
Result = TypeVar("Result")

_LOOK = 0.25
"""Wall time between two checks of the time limits, s."""
_GROW = 2.0
"""Wall time between two checks of the number of processors, s."""
_BUSY = 600.0
"""Wall time for which other programs may use all processors, unless a job may take longer, s."""
_ABANDONED = 60.0
"""Wall time for which a cluster may have no processors at all, s."""
_ATTEMPTS = 3
"""How many times a job is started whose process or computer is lost."""
_STARTS = 5
"""How many processes in succession may be lost before they are ready."""
_DEPENDENCIES = ("cartwheel", "mujoco", "numpy")
"""Packages whose versions determine the bits of the results."""


def versions() -> dict[str, str]:
    """The versions of the packages that determine the bits of the results."""
    return {name: version(name) for name in _DEPENDENCIES}


class _Process:
    """The actor."""

    def __init__(self, packed: bytes, number: int) -> None:
        self._do: Any = None
        self._error = ""
        try:
            from ray import cloudpickle

            self._do = cloudpickle.loads(packed)(number)
        except Exception as error:  # noqa: BLE001 - the program with the sweep reports it
            self._error = f"{type(error).__name__}: {error}"

    def ready(self) -> tuple[dict[str, str], str]:
        """The versions, and the error of the preparation."""
        return versions(), self._error

    def do(self, job: Any) -> Any:
        return self._do(job)


@dataclass(eq=False)
class _Task(Generic[Job]):
    job: Job
    attempts: int = 0


@dataclass(eq=False)
class _Worker(Generic[Job]):
    actor: Any
    reference: Any
    """Reference to the value that is awaited, if there is one."""
    ready: bool = False
    task: _Task[Job] | None = None
    end: float = 0.0
    """Time of `time.monotonic` at which the task must be done."""


class ClusterWorkers(Generic[Job, Result]):
    """Does jobs in processes of a Ray cluster, one for each of its processors.

    Args:
        prepare: Called in each process with its number. Returns the function that does a job. It
            and all jobs must be picklable, and need no files.
        lost: Returns the result of a job that was lost, for a reason.
        address: As for `connected`.
        count: Number of processes; None for all processors.
        timeout: Maximum wall time of a job, s.

    Raises:
        CartwheelError: The cluster cannot be used.
    """

    def __init__(
        self,
        prepare: Callable[[int], Callable[[Job], Result]],
        lost: Callable[[Job, str], Result],
        *,
        address: str,
        count: int | None,
        timeout: float,
    ) -> None:
        self._lost, self._count, self._timeout = lost, count, timeout
        self._workers: list[_Worker[Job]] = []
        self._number = 0
        self._lost_starts = 0
        self._processors = 0
        self._counted = -_GROW
        self._closing = contextlib.ExitStack()
        with contextlib.ExitStack() as stack:
            self._ray: Any = stack.enter_context(connected(address, count))
            # As bytes, because arrays that Ray sends are read-only.
            self._packed = self._ray.put(self._ray.cloudpickle.dumps(prepare))
            self._process = self._ray.remote(num_cpus=1)(_Process)
            self._closing = stack.pop_all()

    def run(self, jobs: Sequence[Job]) -> Iterator[Result]:
        """Yields the result of each job as soon as it is known. Call `close` at the end.

        A job whose process or computer is lost is started again, at most twice.

        Raises:
            CartwheelError: The cluster has no processors, or a computer cannot do the jobs.
        """
        waiting = deque(_Task(job) for job in jobs)
        active = time.monotonic()
        while waiting or any(each.task for each in self._workers):
            self._start(len(waiting) + sum(each.task is not None for each in self._workers))
            for worker in self._workers:
                if worker.ready and worker.task is None and waiting:
                    self._assign(worker, waiting.popleft())
            awaited = {each.reference: each for each in self._workers if each.reference}
            done = self._ray.wait(list(awaited), timeout=_LOOK)[0] if awaited else ()
            for reference in done:
                worker = awaited[reference]
                task, value, error = worker.task, *self._value(worker)
                if task is None:
                    self._welcome(worker, value, error)
                elif not error:
                    yield value
                elif task.attempts < _ATTEMPTS:
                    waiting.appendleft(task)
                else:
                    yield self._lost(task.job, f"its process ended {_ATTEMPTS} times: {error}")
            now = time.monotonic()
            for worker in list(self._workers):
                if worker.task is not None and now > worker.end:
                    self._end(worker)
                    yield self._lost(worker.task.job, f"it took more than {self._timeout:g} s")
            if any(each.ready for each in self._workers):
                active = now
            elif not self._processors and now > active + _ABANDONED:
                raise unusable("the Ray cluster has no processors")
            elif now > active + max(_BUSY, self._timeout):
                raise unusable(
                    f"the Ray cluster provided no processor within {now - active:.0f} s",
                    hint="Other programs may use all of them.",
                )

    def close(self) -> None:
        """Ends all processes, and the connection."""
        with self._closing:
            for worker in list(self._workers):
                self._end(worker)

    def _start(self, outstanding: int) -> None:
        """Starts processes for the processors that the cluster has."""
        now = time.monotonic()
        if now >= self._counted + _GROW:
            self._processors = int(self._ray.cluster_resources().get("CPU", 0))
            self._counted = now
        # At least one, so that a cluster that can grow does.
        wanted = max(1, self._processors) if self._count is None else self._count
        while len(self._workers) < min(wanted, outstanding):
            actor = self._process.remote(self._packed, self._number)
            self._number += 1
            self._workers.append(_Worker(actor, actor.ready.remote()))

    def _assign(self, worker: _Worker[Job], task: _Task[Job]) -> None:
        worker.task = task
        task.attempts += 1
        worker.end = time.monotonic() + self._timeout
        worker.reference = worker.actor.do.remote(task.job)

    def _value(self, worker: _Worker[Job]) -> tuple[Any, str]:
        """The value that was awaited, or the reason why there is none; then the process is lost."""
        from ray.exceptions import RayError

        try:
            value = self._ray.get(worker.reference)
        except RayError as error:
            self._end(worker)
            lines = str(error).strip().splitlines()
            return None, lines[0].rstrip(".:") if lines else type(error).__name__
        worker.reference = worker.task = None
        return value, ""

    def _welcome(self, worker: _Worker[Job], value: Any, error: str) -> None:
        """Handles the first answer of a process."""
        if error:
            self._lost_starts += 1
            if self._lost_starts >= _STARTS:
                raise unusable(f"processes of the Ray cluster cannot start: {error}")
            return
        self._lost_starts = 0
        found, reason = value
        expected = versions()
        different = [
            f"{name} {found.get(name)} instead of {here}"
            for name, here in expected.items()
            if found.get(name) != here
        ]
        if different:
            raise unusable(
                f"a computer of the Ray cluster has other versions: {', '.join(different)}",
                hint="Results have the same bits only with the same versions. Install these: "
                + " ".join(f"{name}=={here}" for name, here in expected.items()),
            )
        if reason:
            raise unusable(f"a computer of the Ray cluster cannot run the sweep: {reason}")
        worker.ready = True

    def _end(self, worker: _Worker[Job]) -> None:
        """Ends a process, whatever it does."""
        self._workers.remove(worker)
        with contextlib.suppress(Exception):  # the cluster may be lost
            self._ray.kill(worker.actor)
