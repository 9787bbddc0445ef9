"""Runs a function of a world for many cases."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cartwheel.errors import CartwheelError
from cartwheel.jobs import AT_TOP_LEVEL, Workers, cores, unpicklable
from cartwheel.sweeps.cluster import ClusterWorkers
from cartwheel.sweeps.results import Results, Row, invalid, plain
from cartwheel.sweeps.stored import Stored

if TYPE_CHECKING:
    from cartwheel.api import Built, World

_ERROR = "error"
"""The column of errors in the table."""
Case = Mapping[str, Any]
Job = tuple[int, dict[str, Any]]
Done = tuple[int, Row]


def sweep(
    function: Callable[[World, dict[str, Any]], Any],
    cases: Iterable[Case],
    built: Built,
    *,
    jobs: int | None = None,
    cluster: str | None = None,
    timeout: float = 3600.0,
    results: str | Path | None = None,
    progress: bool = True,
) -> Results:
    """Runs a function for each case, in a new world for each, on all cores.

    A case has the same result whatever the number of processes and the other cases, also on a
    cluster.

    Args:
        function: Receives the world and the case. Returns a number, or a mapping of numbers, texts
            and lists by name, other than those of the parameters and ``error``. An exception is
            the error of the case.
        cases: The parameters of each case by name: numbers, texts, lists and mappings. The
            parameter ``seed`` is the seed of the world, by default 0.
        built: What `cartwheel.build` returned.
        jobs: Number of processes, by default one for each core. 0 runs all cases in this process.
            Otherwise, a script must call the function below ``if __name__ == "__main__":``, and the
            function must be that of a module.
        cluster: Address of a Ray cluster that runs the cases, on all its processors or `jobs` of
            them. "auto" is the cluster to which this computer belongs, or that of the environment
            variable ``RAY_ADDRESS``. "local" starts a cluster on this computer for the sweep. If
            the program is already connected to Ray, this connection is used. The visuals of `built`
            are compiled, so that the cluster needs no files of the world and its robots.
        timeout: Maximum wall time of a case, s. A case that takes longer has an error. Without
            effect if `jobs` is 0.
        results: File for the results of cases that are done. If it exists, these cases are not run
            again, except those with an error. Delete it if the function or the robots have changed.
        progress: Whether to show a bar if standard error is a terminal.

    Raises:
        CartwheelError: A case or an argument is invalid, or the file or the cluster cannot be used.
    """
    _check(function, built)
    if cluster is None and jobs != 0 and (reason := unpicklable(function)):
        error = invalid(f"the function cannot be passed to other processes: {reason}")
        error.hint = f"{AT_TOP_LEVEL}, or pass jobs=0."
        raise error
    listed = [_case(each) for each in cases]
    least = 0 if cluster is None else 1
    if jobs is not None and jobs < least:
        raise invalid(f"the number of processes must be at least {least} (got {jobs})")
    name = f"{function.__module__}.{getattr(function, '__qualname__', type(function).__name__)}"
    stored = Stored(None if results is None else Path(results), name)
    with contextlib.closing(stored):
        found = stored.earlier(listed)
        waiting = [(index, case) for index, case in enumerate(listed) if index not in found]
        with _bar(len(listed), len(found), show=progress) as advance:
            prepare = partial(_prepare, function, built)
            if cluster is not None and waiting:
                built.compile_visuals()
            for index, row in _run(prepare, waiting, jobs, cluster, timeout):
                stored.add(row)
                found[index] = row
                advance()
    return Results([found[index] for index in range(len(listed))])


def _check(function: object, built: object) -> None:
    """Refuses arguments with which each case would fail."""
    from cartwheel.api import Built, World

    if not callable(function):
        raise invalid(
            f"the function must be a function of a world and a case (got {function!r:.60})"
        )
    if not isinstance(built, Built):
        shown = "a World" if isinstance(built, World) else f"{built!r:.60}"
        error = invalid(f"a sweep needs what cartwheel.build returned (got {shown})")
        error.hint = "Write built = cartwheel.build(world, robots)."
        raise error


def _case(case: Case) -> dict[str, Any]:
    if not isinstance(case, Mapping):
        raise invalid(f"a case must be a mapping of parameters (got {case!r:.60})")
    made: dict[str, Any] = plain(case)
    if _ERROR in made:
        raise invalid(f'a parameter cannot have the name "{_ERROR}", a column of the table')
    seed = made.get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise invalid(f'"seed" must be an integer of at least 0 (got {seed!r:.60})')
    return made


def _run(
    prepare: Callable[[int], Callable[[Job], Done]], waiting: list[Job], jobs: int | None,
    cluster: str | None, timeout: float,
) -> Iterator[Done]:  # fmt: skip
    workers: Workers[Job, Done] | ClusterWorkers[Job, Done]
    if not waiting:
        return
    if cluster is not None:
        workers = ClusterWorkers(prepare, _lost, address=cluster, count=jobs, timeout=timeout)
    elif jobs == 0:
        yield from map(prepare(0), waiting)
        return
    else:
        count = min(cores() if jobs is None else jobs, len(waiting))
        workers = Workers(prepare, _lost, count=count, timeout=timeout, name="cartwheel-sweep")
    with contextlib.closing(workers):
        yield from workers.run(waiting)


def _prepare(
    function: Callable[[World, dict[str, Any]], Any],
    built: Built,
    number: int,  # noqa: ARG001
) -> Callable[[Job], Done]:
    return partial(_do, function, built)


def _do(function: Callable[[World, dict[str, Any]], Any], built: Built, job: Job) -> Done:
    index, case = job
    start = time.perf_counter()
    values: Any = {}
    error = ""
    try:
        with built._world(seed=case.get("seed", 0), watched=False) as world:
            value = plain(function(world, dict(case)))
        values = _named(value, case)
    except CartwheelError as failure:
        error = f"{failure.message} [{failure.code.number}]"
    except Exception as failure:  # noqa: BLE001 - other cases must still run
        error = f"{type(failure).__name__}: {failure}"
    return index, Row(case=case, values=values, error=error, seconds=time.perf_counter() - start)


def _named(value: Any, case: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a case by name, none of which hides a parameter in the table."""
    values = value if isinstance(value, dict) else {"result": value}
    for name, each in values.items():
        if name == _ERROR or (name in case and each != case[name]):
            what = "the column of errors" if name == _ERROR else "a parameter"
            raise invalid(f'the result "{name}" has the name of {what}')
    return values


def _lost(job: Job, reason: str) -> Done:
    index, case = job
    return index, Row(case=case, values={}, error=f"the case was lost: {reason}")


@contextlib.contextmanager
def _bar(total: int, done: int, *, show: bool) -> Iterator[Callable[[], None]]:
    """Shows the progress on standard error within the block."""
    if not show or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = (BarColumn(bar_width=None), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("cases", total=total, completed=done)
        yield lambda: bar.advance(task)
