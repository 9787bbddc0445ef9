"""What a service over DDS answers, and to whom, as its endpoints are discovered."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from tests.bridges.ros2_peers import DOMAIN

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.dds import Dds, _Service
from cartwheel.bridges.ros2.middleware import Endpoint, Reply, Served
from cartwheel.bridges.ros2.qos import DEFAULT
from cartwheel.messages.ros2.types import ros2_service
from rtps_lite import discovery, wire
from rtps_lite.discovery import EndpointQos
from rtps_lite.reader import Taken

HERE = ("127.0.0.1", 9)
CLIENT = b"\x01\x0f" + bytes(10)
REQUEST, RESPONSE = bytes([0, 1, 0, 0]), bytes([0, 1, 0, 0, 1, 0, 0, 0])


class Patient(Loop):
    """A loop that runs nothing by itself."""

    def __init__(self) -> None:
        super().__init__(_raise, name="test")
        self.later: list[Callable[[], None]] = []

    def after(self, _: float, function: Callable[[], None]) -> None:
        self.later.append(function)

    def go_on(self) -> None:
        """Runs what waits now."""
        waiting, self.later = self.later, []
        for function in waiting:
            function()


def _raise(error: Exception) -> None:
    raise error


@pytest.fixture
def loop() -> Patient:
    return Patient()


@pytest.fixture
def service(loop: Patient, monkeypatch: pytest.MonkeyPatch) -> Iterator[_Service]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 6))
    dds = Dds(loop, "/node", lambda _: None)

    def answer(_: bytes, reply: Reply) -> None:
        reply(RESPONSE)

    type_ = ros2_service("std_srvs/srv/Trigger")
    made = dds.serve(Endpoint(name="/s", type=type_, profile=DEFAULT), [Served(type_, answer)])
    loop.later.clear()
    yield made
    dds.close()


def reader(number: int) -> discovery.Endpoint:
    return discovery.Endpoint(
        guid=CLIENT + bytes([0, 0, number, 4]),
        topic="rr/sReply",
        type="std_srvs::srv::dds_::Trigger_Response_",
        qos=EndpointQos(),
    )


def request(asker: discovery.Endpoint) -> Taken:
    """A request as rmw_fastrtps sends it: it names the reader of the response."""
    related = asker.guid + (1).to_bytes(8, "little")
    writer = CLIENT + bytes([0, 0, 9, 3])
    return Taken(REQUEST, {discovery.RELATED: related}, writer, 1, b"\1\x0f")


def sent_to(service: _Service, monkeypatch: pytest.MonkeyPatch) -> list[set[bytes]]:
    """The readers that are connected as each response is sent."""
    found: list[set[bytes]] = []
    monkeypatch.setattr(
        service._writer, "write", lambda *_, **__: found.append(set(service._writer.proxies))
    )
    return found


def test_a_response_waits_for_the_reader_that_the_request_names(
    service: _Service, loop: Patient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another client of the same program may have a reader already, or still."""
    sent = sent_to(service, monkeypatch)
    other, own = reader(1), reader(2)
    service._writer.match(other, HERE)
    service._take(request(own))
    loop.go_on()
    assert not sent
    service._writer.match(own, HERE)
    loop.go_on()
    assert sent == [{other.guid, own.guid}]
    assert not loop.later


def test_a_reader_that_never_comes_does_not_hold_a_response_for_ever(
    service: _Service, loop: Patient, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = sent_to(service, monkeypatch)
    service._writer.match(reader(1), HERE)
    service._take(request(reader(2)))
    for _ in range(1000):
        loop.go_on()
    assert len(sent) == 1


def test_a_request_without_a_reader_is_answered_to_its_program(
    service: _Service, loop: Patient, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = sent_to(service, monkeypatch)
    taken = Taken(REQUEST, {}, CLIENT + bytes([0, 0, 9, 3]), 1, wire.VENDOR)
    service._take(taken)
    assert not sent
    service._writer.match(reader(1), HERE)
    loop.go_on()
    assert len(sent) == 1
