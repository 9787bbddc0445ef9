"""Topics and services: types, who reads, what a late reader gets, what a slow one loses."""

import threading
import time

import pytest
from tests.coded import raises

from cartwheel.codes.graph import (
    GRAPH_NAME_INVALID,
    SERVICE_TAKEN,
    SERVICE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.errors import UnknownNameError
from cartwheel.graph import Graph, Mailbox, resolve_name
from cartwheel.graph.holding import hold_back, let_pass
from cartwheel.messages import Form, zero

TWIST, TEXT = "geometry_msgs/msg/Twist", "std_msgs/msg/String"
POINT = "geometry_msgs/msg/Point"


@pytest.mark.parametrize(
    ("name", "namespace", "expected"),
    [
        ("odom", "", "/odom"),
        ("odom", "robot1", "/robot1/odom"),
        ("odom", "/robot1/", "/robot1/odom"),
        ("/odom", "robot1", "/odom"),
        ("camera//image", "", "/camera/image"),
        ("a/b", "c/d", "/c/d/a/b"),
    ],
)
def test_names_resolve_as_in_ros(name, namespace, expected):
    assert resolve_name(name, namespace) == expected


@pytest.mark.parametrize("name", ["", "/", "a b", "3d", "a/4b", "a-b", "é", "a\n"])
def test_names_that_ros_refuses(name):
    with raises(GRAPH_NAME_INVALID):
        resolve_name(name)


def test_messages_come_in_order_and_only_while_subscribed():
    graph, got = Graph(), []
    publisher = graph.advertise("a", TWIST)
    publisher.publish(1)
    subscription = graph.subscribe("/a", got.append)
    publisher.publish(2)
    publisher.publish(3)
    subscription.close()
    publisher.publish(4)
    assert got == [2, 3]


def test_wanted_is_whether_somebody_reads():
    graph = Graph()
    publisher = graph.advertise("/a", TWIST)
    assert not publisher.wanted
    one, two = graph.subscribe("/a", print), graph.mailbox("/a")
    assert publisher.wanted
    one.close()
    assert publisher.wanted
    two.close()
    assert not publisher.wanted


def test_a_topic_has_one_type():
    graph = Graph()
    publisher = graph.advertise("/a", TWIST)
    with raises(TOPIC_TYPE_MISMATCH, type=TWIST, given=TEXT):
        graph.advertise("/a", TEXT)
    with raises(TOPIC_TYPE_MISMATCH):
        graph.subscribe("/a", print, type_name=TEXT)
    with raises(TOPIC_TYPE_MISMATCH):
        graph.publish("/a", TEXT, None)
    # One that nobody has any more is free for another type.
    publisher.close()
    assert graph.advertise("/a", TEXT).type == TEXT


def test_a_reader_may_come_first_if_it_says_the_type():
    graph, got = Graph(), []
    with raises(TOPIC_UNKNOWN, name="/b"):
        graph.subscribe("/b", got.append)
    graph.subscribe("/b", got.append, type_name=TWIST)
    graph.advertise("/b", TWIST).publish("x")
    assert got == ["x"]


def test_an_unknown_topic_names_the_likely_one():
    graph = Graph()
    graph.advertise("/imu/data", TWIST)
    with pytest.raises(UnknownNameError) as caught:
        graph.subscribe("/imu/dta", print)
    assert caught.value.values["meant"] == "/imu/data"


def test_a_latched_topic_keeps_its_last_message_for_who_comes_late():
    graph, got = Graph(), []
    publisher = graph.advertise("/map", TEXT, qos="latched")
    assert publisher.wanted
    publisher.publish("old")
    publisher.publish("new")
    graph.subscribe("/map", got.append)
    assert got == ["new"]
    publisher.publish("newer")
    assert got == ["new", "newer"]
    # Another kind of topic keeps nothing.
    other, late = graph.advertise("/odom", TEXT), []
    other.publish("gone")
    graph.subscribe("/odom", late.append)
    assert late == []


def test_a_latched_message_is_handed_over_on_the_owners_thread():
    posted = []
    graph, got = Graph(post=posted.append), []
    graph.advertise("/map", TEXT, qos="latched").publish("kept")
    graph.subscribe("/map", got.append)
    assert got == []
    for function in posted:
        function()
    assert got == ["kept"]


def test_publishing_from_outside_goes_through_the_owner():
    posted = []
    graph, got = Graph(post=posted.append), []
    graph.subscribe("/a", got.append, type_name=TWIST)
    graph.publish("/a", TWIST, "x")
    assert got == []
    posted.pop()()
    assert got == ["x"]


def test_listing():
    graph = Graph()
    graph.advertise("/b", TWIST, node="robot/drive", rate=100.0)
    graph.advertise("/a", TEXT, qos="latched")
    graph.subscribe("/b", print, node="viewer")
    one, two = graph.topics()
    assert (one.name, one.type, one.qos, one.rate) == ("/a", TEXT, "latched", None)
    assert (two.name, two.rate, two.qos) == ("/b", 100.0, "default")
    assert (two.publishers, two.subscribers) == (("robot/drive",), ("viewer",))
    assert graph.topic("/b") == two
    with pytest.raises(UnknownNameError):
        graph.topic("/c")


def test_what_readers_miss_is_listed():
    graph = Graph()
    graph.advertise("/text", TEXT)
    slow = graph.subscribe("/text", lambda _: None, node="slow")
    graph.subscribe("/text", lambda _: None, node="quick")
    assert graph.topic("/text").readers == ("slow", "quick")
    slow.dropped = lambda: 7
    assert graph.topic("/text").dropped == (7, 0)
    assert graph.topic("/text").readers == ("slow (7 dropped)", "quick")


def test_changes_are_counted():
    graph = Graph()
    counts = [graph.changed]
    publisher = graph.advertise("/a", TWIST)
    counts.append(graph.changed)
    subscription = graph.subscribe("/a", print)
    counts.append(graph.changed)
    subscription.close()
    counts.append(graph.changed)
    publisher.close()
    counts.append(graph.changed)
    publisher_only = sorted(set(counts))
    assert counts == publisher_only


def test_services():
    graph = Graph()
    service = graph.serve("/reset", "std_srvs/srv/Empty", lambda request: request * 2, node="sim")
    assert graph.service("/reset").handler(21) == 42
    with raises(SERVICE_TAKEN, node="sim"):
        graph.serve("/reset", "std_srvs/srv/Empty", print)
    assert [s.name for s in graph.services()] == ["/reset"]
    with raises(SERVICE_UNKNOWN):
        graph.service("/rest")
    graph.withdraw(service)
    assert graph.services() == []


def test_a_service_is_one_by_any_spelling_of_its_name():
    graph = Graph()
    graph.serve("reset", "std_srvs/srv/Empty", print)
    with raises(SERVICE_TAKEN):
        graph.serve("/reset", "std_srvs/srv/Empty", print)


def test_a_subscriber_may_leave_from_within_its_callback():
    graph, got = Graph(), []
    publisher = graph.advertise("/a", TWIST)

    def once(message):
        got.append(message)
        subscription.close()

    subscription = graph.subscribe("/a", once)
    graph.subscribe("/a", got.append)
    publisher.publish(1)
    publisher.publish(2)
    assert got == [1, 1, 2]


def test_a_full_mailbox_drops_its_oldest_and_counts():
    box = Mailbox(3)
    for number in range(8):
        box.put(number)
    assert box.dropped == 5
    assert box.drain() == [5, 6, 7]
    assert box.drain() == []
    box.put(8)
    assert (box.get(), box.dropped) == (8, 5)


def test_a_mailbox_waits_and_gives_up():
    box = Mailbox(3)
    start = time.perf_counter()
    assert box.get(timeout=0.05) is None
    assert time.perf_counter() - start >= 0.045
    thread = threading.Timer(0.05, box.put, ["x"])
    thread.start()
    assert box.get(timeout=120) == "x"
    thread.join()


def test_closing_a_mailbox_wakes_its_reader():
    graph = Graph()
    graph.advertise("/a", TWIST)
    box = graph.mailbox("/a")
    got = []
    reader = threading.Thread(target=lambda: got.append(box.get()))
    reader.start()
    box.close()
    reader.join(120)
    assert got == [None]
    assert box.closed
    assert graph.topic("/a").subscribers == ()


def test_no_message_is_lost_or_doubled_between_threads():
    box, count = Mailbox(100_000), 20_000
    got = []

    def read():
        while len(got) < count:
            message = box.get(timeout=120)
            assert message is not None
            got.append(message)

    reader = threading.Thread(target=read)
    reader.start()
    for number in range(count):
        box.put(number)
    reader.join(120)
    assert got == list(range(count))
    assert box.dropped == 0


def test_mirrors_of_the_graph_are_notified_of_each_change():
    graph = Graph()
    seen = []
    graph.on_change.append(lambda: seen.append(graph.changed))
    publisher = graph.advertise("/a", TWIST)
    subscription = graph.subscribe("/a", lambda _: None)
    service = graph.serve("/s", "std_srvs/srv/Empty", lambda request: request)
    subscription.close()
    publisher.close()
    graph.withdraw(service)
    assert seen == [1, 2, 3, 4, 5, 6]


def test_messages_of_a_topic_can_be_held_back():
    graph = Graph()
    received, kept = [], []
    graph.subscribe("/a", received.append, type_name=TEXT)
    deliver = hold_back(graph, "/a", kept.append)
    graph.publish("/a", TEXT, "first")
    assert kept == ["first"] and not received
    deliver("first")
    assert received == ["first"]
    let_pass(graph, "/a")
    graph.publish("/a", TEXT, "second")
    assert received == ["first", "second"] and kept == ["first"]


def test_messages_of_an_unknown_topic_cannot_be_held_back():
    with raises(TOPIC_UNKNOWN):
        hold_back(Graph(), "/a", print)


def values_of(graph, name, **options):
    """The subscription to a topic with a function for values, and what both functions receive."""
    got = []
    made = graph.subscribe(
        name, got.append, take_values=lambda *given: got.append(given), **options
    )
    return made, got


def test_values_become_a_message_only_if_a_subscriber_needs_it():
    graph = Graph()
    publisher = graph.advertise("/a", POINT)
    form = Form(zero(POINT), "x")
    publisher.publish_values(form, (1.0,))
    (first, got), (second, others) = values_of(graph, "/a"), values_of(graph, "/a")
    publisher.publish_values(form, (2.0,))
    assert got == others == [(form, (2.0,))]
    messages = []
    reader = graph.subscribe("/a", messages.append)
    publisher.publish_values(form, (3.0,))
    assert [message.x for message in (*got[1:], *others[1:], *messages)] == [3.0, 3.0, 3.0]
    assert got[1] is others[1]
    reader.close()
    second.close()
    publisher.publish_values(form, (4.0,))
    assert got[2] == (form, (4.0,))
    first.close()
    publisher.publish_values(form, (5.0,))
    assert (len(got), len(others), publisher.sent) == (3, 2, 5)


def test_a_latched_topic_keeps_the_message_of_values():
    graph = Graph()
    publisher = graph.advertise("/a", POINT, qos="latched")
    _, got = values_of(graph, "/a")
    publisher.publish_values(Form(zero(POINT), "x"), (2.0,))
    assert [message.x for message in got] == [2.0]
    assert graph.latched("/a") is got[0]


def test_an_error_about_values_is_that_of_its_subscription():
    graph, failed = Graph(), []
    publisher = graph.advertise("/a", POINT)

    def refuse(*_):
        raise RuntimeError("no")

    wrong = graph.subscribe("/a", print, take_values=refuse)
    _, got = values_of(graph, "/a")
    wrong.on_error = lambda subscription, error: failed.append((subscription, str(error)))
    publisher.publish_values(Form(zero(POINT), "x"), (1.0,))
    assert failed == [(wrong, "no")]
    assert len(got) == 1
