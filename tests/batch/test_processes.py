"""Batches with threads, forks and processes that are killed."""

from __future__ import annotations

import multiprocessing
import signal
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from tests.batch import duties
from tests.coded import raises

import cartwheel as cw
from cartwheel.batch import Batch
from cartwheel.codes.world import BATCH_CLOSED, BATCH_INVALID

FORK = multiprocessing.get_context("fork")


@pytest.fixture(scope="module")
def built():
    return cw.build("empty", ["rosbots.xacro"])


def forked(built, n=3, workers=2, **options) -> Batch:
    """Worlds in this process and in forked ones."""
    options = {"obs": {"pose": duties.pose}, **options}
    return Batch(built, n, act=duties.ACT, workers=workers, start_method="fork", **options)


def test_forked_processes_end_when_their_parent_is_killed(built) -> None:
    ours, theirs = FORK.Pipe(duplex=False)

    def run() -> None:
        with forked(built):
            theirs.send("started")
            signal.pause()

    parent = FORK.Process(target=run)
    parent.start()
    theirs.close()
    assert ours.recv() == "started"
    parent.kill()
    parent.join()
    # The pipe is closed once all processes that have a copy of its end have ended.
    assert ours.poll(30)
    with pytest.raises(EOFError):
        ours.recv()


def test_threads_step_one_after_the_other(built) -> None:
    with forked(built) as batch, ThreadPoolExecutor(2) as threads:
        batch.reset()
        steps = [threads.submit(batch.step, np.zeros((3, 2))) for _ in range(20)]
        assert all(step.result(timeout=60)["pose"].shape == (3, 3) for step in steps)


def test_a_batch_belongs_to_its_process(built) -> None:
    codes = FORK.SimpleQueue()
    with forked(built) as batch:
        batch.reset()

        def use() -> None:
            with raises(BATCH_CLOSED):
                batch.step(np.zeros((3, 2)))
            batch.close()  # does not end the processes of the other one
            codes.put("refused")

        other = FORK.Process(target=use)
        other.start()
        other.join(60)
        assert other.exitcode == 0 and codes.get() == "refused"
        assert batch.step(np.zeros((3, 2)))["pose"].shape == (3, 3)


def test_a_daemonic_process_runs_all_worlds_itself(built) -> None:
    counts = FORK.SimpleQueue()

    def run() -> None:
        with forked(built, workers=None) as batch:
            counts.put(len(batch._processes))
        with raises(BATCH_INVALID):
            forked(built, workers=1)
        counts.put("refused")

    process = FORK.Process(target=run, daemon=True)
    process.start()
    process.join(60)
    assert process.exitcode == 0
    assert counts.get() == 0 and counts.get() == "refused"


def changing(world: cw.World):
    """A picture, and other numbers once the cart has moved."""
    still = abs(world.model("rosbots").pose.x) < 0.05
    return np.zeros(2, np.uint8) if still else np.full(2, 3.7)


def too_large(world: cw.World) -> list[int]:
    """A number that is none of float64."""
    return [10**400]


@pytest.mark.parametrize("workers", [0, 1])
def test_observations_of_different_types_are_errors(built, workers) -> None:
    with forked(built, 2, workers, obs={"o": changing}) as batch:
        assert batch.reset()["o"].dtype == np.uint8
        with raises(BATCH_INVALID):
            for _ in range(10):
                batch.step(np.array([[0.0, 0.0], [1.0, 0.0]]))


@pytest.mark.parametrize("workers", [0, 1])
def test_too_large_numbers_are_errors(built, workers) -> None:
    with forked(built, 2, workers, obs={"o": too_large}) as batch, raises(BATCH_INVALID):
        batch.reset()
