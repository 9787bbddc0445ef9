"""Processes that do jobs."""

import contextlib

from tests.sweeps import slow_start

from cartwheel.jobs import Workers


def test_the_start_of_a_process_is_not_a_part_of_its_jobs():
    workers = Workers(
        slow_start.prepare, slow_start.lost, count=1, timeout=slow_start.STARTING - 1.0, name="test"
    )
    with contextlib.closing(workers):
        assert list(workers.run([1, 2, 3])) == [2, 4, 6]
