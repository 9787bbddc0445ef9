"""Objects between two processes that answer each other at a high rate."""

from __future__ import annotations

import multiprocessing
import os
import threading

import numpy as np
import pytest

from cartwheel.batch import link as module
from cartwheel.batch.link import Link


@pytest.fixture
def ends():
    one, other = (Link(each) for each in multiprocessing.Pipe())
    yield one, other
    one.close()
    other.close()


def test_objects_arrive_in_order(ends):
    one, other = ends
    sent = (1, None, {"pose": np.arange(6.0).reshape(2, 3)})
    one.send(sent)
    one.send("next")
    number, error, values = other.receive()
    assert (number, error) == sent[:2] and np.array_equal(values["pose"], sent[2]["pose"])
    assert other.receive() == "next"
    other.send([3])
    assert one.receive() == [3]
    one.close()
    with pytest.raises((EOFError, OSError)):
        other.receive()


@pytest.mark.parametrize("parts", [0, 1])
def test_the_rest_of_an_interrupted_transfer_is_not_received_as_the_next_one(ends, parts):
    one, other = ends
    one.send("first")
    one.send("second")
    receive = iter([other._connection._recv] * parts)

    def interrupted(size: int):
        for each in receive:
            return each(size)
        raise KeyboardInterrupt

    other._connection._recv = interrupted
    with pytest.raises(KeyboardInterrupt):
        other.receive()
    with pytest.raises(EOFError):
        other.receive()
    with pytest.raises((EOFError, OSError)):
        one.receive()


def test_a_process_looks_for_data_before_it_sleeps_if_the_last_wait_was_short(ends, monkeypatch):
    one, other = ends
    looks = []

    def look():
        looks.append(None)
        if len(looks) == 3:
            one.send("second")

    monkeypatch.setattr(module, "_SPIN", 100.0)
    monkeypatch.setattr(os, "sched_yield", look)
    one.send("first")
    assert other.receive() == "first" and not looks  # the first wait may be long
    assert other.receive() == "second" and len(looks) == 3


def test_a_process_sleeps_in_a_long_wait(ends, monkeypatch):
    one, other = ends
    asleep = threading.Event()
    times: list[float] = []

    def clock() -> float:
        times.append(float(len(times)))  # each look takes a second
        if times[-1] >= 5.0:
            asleep.set()
        return times[-1]

    def send() -> None:
        assert asleep.wait(60.0)
        one.send("second")

    monkeypatch.setattr(module, "_SPIN", 5.0)
    one.send("first")
    assert other.receive() == "first"
    sender = threading.Thread(target=send)
    with monkeypatch.context() as patched:
        patched.setattr(module.time, "perf_counter", clock)
        sender.start()
        assert other.receive() == "second"
        sender.join()
    assert len(times) == 7
    monkeypatch.setattr(os, "sched_yield", lambda: pytest.fail("it looked after a long wait"))
    one.send("third")
    assert other.receive() == "third"


@pytest.mark.parametrize(
    "array",
    [np.arange(12.0).reshape(4, 3), np.zeros((2, 0)), np.array([1.5]),
     np.arange(48, dtype=np.uint8).reshape(2, 2, 4, 3)],
)  # fmt: skip
def test_arrays_arrive_as_they_were_sent(ends, array):
    one, other = ends
    one.send(module.packed({"values": array, "more": np.ones(2)}))
    found = module.unpacked(other.receive())
    assert list(found) == ["values", "more"] and found["more"].tolist() == [1.0, 1.0]
    values = found["values"]
    assert values.dtype == array.dtype and values.flags.writeable
    assert np.array_equal(values, array) and values.shape == array.shape
