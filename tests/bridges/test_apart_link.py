"""Functions of another process, called by name."""

import socket
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from tests.coded import raises

from cartwheel.bridges.apart import link as link_module
from cartwheel.bridges.apart import wires
from cartwheel.bridges.apart import workers as workers_module
from cartwheel.bridges.apart.link import Link
from cartwheel.codes.wires import BRIDGE_ENDED, BRIDGE_RECOVERED, BRIDGE_SLOW, CALL_LIMIT
from cartwheel.errors import ControlError, GraphError, Origin, UnknownNameError

_PATIENCE = 60.0


class Pair:
    """Both ends in one process."""

    def __init__(self) -> None:
        self.faults: list[Exception] = []
        self.ended = threading.Event()
        ours, theirs = socket.socketpair()
        self.near = Link(ours, name="near", on_end=lambda: None, on_fault=self.faults.append)
        self.far = Link(theirs, name="far", on_end=self.ended.set, on_fault=self.faults.append)


@pytest.fixture
def pair() -> Iterator[Pair]:
    made = Pair()
    yield made
    made.near.close()
    made.far.close()


def test_calls_are_answered_and_notifications_come_in_order(pair: Pair) -> None:
    reported: list[int] = []
    pair.far.handle("add", lambda a, b: a + b)
    pair.far.handle("note", reported.append)
    pair.far.handle("reported", lambda: list(reported))
    pair.near.start()
    pair.far.start()
    for number in range(500):
        pair.near.notify("note", number)
    assert pair.near.call("reported").result(_PATIENCE) == list(range(500))
    assert pair.near.call("add", 2, 3).result(_PATIENCE) == 5


def test_parameters_are_read_without_waiting(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is sent or received while a bridge waits."""
    monkeypatch.setattr(wires, "_STALE", 1e9)
    here = {"speed": 1.0}
    free = threading.Event()
    free.set()

    def values() -> tuple[int, dict[str, float]]:
        answer = 5, dict(here)
        free.wait(_PATIENCE)
        return answer

    pair.far.handle("values", values)
    pair.far.handle("set_value", here.__setitem__)
    pair.near.start()
    pair.far.start()
    graph = SimpleNamespace(time_ns=0)
    read = wires._Values(pair.near, graph)  # type: ignore[arg-type]
    assert read.get("speed") == 1.0
    assert graph.time_ns == 5
    free.clear()
    here["speed"] = 2.0
    time.sleep(2 * wires._FRESH)
    # The answer to this request does not come before the event is set.
    assert read.get("speed") == 1.0
    free.set()
    deadline = time.monotonic() + _PATIENCE
    while read.get("speed") != 2.0:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    read.set("speed", 3.0)
    assert read.get("speed") == 3.0


def test_both_may_call_each_other_at_once_with_much(pair: Pair) -> None:
    large = bytes(3_000_000)
    for link, other in ((pair.near, pair.far), (pair.far, pair.near)):
        link.handle("size", len)
        link.handle("ask_back", lambda data, other=link: other.call("size", data))
        assert other is not link
    pair.near.start()
    pair.far.start()
    futures = [link.call("ask_back", large) for link in (pair.near, pair.far) for _ in range(5)]
    assert [each.result(_PATIENCE) for each in futures] == [3_000_000] * 10


def test_what_takes_long_delays_nothing_else(pair: Pair) -> None:
    go_on = threading.Event()
    pair.far.handle("long", lambda: go_on.wait(_PATIENCE), threaded=True)
    pair.far.handle("short", lambda: "done")
    pair.near.start()
    pair.far.start()
    long = pair.near.call("long")
    assert pair.near.call("short").result(_PATIENCE) == "done"
    assert not long.done()
    go_on.set()
    assert long.result(_PATIENCE) is True


def test_a_future_is_answered_when_it_is_done(pair: Pair) -> None:
    later: Future[str] = Future()
    pair.far.handle("later", lambda: later)
    pair.near.start()
    pair.far.start()
    answer = pair.near.call("later")
    later.set_result("now")
    assert answer.result(_PATIENCE) == "now"


def test_errors_of_the_user_cross_with_place_and_hint(pair: Pair) -> None:
    origin = Origin(file="a.xacro", line=3, stack=("b.xacro:1 wheel",))
    error = GraphError("no", code=CALL_LIMIT, origin=origin, hint="Do so.", values={"most": 1})

    def refuse() -> None:
        raise error

    def unknown() -> None:
        raise UnknownNameError("topic", "/odm", ["/odom"])

    pair.far.handle("refuse", refuse)
    pair.far.handle("unknown", unknown)
    pair.far.handle("fault", lambda: {}["key"])
    pair.near.start()
    pair.far.start()
    with pytest.raises(GraphError) as refused:
        pair.near.call("refuse").result(_PATIENCE)
    assert refused.value is not error
    assert refused.value.diagnostic() == error.diagnostic()
    assert (refused.value.code, refused.value.values) == (CALL_LIMIT, {"most": 1})
    with pytest.raises(UnknownNameError) as unknown_name:
        pair.near.call("unknown").result(_PATIENCE)
    assert (unknown_name.value.values["name"], unknown_name.value.values["meant"]) == (
        "/odm",
        "/odom",
    )
    with pytest.raises(RuntimeError, match="KeyError"):
        pair.near.call("fault").result(_PATIENCE)
    pair.near.notify("fault")
    pair.near.call("refuse").exception(_PATIENCE)
    assert [type(fault) for fault in pair.faults] == [KeyError]


def test_the_end_of_the_other_is_heard_and_nobody_waits_for_ever(pair: Pair) -> None:
    pair.far.handle("never", Future)
    pair.near.handle("never", Future)
    pair.near.start()
    pair.far.start()
    waiting = pair.far.call("never")
    pair.near.close()
    assert pair.ended.wait(_PATIENCE)
    with raises(BRIDGE_ENDED, ControlError):
        waiting.result(_PATIENCE)
    with raises(BRIDGE_ENDED, ControlError):
        pair.far.call("never").result(_PATIENCE)
    pair.far.notify("never")


def test_what_nobody_reads_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link_module, "_LATE", 500_000)
    monkeypatch.setattr(link_module, "_MOST", 2_000_000)
    near, far = socket.socketpair()
    ended = threading.Event()
    faults: list[Exception] = []
    link = Link(near, name="near", on_end=ended.set, on_fault=faults.append)
    link.start()
    for _ in range(20):
        link.notify_in_time("feedback", bytes(100_000))
    assert not link.loop.call(lambda: link._ended).result(_PATIENCE)
    assert 0 < link.dropped < 20
    waiting = link.call("never")
    for _ in range(30):
        link.notify("much", bytes(100_000))
    assert ended.wait(_PATIENCE)
    assert [getattr(fault, "code", fault) for fault in faults] == [BRIDGE_SLOW, BRIDGE_SLOW]
    with pytest.raises(ControlError):
        waiting.result(_PATIENCE)
    link.close()
    far.close()


def test_what_waits_for_the_loop_itself_is_bounded(
    monkeypatch: pytest.MonkeyPatch, pair: Pair
) -> None:
    monkeypatch.setattr(link_module, "_MOST", 2_000_000)
    go_on = threading.Event()
    pair.far.handle("small", lambda: None)
    pair.near.start()
    pair.far.start()
    pair.near.loop.post(lambda: go_on.wait(_PATIENCE))
    for _ in range(10_000):
        pair.near.notify("small")
    assert len(pair.near.loop._functions) < 2500
    late = pair.near.call("small")
    with pytest.raises(ControlError):
        late.result(_PATIENCE)
    go_on.set()
    assert pair.ended.wait(_PATIENCE)
    assert getattr(pair.faults[0], "code", None) is BRIDGE_SLOW


def test_dropped_feedback_is_counted_for_the_user(
    monkeypatch: pytest.MonkeyPatch, pair: Pair
) -> None:
    monkeypatch.setattr(link_module, "_LATE", 500_000)
    monkeypatch.setattr(link_module, "_LOOKS", 0.01)
    read: list[int] = []
    pair.far.handle("feedback", lambda data: read.append(len(data)))
    pair.far.handle("done", lambda: None)
    pair.near.start()
    for _ in range(50):
        pair.near.notify_in_time("feedback", bytes(100_000))
    pair.far.start()
    pair.near.call("done").result(_PATIENCE)
    reported = threading.Event()
    monkeypatch.setattr(
        pair.near, "_on_fault", lambda fault: (pair.faults.append(fault), reported.set())
    )
    if len(pair.faults) < 2:
        assert reported.wait(_PATIENCE)
    assert [getattr(fault, "code", fault) for fault in pair.faults] == [
        BRIDGE_SLOW,
        BRIDGE_RECOVERED,
    ]
    assert getattr(pair.faults[1], "values", None) == {"dropped": 50 - len(read)}
    assert 0 < len(read) < 50


def test_calls_that_take_long_have_a_bounded_number_of_threads(
    monkeypatch: pytest.MonkeyPatch, pair: Pair
) -> None:
    monkeypatch.setattr(workers_module, "WAITING", 100)
    go_on = threading.Event()
    started: list[str] = []

    def wait() -> bool:
        started.append(threading.current_thread().name)
        return go_on.wait(_PATIENCE)

    pair.far.handle("long", wait, threaded=True)
    pair.far.handle("short", lambda: "done")
    pair.near.start()
    pair.far.start()
    before = threading.active_count()
    calls = [pair.near.call("long") for _ in range(500)]
    assert pair.near.call("short").result(_PATIENCE) == "done"
    assert threading.active_count() <= before + workers_module.THREADS
    go_on.set()
    errors = [call.exception(_PATIENCE) for call in calls]
    refused = [error for error in errors if isinstance(error, ControlError)]
    assert len(started) == 500 - len(refused) >= workers_module.THREADS + 100
    assert len(refused) >= 500 - 2 * workers_module.THREADS - 100
    assert (refused[0].code, refused[0].values["name"]) == (CALL_LIMIT, "long")
