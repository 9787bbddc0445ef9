"""A graph seen from another process: both ends here, each with threads of its own."""

import queue
import socket
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.bridges.apart import host as host_module
from cartwheel.bridges.apart.host import GraphHost
from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.remote_graph import RemoteGraph
from cartwheel.bridges.apart.ring import RingReader, RingWriter
from cartwheel.bridges.apart.ring_files import RingFiles
from cartwheel.codes.graph import (
    ACTION_GONE,
    SERVICE_FAILED,
    SERVICE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.codes.wires import BRIDGE_RECOVERED, BRIDGE_SLOW
from cartwheel.errors import Diagnostic, GraphError, UnknownNameError
from cartwheel.graph import Action, Goal, GoalState, Graph
from cartwheel.messages import message_class, service_classes, zero

_PATIENCE = 60.0
STRING, CLOCK = "std_msgs/msg/String", "rosgraph_msgs/msg/Clock"
TRIGGER = "std_srvs/srv/Trigger"


class Apart:
    """A graph whose owner is a thread, and what a bridge sees of it."""

    def __init__(self, *, echo: bool = False, patient: bool = False, size: int = 1 << 20) -> None:
        self._posted: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self.owned = Graph(self._posted.put)
        self.time_ns = 0
        self.reports: list[Diagnostic] = []
        self.faults: list[Exception] = []
        ours, theirs = socket.socketpair()
        files, others = RingFiles.pair(size)
        self.link = Link(ours, name="ours", on_end=lambda: None, on_fault=self.faults.append)
        self.host = GraphHost(
            self.owned,
            self.link,
            RingWriter(files),
            time_ns=lambda: self.time_ns,
            patient=patient,
            echo=echo,
            title="ROS",
            report=self.reports.append,
        )
        self.far = Link(theirs, name="far", on_end=lambda: None, on_fault=self.faults.append)
        self.graph = RemoteGraph(self.far, on_fault=self.faults.append)
        self.reader = RingReader(
            others, patient=patient, take=self.graph.take, on_fault=self.faults.append
        )
        self._thread = threading.Thread(target=self._own, daemon=True)

    def start(self) -> None:
        self._thread.start()
        self.link.start()
        self.far.start()
        self.graph.begin()
        self.reader.start()

    def close(self) -> None:
        self.host.close()
        self.link.close()
        self.far.close()
        self._posted.put(None)

    def own(self, function: Callable[[], Any]) -> Any:
        """Runs a function as the owner does."""
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._posted.put(lambda: done.put(function()))
        return done.get(timeout=_PATIENCE)

    def _own(self) -> None:
        while True:
            function = self._posted.get()
            if function is None:
                return
            function()


def until(condition: Callable[[], Any]) -> None:
    deadline = time.monotonic() + _PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


@pytest.fixture
def apart() -> Iterator[Apart]:
    made = Apart()
    made.start()
    yield made
    made.close()
    assert not made.faults


def _text(data: str) -> Any:
    return message_class(STRING)(data=data)


def test_topics_services_and_nodes_are_seen_as_they_change(apart: Apart) -> None:
    changes = []
    apart.graph.on_change.append(lambda: changes.append(len(apart.graph.topics())))
    publisher = apart.owned.advertise("/a", STRING, node="talker", rate=5.0, qos="latched")
    service = apart.owned.serve("/s", TRIGGER, lambda _: None)
    until(lambda: apart.graph.services() and apart.graph.topics())
    assert apart.graph.topics() == apart.owned.topics()
    (seen,) = apart.graph.services()
    assert (seen.name, seen.type, seen.node) == ("/s", TRIGGER, "cartwheel")
    apart.owned.nodes["talker"] = "/talker"
    apart.owned.advertise("/b", STRING)
    until(lambda: len(apart.graph.topics()) == 2)
    assert apart.graph.services()[0] is seen, "who mirrors services goes by identity"
    assert apart.graph.nodes == {"talker": "/talker"}
    apart.owned.withdraw(service)
    apart.owned.serve("/s", TRIGGER, lambda _: None)
    until(lambda: apart.graph.services() and apart.graph.services()[0] is not seen)
    publisher.close()
    until(lambda: [info.name for info in apart.graph.topics()] == ["/b"])
    assert changes


def test_messages_come_in_order_with_their_times_and_subscribers_are_known(apart: Apart) -> None:
    publisher = apart.owned.advertise("/a", STRING)
    assert not publisher.wanted
    until(apart.graph.topics)
    taken: list[tuple[int, str]] = []
    subscription = apart.graph.subscribe(
        "/a", lambda message: taken.append((apart.graph.time_ns, message.data)), node="bridge"
    )
    assert publisher.wanted
    assert apart.owned.topic("/a").subscribers == ("bridge",)

    def publish() -> None:
        for number in range(100):
            apart.time_ns = number * 1000
            publisher.publish(_text(str(number)))

    apart.own(publish)
    until(lambda: len(taken) == 100)
    assert taken == [(number * 1000, str(number)) for number in range(100)]
    subscription.dropped = lambda: 7
    until(lambda: apart.owned.topic("/a").dropped == (7,))
    subscription.close()
    until(lambda: not publisher.wanted)


def test_the_last_message_of_a_latched_topic_comes_at_once(apart: Apart) -> None:
    publisher = apart.owned.advertise("/a", STRING, qos="latched")
    apart.own(lambda: publisher.publish(_text("kept")))
    until(apart.graph.topics)
    taken: list[str] = []
    apart.graph.subscribe("/a", lambda message: taken.append(message.data))
    until(lambda: taken == ["kept"])


def test_large_messages_keep_their_bytes(apart: Apart) -> None:
    publisher = apart.owned.advertise("/image", "sensor_msgs/msg/Image")
    until(apart.graph.topics)
    taken: list[Any] = []
    apart.graph.subscribe("/image", taken.append)
    message = zero("sensor_msgs/msg/Image")
    message.width, message.height, message.step, message.encoding = 300, 200, 900, "rgb8"
    message.data = np.arange(180_000, dtype=np.uint8)
    apart.own(lambda: publisher.publish(message))
    until(lambda: taken)
    assert apart.graph.cdr.encode(taken[0]) == apart.owned.cdr.encode(message)
    assert taken[0].width == 300
    assert np.array_equal(taken[0].data, message.data)


def test_names_and_types_that_do_not_fit_are_refused_as_at_home(apart: Apart) -> None:
    apart.owned.advertise("/a", STRING)
    until(apart.graph.topics)
    with raises(TOPIC_TYPE_MISMATCH):
        apart.graph.subscribe("/a", lambda _: None, type_name=CLOCK)
    with raises(TOPIC_UNKNOWN, UnknownNameError, name="/aa"):
        apart.graph.subscribe("/aa", lambda _: None)
    with raises(SERVICE_UNKNOWN, UnknownNameError, name="/t"):
        apart.graph.call("/t", None)


@pytest.mark.parametrize("echo", [False, True])
def test_what_the_bridge_publishes_comes_back_only_where_it_is_to(echo: bool) -> None:
    apart = Apart(echo=echo)
    apart.start()
    heard: list[str] = []
    apart.owned.subscribe("/a", lambda message: heard.append(message.data), type_name=STRING)
    publisher = apart.owned.advertise("/a", STRING)
    until(apart.graph.topics)
    taken: list[str] = []
    apart.graph.subscribe("/a", lambda message: taken.append(message.data))
    apart.graph.publish("/a", STRING, _text("from outside"))
    done = threading.Event()
    apart.graph.post(done.set)
    assert done.wait(_PATIENCE)
    assert heard == ["from outside"], "what is posted comes after what was published"
    apart.own(lambda: publisher.publish(_text("from inside")))
    until(lambda: "from inside" in taken)
    assert taken == (["from outside"] if echo else []) + ["from inside"]
    apart.close()
    assert not apart.faults


def test_services_answer_refuse_and_fail(apart: Apart) -> None:
    response = service_classes(TRIGGER)[1]
    owner: list[str] = []

    def serve(_: Any) -> Any:
        owner.append(threading.current_thread().name)
        return response(success=True, message="done")

    def refuse(_: Any) -> Any:
        raise GraphError("not now", code=SERVICE_FAILED, hint="Later.")

    apart.owned.serve("/yes", TRIGGER, serve)
    apart.owned.serve("/slow", TRIGGER, serve, threaded=True)
    apart.owned.serve("/no", TRIGGER, refuse)
    until(lambda: len(apart.graph.services()) == 3)
    request = service_classes(TRIGGER)[0]()
    for name in ("/yes", "/slow"):
        answer = apart.graph.call(name, request).result(_PATIENCE)
        assert (answer.success, answer.message) == (True, "done")
    assert owner[0] != owner[1], "one on the owner's thread, the other beside it"
    with raises(SERVICE_FAILED, GraphError) as failed:
        apart.graph.call("/no", request).result(_PATIENCE)
    assert failed.value.hint == GraphError("", hint="Later.").hint


def test_parameters_are_those_of_the_graph(apart: Apart) -> None:
    apart.owned.parameters.set("/a/b", 3)
    assert apart.graph.parameters.get("/a/b") == 3
    assert apart.graph.parameters.get("/c", "none") == "none"
    apart.graph.parameters.set("/c", [1.5, 2.5])
    assert apart.owned.parameters.get("/c") == [1.5, 2.5]


def test_a_bridge_may_keep_the_parameters(apart: Apart) -> None:
    class Kept:
        def __init__(self) -> None:
            self.values: dict[str, Any] = {"/there": 1}

        def get(self, name: str) -> Any:
            return self.values.get(name)

        def set(self, name: str, value: Any) -> None:
            self.values[name] = value

    kept = Kept()
    apart.graph.parameters.server = kept
    assert apart.owned.parameters.get("/there") == 1
    apart.owned.parameters.set("/new", np.float64(2.5))
    until(lambda: "/new" in kept.values)
    assert kept.values["/new"] == 2.5
    apart.graph.parameters.server = None
    until(lambda: apart.owned.parameters.get("/there") is None)


def test_goals_are_submitted_followed_and_called_off(apart: Apart) -> None:
    kind = "control_msgs_ros2/action/FollowJointTrajectory"
    goals: list[Goal] = []

    def take(goal: Goal) -> None:
        goals.append(goal)
        goal.accept()

    action = Action(
        apart.owned,
        "/follow",
        kind,
        node="arm",
        time_ns=lambda: apart.time_ns,
        on_goal=take,
        on_cancel=lambda goal: goal.cancel(zero(f"{kind}_Result"), "called off"),
    )
    until(apart.graph.actions)
    (seen,) = apart.graph.actions()
    assert (seen.name, seen.type, seen.node) == ("/follow", kind, "arm")

    class Listener:
        wants_feedback = False
        changed: list[tuple[str, GoalState]]
        going: list[Any]

        def __init__(self) -> None:
            self.changed, self.going = [], []

        def goal_changed(self, goal: Goal) -> None:
            self.changed.append((goal.id, goal.state))

        def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
            self.going.append((goal.id, feedback.__msgtype__))

    listener = Listener()
    apart.graph.run(lambda: seen.listen(listener)).result(_PATIENCE)
    made = apart.graph.run(lambda: seen.submit(zero(f"{kind}_Goal"), identity="one")).result()
    assert made is not None
    assert (made.id, made.state) == ("one", GoalState.ACTIVE)
    assert (
        apart.graph.run(lambda: seen.submit(zero(f"{kind}_Goal"), identity="one")).result() is None
    )
    assert action.wants_feedback is False
    listener.wants_feedback = True
    until(lambda: action.wants_feedback)
    apart.own(lambda: goals[0].feedback(zero(f"{kind}_Feedback")))
    until(lambda: listener.going)
    assert listener.going == [("one", f"{kind}_Feedback")]
    (called_off,) = apart.graph.run(lambda: seen.cancel(identity="one")).result()
    assert (called_off.state, called_off.text) == (GoalState.CANCELLED, "called off")
    found = apart.graph.run(lambda: seen.goal("one")).result()
    assert found is not None
    assert found.result is not None
    assert [goal.id for goal in apart.graph.run(lambda: seen.goals).result()] == ["one"]
    until(lambda: ("one", GoalState.CANCELLED) in listener.changed)
    action.close()
    until(lambda: not apart.graph.actions())
    with raises(ACTION_GONE):
        apart.graph.run(lambda: seen.goals).result()
    seen.leave(listener)


def test_a_bridge_that_stands_still_costs_messages_and_no_time() -> None:
    apart = Apart(size=1 << 16)
    apart.start()
    publisher = apart.owned.advertise("/a", STRING)
    until(apart.graph.topics)
    held = threading.Event()
    taken: list[str] = []

    def take(message: Any) -> None:
        held.wait(_PATIENCE)
        taken.append(message.data[:3])

    apart.graph.subscribe("/a", take, node="bridge")
    for number in range(100):
        apart.own(lambda number=number: publisher.publish(_text(f"{number:03}" + "x" * 2000)))
    (dropped,) = apart.owned.topic("/a").dropped
    assert 60 < dropped < 80
    until(lambda: len(apart.reports) == 1)
    held.set()
    until(lambda: len(taken) == 100 - dropped)
    assert taken == [f"{number:03}" for number in range(100 - dropped)]
    until(lambda: len(apart.reports) == 2)
    assert [report.code for report in apart.reports] == [BRIDGE_SLOW, BRIDGE_RECOVERED]
    assert apart.reports[1].values == {"dropped": dropped, "topics": ("/a",)}
    apart.close()


def test_nothing_is_lost_where_nothing_may_be() -> None:
    apart = Apart(size=1 << 16, patient=True)
    apart.start()
    publisher = apart.owned.advertise("/a", STRING)
    until(apart.graph.topics)
    taken: list[str] = []

    def take(message: Any) -> None:
        time.sleep(0.001)
        taken.append(message.data)

    apart.graph.subscribe("/a", take)
    texts = [f"{number:03}" + "x" * 3000 for number in range(200)]
    for text in texts:
        apart.own(lambda text=text: publisher.publish(_text(text)))
    assert apart.host.waited > 0
    until(lambda: len(taken) == 200)
    assert taken == texts
    assert apart.owned.topic("/a").dropped == (0,)
    apart.close()


class Wall:
    """The clock on the wall, turned by hand."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Wall:
    made = Wall()
    monkeypatch.setattr(host_module, "time", made)
    return made


def _ticks(apart: Apart, wall: Wall, times: list[float]) -> list[int]:
    """Publishes a clock at each time on the wall; the ticks that come."""
    publisher = apart.owned.advertise("/clock", CLOCK)
    until(apart.graph.topics)
    taken: list[int] = []
    apart.graph.subscribe("/clock", lambda message: taken.append(message.clock.sec))

    def publish(number: int, when: float) -> None:
        wall.now = when
        message = zero(CLOCK)
        message.clock.sec = number
        publisher.publish(message)

    for number, when in enumerate(times):
        apart.own(lambda number=number, when=when: publish(number, when))
    wall.now = times[-1] + 1.0
    until(lambda: taken and taken[-1] == len(times) - 1)
    return taken


def test_each_time_is_passed_on_in_real_time(apart: Apart, wall: Wall) -> None:
    # A thousand a second, ten at each turn of the loop.
    times = [0.01 * (number // 10) for number in range(2000)]
    assert _ticks(apart, wall, times) == list(range(2000))


def test_of_times_at_full_speed_the_newest_are_passed_on(apart: Apart, wall: Wall) -> None:
    ticks = _ticks(apart, wall, [number / 20_000 for number in range(20_000)])
    assert ticks == sorted(set(ticks))
    assert 1000 <= len(ticks) <= 100 + 1010
    # Who waits for a time does not wait long: as many went in each tenth of the second.
    assert all(any(2000 * n <= tick < 2000 * (n + 1) for tick in ticks) for n in range(10))
    assert apart.owned.topic("/clock").dropped == (0,)
    assert not apart.reports
