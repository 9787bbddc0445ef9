"""Processes that run cases in parallel. Each builds the worlds that it needs once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from cartwheel import jobs
from cartwheel.scenarios.cases import Case, Scenario
from cartwheel.scenarios.outcome import Finding, Outcome
from cartwheel.scenarios.runner import Options, Runner


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
        self._scenarios = list(scenarios)
        self._workers: jobs.Workers[Case, Outcome] = jobs.Workers(
            partial(_prepare, self._scenarios, options),
            self._lost,
            count=count,
            timeout=timeout,
            name="cartwheel-test",
        )

    @property
    def stopped(self) -> bool:
        """Whether `stop` was called."""
        return self._workers.stopped

    def stop(self) -> None:
        """Ends `run` soon. Callable in a signal handler."""
        self._workers.stop()

    def run(self, cases: Sequence[Case]) -> Iterator[Outcome]:
        """Yields the outcome of each case as soon as it is known.

        Cases that use the ROS network of other programs run one at a time, after all others.
        """
        alone = [case for case in cases if self._is_alone(case)]
        together = [case for case in cases if not self._is_alone(case)]
        try:
            yield from self._workers.run(together)
            yield from self._workers.run(alone, 1)
        finally:
            self.close()

    def close(self) -> None:
        """Ends all processes."""
        self._workers.close()

    def _is_alone(self, case: Case) -> bool:
        value = self._scenarios[case.scenario].value
        return "lockstep" in value and "launch" not in value

    def _lost(self, case: Case, reason: str) -> Outcome:
        scenario = self._scenarios[case.scenario]
        origin = scenario.document.origin()
        finding = Finding(
            kind="error", expected="", actual=f"the case was lost: {reason}", file=origin.file,
            line=origin.line, time=None,
        )  # fmt: skip
        return Outcome(
            id=case.id, scenario=scenario.name, file=str(scenario.file), digest=case.digest,
            parameters=dict(case.parameters), seed=case.seed, status="error", findings=[finding],
        )  # fmt: skip


def _prepare(
    scenarios: Sequence[Scenario], options: Options, number: int
) -> Callable[[Case], Outcome]:
    return Runner(scenarios, options, worker=number).run
