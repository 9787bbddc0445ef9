"""Measures subjects in processes of their own, each within its limit of CPU time."""

from __future__ import annotations

import json
import multiprocessing
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from typing import Any

from .subjects import Subject

POLL = 0.02
_PATIENCE = 5
"""Wall time over the limit of CPU time, for a machine that is busy."""


@dataclass
class _Job:
    subject: Subject
    process: ForkServerProcess
    output: Path
    begun: float


def measure_all(
    subjects: Sequence[Subject], *, workers: int, note: Callable[[str], None]
) -> dict[str, Any]:
    """The results by the subjects' keys, in their order."""
    context = multiprocessing.get_context("forkserver")
    # Each process starts from the same state, and loads nothing anew.
    context.set_forkserver_preload(["tests.golden.recordings", "tests.golden.warm"])
    results: dict[str, Any] = {}
    waiting, running = list(subjects), list[_Job]()
    with tempfile.TemporaryDirectory(prefix="golden") as folder:
        while waiting or running:
            busy = {job.subject.alone for job in running if job.subject.alone}
            ready = next((each for each in waiting if each.alone not in busy), None)
            if ready is not None and len(running) < workers:
                waiting.remove(ready)
                output = Path(folder, f"{len(results) + len(running)}-{id(ready)}.json")
                process = context.Process(target=_work, args=(ready, output))
                process.start()
                running.append(_Job(ready, process, output, time.monotonic()))
                continue
            for job in list(running):
                took = time.monotonic() - job.begun
                late = took > _PATIENCE * job.subject.limit
                if job.process.is_alive() and not late:
                    continue
                if late:
                    job.process.kill()
                job.process.join()
                running.remove(job)
                results[job.subject.key] = _result(job, late=late)
                fault = results[job.subject.key].get("fault", "")
                cpu = results[job.subject.key].pop("cpu", 0.0)
                done = f"{len(results)} of {len(subjects)}"
                note(f"{done}: {job.subject.key} {took:.1f} s, {cpu:.1f} s CPU {fault}".rstrip())
            time.sleep(POLL)
    return {each.key: results[each.key] for each in subjects}


def _result(job: _Job, *, late: bool) -> dict[str, Any]:
    if late:
        return {"fault": f"took longer than {_PATIENCE * job.subject.limit:g} s"}
    if job.process.exitcode == -signal.SIGXCPU:
        return {"fault": f"took longer than {job.subject.limit:g} s of CPU time"}
    if not job.output.is_file():
        return {"fault": f"the process ended with {job.process.exitcode}"}
    found: dict[str, Any] = json.loads(job.output.read_text())
    return found


def _work(subject: Subject, output: Path) -> None:
    limit = round(subject.limit)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    try:
        found = measure(subject)
    except Exception as error:  # noqa: BLE001 - the other subjects are measured anyway
        traceback.print_exc(file=sys.stderr)
        found = {"fault": repr(error)}
    part = output.with_suffix(".part")
    used = resource.getrusage(resource.RUSAGE_SELF)
    found["cpu"] = round(used.ru_utime + used.ru_stime, 2)
    part.write_text(json.dumps(found))
    part.rename(output)


def measure(subject: Subject) -> dict[str, Any]:
    """The results of one subject, as JSON."""
    if subject.kind == "commands":
        from .commands import measure_page

        assert subject.robot is not None
        return measure_page(subject.robot)
    if subject.kind == "example":
        from .commands import measure_example

        assert subject.robot is not None
        return measure_example(subject.robot)
    if subject.kind == "recordings":
        from .recordings import measure as measure_recordings

        return measure_recordings()
    from .trial import measure as measure_robot

    return measure_robot(subject)
