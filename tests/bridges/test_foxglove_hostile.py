"""What one client of Foxglove's server does to the others."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from tests.bridges.test_foxglove import Served, serving
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

PATIENCE = 60.0


def connected(served: Served) -> ClientConnection:
    return connect(
        served.bridge.url, subprotocols=["foxglove.sdk.v1"], open_timeout=PATIENCE, max_size=None
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


def test_nonsense_of_one_client_disconnects_no_other(served: Served, reader: Reader) -> None:
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
