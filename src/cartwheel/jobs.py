"""Processes that do jobs in parallel. Each prepares itself once.

`concurrent.futures` is not used because a crash of one of its processes ends all others, and
because it cannot end a process that takes too long.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")
Prepare = Callable[[int], Callable[[Job], Result]]
"""Called in a process with its number. Returns the function that does a job."""

_LOOK = 0.25
"""Wall time between two checks of the time limit, s."""
_HURRY = 0.5
"""Wall time to wait for processes after `Workers.stop`, s."""
AT_TOP_LEVEL = "Define functions at the top level of a module, not as a lambda or in a function"
"""The remedy for most values that are `unpicklable`."""
_END = 5.0
"""Wall time in which a process must end, s."""
_START = 600.0
"""Wall time in which a process must start, with the imports of its jobs, s."""


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def unpicklable(value: object) -> str:
    """Why a value cannot be passed to other processes; empty if it can."""
    try:
        pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        return str(error)
    return ""


@dataclass
class _Worker(Generic[Job]):
    number: int
    process: Any
    link: Connection
    jobs: list[Job] = field(default_factory=list)
    """The current job, if there is one."""
    ready: bool = field(default=False)
    """Whether the process has started."""
    end: float = field(default=0.0)
    """Time of `time.monotonic` at which the job must be done, or the process ready."""


class Workers(Generic[Job, Result]):
    """Does jobs in processes.

    Args:
        prepare: See `Prepare`. It and all jobs must be picklable.
        lost: Returns the result of a job whose process has ended or took too long, for a reason.
        count: Number of processes.
        timeout: Maximum wall time of a job, s, without the start of its process.
        name: Name of the processes.
    """

    def __init__(
        self,
        prepare: Prepare[Job, Result],
        lost: Callable[[Job, str], Result],
        *,
        count: int,
        timeout: float,
        name: str,
    ) -> None:
        self._prepare, self._lost = prepare, lost
        self._count, self._timeout, self._name = count, timeout, name
        self._context = multiprocessing.get_context("spawn")
        self._workers: list[_Worker[Job]] = []
        self.stopped = False
        """Whether `stop` was called."""

    def stop(self) -> None:
        """Ends `run` soon. Callable in a signal handler."""
        self.stopped = True

    def run(self, jobs: Sequence[Job], count: int | None = None) -> Iterator[Result]:
        """Yields the result of each job as soon as it is known. Call `close` at the end.

        Args:
            jobs: The jobs.
            count: Maximum number of processes for them.
        """
        count = self._count if count is None else count
        waiting = deque(jobs)
        while not self.stopped and (waiting or any(each.jobs for each in self._workers)):
            while waiting and len(self._workers) < min(count, len(jobs)):
                self._start()
            for worker in self._workers[:count]:
                if not worker.jobs and waiting:
                    worker.jobs.append(waiting.popleft())
                    if worker.ready:
                        worker.end = time.monotonic() + self._timeout
                    with contextlib.suppress(OSError):  # it has crashed, which `_received` notices
                        worker.link.send(worker.jobs[0])
            busy = {each.link: each for each in self._workers if each.jobs}
            for link in wait(list(busy), _LOOK):
                assert isinstance(link, Connection)
                yield from self._received(busy[link])
            for worker in busy.values():
                if worker.jobs and time.monotonic() > worker.end:
                    late = f"it took more than {self._timeout:g} s"
                    unready = f"its process did not start within {_START:g} s"
                    yield self._replace(worker, late if worker.ready else unready)

    def _start(self) -> None:
        number = max([each.number for each in self._workers], default=-1) + 1
        ours, theirs = self._context.Pipe()
        process = self._context.Process(
            target=_work, args=(theirs, self._prepare, number), name=f"{self._name}-{number}"
        )
        process.start()
        theirs.close()
        self._workers.append(_Worker(number, process, ours, end=time.monotonic() + _START))

    def _received(self, worker: _Worker[Job]) -> Iterator[Result]:
        """The result that a process with a job has sent, or nothing if it has become ready."""
        try:
            result: Result = worker.link.recv()
        except (EOFError, OSError):
            worker.process.join(_END)
            status = worker.process.exitcode
            yield self._replace(worker, f"its process ended with status {status}")
            return
        if not worker.ready:
            worker.ready = True
            worker.end = time.monotonic() + self._timeout
            return
        worker.jobs.clear()
        yield result

    def _replace(self, worker: _Worker[Job], reason: str) -> Result:
        """The result of a job whose process ended or is too slow. The process is replaced."""
        (job,) = worker.jobs
        _end(worker.process)
        self._workers.remove(worker)
        return self._lost(job, reason)

    def close(self) -> None:
        """Ends all processes."""
        for worker in self._workers:
            worker.link.close()
        if self.stopped:
            # They end by themselves, with the programs that they have started.
            for worker in self._workers:
                worker.process.terminate()
            end = time.monotonic() + _HURRY
            for worker in self._workers:
                worker.process.join(max(0.0, end - time.monotonic()))
            self._workers.clear()
        for worker in self._workers:
            if not worker.jobs:
                worker.process.join(_END)
            _end(worker.process)
        self._workers.clear()


def _end(process: Any) -> None:
    """Ends a process. On SIGTERM, it closes what it has opened."""
    if process.is_alive():
        process.terminate()
        process.join(2 * _END)
    if process.is_alive():
        process.kill()
        process.join()


def _work(link: Connection, prepare: Prepare[Any, Any], number: int) -> None:
    """Runs in the process: receives jobs and sends results until the link is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends this one
    signal.signal(signal.SIGTERM, _interrupt)
    with contextlib.suppress(KeyboardInterrupt, EOFError, OSError):
        do = prepare(number)
        link.send(None)  # it is ready
        while True:
            job = link.recv()
            link.send(do(job))


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt
