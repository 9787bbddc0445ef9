"""What one client of Foxglove's server does to the others."""

from __future__ import annotations

import contextlib
import json
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from tests.bridges.test_foxglove import Served, serving
from tests.coded import coded
from websockets.exceptions import ConnectionClosed
from websockets.frames import Frame, Opcode
from websockets.sync.client import ClientConnection, connect

from cartwheel.codes.wires import CLIENT_REQUEST_IGNORED
from cartwheel.errors import Diagnostic

PATIENCE = 60.0


def connected(served: Served) -> ClientConnection:
    return connect(
        served.bridge.url,
        subprotocols=["foxglove.sdk.v1"],
        open_timeout=PATIENCE,
        # A client that has left messages unread does not see the other end.
        close_timeout=0.1,
        max_size=None,
    )


class Reader:
    """A client that takes all it is sent at once, and knows the channels."""

    def __init__(self, served: Served) -> None:
        self.link = connected(served)
        self.channels: dict[str, int] = {}
        self.statuses = 0
        self.messages = 0
        self.is_open = True
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        try:
            for data in self.link:
                if isinstance(data, bytes):
                    self.messages += 1
                else:
                    self._take(json.loads(data))
        except ConnectionClosed:
            pass
        self.is_open = False

    def _take(self, event: dict[str, object]) -> None:
        if event["op"] == "advertise":
            for channel in event["channels"]:  # type: ignore[attr-defined]
                self.channels[channel["topic"]] = channel["id"]
        elif event["op"] == "unadvertise":
            gone = event["channelIds"]
            for topic in [one for one, number in self.channels.items() if number in gone]:  # type: ignore[operator]
                del self.channels[topic]
        self.statuses += event["op"] == "status"

    def wait(self, condition: Callable[[], object], what: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert self.is_open, f"the server closed the connection before: {what}"
            assert time.monotonic() < deadline, f"in vain: {what}"
            time.sleep(0.01)

    def reads_on(self) -> None:
        """Messages of the simulation still come."""
        count = self.messages
        self.wait(lambda: self.messages > count + 20, "messages")


@pytest.fixture
def served() -> Iterator[Served]:
    with serving() as made:
        yield made


@pytest.fixture
def reader(served: Served) -> Iterator[Reader]:
    made = Reader(served)
    made.wait(lambda: "/clock" in made.channels, "the channel of /clock")
    subscription = {"id": 1, "channelId": made.channels["/clock"]}
    made.link.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))
    made.reads_on()
    yield made
    made.link.close()


def test_malformed_data_of_one_client_disconnects_no_other(served: Served, reader: Reader) -> None:
    values = [{"name": f"/9/{number}", "value": "x"} for number in range(1000)]
    with connected(served) as other:
        other.send(json.dumps({"op": "setParameters", "parameters": values}))
        reader.wait(lambda: len(served.reports) >= 400, "the warnings")
        reader.reads_on()
    assert 0 < reader.statuses < 100


def test_many_topics_that_come_and_go_disconnect_nobody(served: Served, reader: Reader) -> None:
    names = [f"/many/t{number}" for number in range(600)]
    call = served.simulation.call
    publishers = call(
        lambda: [served.graph.advertise(name, "std_msgs/msg/String") for name in names]
    ).result(PATIENCE)
    reader.wait(lambda: set(names) <= set(reader.channels), "the channels")
    call(lambda: [publisher.close() for publisher in publishers]).result(PATIENCE)
    reader.wait(lambda: not set(names) & set(reader.channels), "their end")
    reader.reads_on()


def test_parameters_of_many_names_are_read_one_by_one(served: Served, reader: Reader) -> None:
    values = [{"name": f"/many/p{number}", "value": number} for number in range(3)]
    asked = []
    get = served.graph.parameters.get
    served.graph.parameters.get = lambda *given: asked.append(given[0]) or get(*given)  # type: ignore[method-assign, func-returns-value]
    answer: list[dict[str, object]] = []
    with connected(served) as other:
        other.send(json.dumps({"op": "setParameters", "parameters": values, "id": "a"}))
        for data in other:
            if isinstance(data, str) and json.loads(data)["op"] == "parameterValues":
                answer = json.loads(data)["parameters"]
                break
    assert {one["name"]: one["value"] for one in answer} == {
        "/many/p0": 0, "/many/p1": 1, "/many/p2": 2,
    }  # fmt: skip
    assert "/" not in asked
    reader.reads_on()


def send_channels(link: ClientConnection, first: int, count: int, schema: str = "") -> None:
    channels = [
        {"id": number, "topic": f"/t{number}", "encoding": "json",
         "schemaName": "std_msgs/msg/String", "schema": schema}
        for number in range(first, first + count)
    ]  # fmt: skip
    link.send(json.dumps({"op": "advertise", "channels": channels}))


def known_channels(served: Served) -> int:
    return len(served.bridge._incoming._channels)


def answered(link: ClientConnection) -> None:
    """All that a client sent before is done."""
    link.send(json.dumps({"op": "getParameters", "parameterNames": ["/x"], "id": "answered"}))
    for data in link:
        if isinstance(data, str) and json.loads(data).get("id") == "answered":
            return


def warnings(served: Served, limit: str) -> list[Diagnostic]:
    """Those of requests that exceed a limit."""
    return [one for one in served.reports if one.values.get("limit") == limit]


def test_a_client_advertises_a_bounded_number_of_channels(served: Served, reader: Reader) -> None:
    with connected(served) as other:
        for first in range(0, 5000, 100):
            send_channels(other, first, 100)
        answered(other)
        assert known_channels(served) == 1000
        # Those that it gives up make room for others.
        other.send(json.dumps({"op": "unadvertise", "channelIds": list(range(500))}))
        send_channels(other, 10_000, 100)
        answered(other)
        assert known_channels(served) == 600
        assert reader.statuses >= 1
    assert len(warnings(served, "channels of a client")) == 1
    reader.wait(lambda: not known_channels(served), "the end of its channels")
    with connected(served) as other:
        send_channels(other, 0, 1000)
        answered(other)
        assert known_channels(served) == 1000
    reader.reads_on()


def test_channels_of_all_clients_are_bounded_by_number_and_text(
    served: Served, reader: Reader
) -> None:
    links = [connected(served) for _ in range(12)]
    for link in links:
        send_channels(link, 0, 1000)
        answered(link)
    assert known_channels(served) == 10_000
    assert len(warnings(served, "channels of all clients")) == 1
    for link in links:
        link.close()
    reader.wait(lambda: not known_channels(served), "the end of their channels")
    with connected(served) as other:
        for number in range(20):
            send_channels(other, number, 1, "x" * 100_000)
        answered(other)
        assert known_channels(served) == 10
        assert len(warnings(served, "channels of a client")) == 1


def test_a_text_that_is_not_json_or_too_large_reaches_no_server(
    served: Served, reader: Reader
) -> None:
    with connected(served) as other:
        for text in ("garbage", '{"op": "advertise", "n": ' + "9" * 5000 + "}", "[" * 100_000):
            other.send(text)
        answered(other)
        assert coded(served.reports, CLIENT_REQUEST_IGNORED)
        # In fragments, and with one of another kind between them.
        parts = json.dumps({"op": "advertise", "channels": [
            {"id": 7, "topic": "/t", "encoding": "json", "schemaName": "std_msgs/msg/String"},
        ]})  # fmt: skip
        other.send(iter([parts[:10], "", parts[10:50], parts[50:]]))
        other.ping()
        answered(other)
        assert known_channels(served) == 1
        with pytest.raises(ConnectionClosed):
            other.send("x" * (1 << 21))
            for _ in other:
                pass
    with connected(served) as other, pytest.raises(ConnectionClosed):
        other.send(b"\x01" * (17 << 20))
        for _ in other:
            pass
        other.ping().wait(PATIENCE)
    reader.reads_on()


def test_idle_incomplete_messages_keep_nobody_from_sending(served: Served, reader: Reader) -> None:
    size = (16 << 20) - 100
    frame = Frame(Opcode.BINARY, b"\xff" * size).serialize(mask=True)
    with contextlib.ExitStack() as stack:
        idle = [stack.enter_context(connected(served)) for _ in range(4)]
        for one in idle:
            answered(one)
            one.socket.sendall(frame[:-1])
        other = stack.enter_context(connected(served))
        for _ in range(3):
            other.send(b"\xff" * (10 << 20))
            answered(other)
        reader.wait(lambda: coded(served.reports, CLIENT_REQUEST_IGNORED), "the warning")
        (report,) = coded(served.reports, CLIENT_REQUEST_IGNORED)
        assert "oldest" in report.values["fault"]
        with pytest.raises(ConnectionClosed):
            for _ in idle[0]:
                pass
    reader.reads_on()


def test_clients_set_a_bounded_number_of_parameters(served: Served, reader: Reader) -> None:
    with connected(served) as other:
        for first in range(0, 3000, 500):
            values = [{"name": f"/n/p{first + n}", "value": n} for n in range(500)]
            other.send(json.dumps({"op": "setParameters", "parameters": values}))
        large = [{"name": "/large", "value": "x" * 70_000}, {"name": "/" + "n" * 300, "value": 1}]
        other.send(json.dumps({"op": "setParameters", "parameters": large}))
        # One that is known may change.
        change = [{"name": "/n/p0", "value": 7}]
        other.send(json.dumps({"op": "setParameters", "parameters": change}))
        answered(other)
    found = served.graph.parameters.get("/")
    assert len(found["n"]) == 1000
    assert found["n"]["p0"] == 7
    assert not {"large", "n" * 300} & set(found)
    assert len(warnings(served, "count")) == 1
    assert len(warnings(served, "size")) == 1
    reader.reads_on()


def test_clients_watch_a_bounded_number_of_parameters(served: Served, reader: Reader) -> None:
    with connected(served) as other:
        for first in range(0, 3000, 500):
            names = [f"/w/p{first + number}" for number in range(500)]
            other.send(json.dumps({"op": "subscribeParameterUpdates", "parameterNames": names}))
        answered(other)
    assert len(warnings(served, "watched parameters of a client")) == 1
    reader.reads_on()
