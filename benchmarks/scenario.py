"""The CPU time of a scenario's cases, in one process."""

from __future__ import annotations

import gc
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.carts import Bare, driving
from benchmarks.figure import Effort, Figure
from cartwheel.scenarios.cases import cases_of, load_scenario
from cartwheel.scenarios.runner import Options, Runner

_SECONDS = 10.0
_SCENARIO = """
robots: [{robot: rosbots.xacro, name: cart}]
parameters: {speed: {uniform: [0.2, 1.0]}}
seeds: 25
steps:
  - publish: /part2_cmr/cmd_vel
    message: {linear: {x: "${speed}"}}
  - wait: 10
expect:
  - {reaches: cart, x: "${2 * speed}", y: 0, within: 0.5}
"""


def figures(effort: Effort) -> Iterator[Figure]:
    """Cases that drive a cart for 10 s and evaluate a condition every 20 ms."""
    with tempfile.TemporaryDirectory() as folder, driving() as world:
        file = Path(folder) / "drive.yaml"
        file.write_text(_SCENARIO)
        scenario = load_scenario(file)
        runner = Runner([scenario], Options(folder=Path(folder), record="none", pictures="none"))
        bare = Bare(world)
        cases, alone = [], []
        first, *others = cases_of(scenario)[: effort.rounds + 1]
        runner.run(first)
        for case in others:
            gc.collect()
            start = time.process_time()
            outcome = runner.run(case)
            middle = time.process_time()
            bare.step(_SECONDS)
            cases.append(middle - start)
            alone.append(time.process_time() - middle)
            assert outcome.status == "passed"
    group = "A case that drives a cart for 10 s, CPU time"
    yield Figure(
        group=group,
        name="case",
        value=1e3 * statistics.median(cases),
        unit="ms",
        goal=100,
        note="1000 cases in 50 s on two cores",
    )
    ratio = statistics.median(one / other for one, other in zip(cases, alone, strict=True))
    yield Figure(group=group, name="time to bare loop", value=ratio, unit="ratio")
