"""Processes that run cases in parallel. Each builds the worlds that it needs once.

`concurrent.futures` is not used because a crash of one of its processes ends all others, and
because it cannot end a process that takes too long.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import Any

from cartwheel.scenarios.cases import Case, Scenario
from cartwheel.scenarios.outcome import Finding, Outcome
from cartwheel.scenarios.runner import Options, Runner

_LOOK = 0.25
"""Wall time between two checks of the time limit, s."""
_HURRY = 0.5
"""Wall time to wait for processes after `Workers.stop`, s."""
_END = 5.0
"""Wall time in which a process must end, s."""


@dataclass
class _Worker:
    number: int
    process: Any
    link: Connection
    case: Case | None = None
    end: float = field(default=0.0)
    """Time of `time.monotonic` at which the case must be done."""


class Workers:
    """Runs cases in processes.

    Args:
        scenarios: All scenarios.
        options: How cases are run.
        count: Number of processes.
        timeout: Maximum wall time of a case, s.
    """

    def __init__(
        self, scenarios: Sequence[Scenario], options: Options, count: int, timeout: float
    ) -> None:
        self._scenarios, self._options = list(scenarios), options
        self._count, self._timeout = count, timeout
        self._context = multiprocessing.get_context("spawn")
        self._workers: list[_Worker] = []
        self.stopped = False
        """Whether `stop` was called."""

    def stop(self) -> None:
        """Ends `run` soon. Callable in a signal handler."""
        self.stopped = True

    def run(self, cases: Sequence[Case]) -> Iterator[Outcome]:
        """Yields the outcome of each case as soon as it is known.

        Cases that use the ROS network of other programs run one at a time, after all others.
        """
        alone = [case for case in cases if self._is_alone(case)]
        together = [case for case in cases if not self._is_alone(case)]
        try:
            yield from self._run(together, self._count)
            yield from self._run(alone, 1)
        finally:
            self.close()

    def _is_alone(self, case: Case) -> bool:
        value = self._scenarios[case.scenario].value
        return "lockstep" in value and "launch" not in value

    def _run(self, cases: Sequence[Case], count: int) -> Iterator[Outcome]:
        waiting = deque(cases)
        while not self.stopped and (
            waiting or any(each.case is not None for each in self._workers)
        ):
            while waiting and len(self._workers) < min(count, len(cases)):
                self._start()
            for worker in self._workers[:count]:
                if worker.case is None and waiting:
                    worker.case = waiting.popleft()
                    worker.end = time.monotonic() + self._timeout
                    with contextlib.suppress(OSError):  # it has crashed, which `_result` notices
                        worker.link.send(worker.case)
            busy = {each.link: each for each in self._workers if each.case is not None}
            for link in wait(list(busy), _LOOK):
                assert isinstance(link, Connection)
                yield self._result(busy[link])
            for worker in busy.values():
                if worker.case is not None and time.monotonic() > worker.end:
                    yield self._lost(worker, f"the case took more than {self._timeout:g} s")

    def _start(self) -> None:
        number = max([each.number for each in self._workers], default=-1) + 1
        ours, theirs = self._context.Pipe()
        process = self._context.Process(
            target=_work,
            args=(theirs, self._scenarios, self._options, number),
            name=f"cartwheel-test-{number}",
        )
        process.start()
        theirs.close()
        self._workers.append(_Worker(number, process, ours))

    def _result(self, worker: _Worker) -> Outcome:
        assert worker.case is not None
        try:
            outcome: Outcome = worker.link.recv()
        except (EOFError, OSError):
            worker.process.join(_END)
            status = worker.process.exitcode
            return self._lost(worker, f"the process of the case ended with status {status}")
        worker.case = None
        return outcome

    def _lost(self, worker: _Worker, reason: str) -> Outcome:
        """The outcome of a case whose process ended or is too slow. The process is replaced."""
        case = worker.case
        assert case is not None
        _end(worker)
        self._workers.remove(worker)
        scenario = self._scenarios[case.scenario]
        origin = scenario.document.origin()
        finding = Finding(
            kind="error", expected="", actual=reason, file=origin.file, line=origin.line, time=None
        )
        return Outcome(
            id=case.id, scenario=scenario.name, file=str(scenario.file), digest=case.digest,
            parameters=dict(case.parameters), seed=case.seed, status="error", findings=[finding],
        )  # fmt: skip

    def close(self) -> None:
        """Ends all processes."""
        for worker in self._workers:
            with contextlib.suppress(OSError):
                worker.link.send(None)
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
            if worker.case is None:
                worker.process.join(_END)
            _end(worker)
        self._workers.clear()


def _end(worker: _Worker) -> None:
    """Ends a process. On SIGTERM, it closes its world and ends the programs of the case."""
    if worker.process.is_alive():
        worker.process.terminate()
        worker.process.join(2 * _END)
    if worker.process.is_alive():
        worker.process.kill()
        worker.process.join()


def _work(link: Connection, scenarios: Sequence[Scenario], options: Options, number: int) -> None:
    """Runs in the process: receives cases and sends outcomes until the link is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends this one
    signal.signal(signal.SIGTERM, _interrupt)
    runner = Runner(scenarios, options, worker=number)
    with contextlib.suppress(KeyboardInterrupt, EOFError, OSError):
        while (case := link.recv()) is not None:
            link.send(runner.run(case))


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt
