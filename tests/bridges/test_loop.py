"""The loop on which a bridge's connections live."""

import gc
import sys
import threading
from collections.abc import Iterator

import pytest

from cartwheel.bridges.loop import Loop


@pytest.fixture
def loop() -> Iterator[Loop]:
    faults: list[Exception] = []
    made = Loop(faults.append, name="test")
    made.start()
    yield made
    made.stop()
    assert not faults


@pytest.fixture
def unhurried() -> Iterator[None]:
    """No thread has to make way for another: Python's lock changes hands where it is let go of."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    # What it frees may let go of the lock, such as a socket that nobody has closed.
    gc.disable()
    yield
    gc.enable()
    sys.setswitchinterval(before)


def test_who_posts_does_not_wait_for_what_is_posted(loop: Loop, unhurried: None) -> None:
    for _ in range(200):
        ran: list[bool] = []
        done = threading.Event()
        loop.post(lambda ran=ran, done=done: (ran.append(True), done.set()))  # type: ignore[misc]
        early = bool(ran)
        assert done.wait(60)
        assert not early


def test_what_is_posted_runs_in_order(loop: Loop) -> None:
    ran: list[int] = []
    for number in range(1000):
        loop.post(lambda number=number: ran.append(number))  # type: ignore[misc]
    assert loop.call(lambda: len(ran)).result(60) == 1000
    assert ran == list(range(1000))


def test_posting_to_a_loop_that_has_ended_is_no_fault(loop: Loop) -> None:
    loop.stop()
    loop._thread.join(60)
    for _ in range(10):
        loop.post(lambda: None)
        loop._woken = False
