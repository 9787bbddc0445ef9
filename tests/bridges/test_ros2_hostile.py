"""Whatever comes to the sockets: nothing crashes, nothing grows, everybody else is served."""

from __future__ import annotations

import contextlib
import random
import resource
import socket
import struct
import time
from collections.abc import Iterator

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer, Ros2Bridged

from cartwheel.bridges.ros2 import Ros2Bridge
from cartwheel.bridges.ros2.dds import Dds
from cartwheel.bridges.ros2.rtps import discovery, wire
from cartwheel.bridges.ros2.rtps.discovery import ParticipantData, encode_participant
from cartwheel.bridges.ros2.rtps.network import Network, Reach, domain_id
from cartwheel.cli.arguments import rmw
from cartwheel.errors import CartwheelError
from cartwheel.graph import Graph


@pytest.fixture(scope="module")
def bridged() -> Iterator[Ros2Bridged]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 3))
        made = Ros2Bridged()
        yield made
        made.close()


def dds_of(bridged: Ros2Bridged) -> Dds:
    middleware = bridged.bridge.middleware
    assert isinstance(middleware, Dds)
    return middleware


@pytest.fixture
def sender(bridged: Ros2Bridged) -> Iterator[socket.socket]:
    """A socket to the participant's."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.connect(dds_of(bridged).participant._network.locators[0])
        yield made


def memory() -> int:
    """Bytes that are resident, at most so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def settle(bridged: Ros2Bridged) -> None:
    """Waits until the bridge has taken what was sent, and still answers."""
    for _ in range(3):
        bridged.bridge._loop.call(lambda: None).result(120)


def announcement(prefix: bytes, port: int) -> bytes:
    """What a participant says of itself."""
    address = (("127.0.0.1", port),)
    data = ParticipantData(prefix=prefix, meta=address, user=address)
    payload = encode_participant(data, domain=DOMAIN + 3)
    head = wire.data_head(
        reader=wire.UNKNOWN,
        writer=discovery.SPDP_WRITER,
        number=1,
        inline=b"",
        size=len(payload),
    )
    return wire.message(prefix, head, payload)


def test_noise_is_counted_and_passed_over(bridged: Ros2Bridged, sender: socket.socket) -> None:
    dice = random.Random(4)
    participant = dds_of(bridged).participant
    prefix = b"\x01\x02" + bytes(10)
    whole = announcement(prefix, 9)
    before = participant.malformed
    for _ in range(4000):
        kind = dice.randrange(3)
        data = dice.randbytes(dice.randrange(200))
        if kind == 1:
            data = b"RTPS\x02\x03\x01\x02" + data
        elif kind == 2:
            changed = bytearray(whole)
            for _ in range(dice.randrange(1, 6)):
                changed[dice.randrange(20, len(changed))] = dice.randrange(256)
            data = bytes(changed[: dice.randrange(20, len(changed))])
        sender.send(data)
    settle(bridged)
    assert participant.malformed > before
    assert not [each for each in bridged.reports if "fault" in each.message]


def test_who_may_not_have_listened_yet_is_told_again_until_it_answers(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    """Fast DDS announces itself some time before it takes what is sent to it."""
    answers = {}
    for number in (1, 2):
        prefix = b"\x01\x05" + bytes(9) + bytes([number])
        sender.send(announcement(prefix, sender.getsockname()[1]))
        if number == 2:
            has_none = wire.acknack(
                reader=discovery.PUBLICATIONS_READER,
                writer=discovery.PUBLICATIONS_WRITER,
                base=1,
                missing=(),
                count=1,
                final=True,
            )
            sender.send(wire.message(prefix, has_none))
        answers[number] = greetings(sender, 0.5)
        bridged.bridge._loop.call(
            lambda prefix=prefix: dds_of(bridged).participant._lose(prefix)
        ).result(120)
    # A periodic one may be among them.
    assert answers[1] >= 4
    assert answers[2] <= 2


def greetings(sock: socket.socket, seconds: float) -> int:
    """How often a participant says that it is there."""
    end = time.monotonic() + seconds
    found = 0
    while (left := end - time.monotonic()) > 0:
        sock.settimeout(left)
        with contextlib.suppress(TimeoutError):
            for each in wire.read(memoryview(sock.recv(65536))):
                data = each.content
                found += isinstance(data, wire.Data) and data.writer == discovery.SPDP_WRITER
    return found


def test_participants_without_number_are_bounded(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    participant = dds_of(bridged).participant
    for number in range(2000):
        sender.send(announcement(b"\x01\x03" + struct.pack("<IIH", number, 7, 7), 9))
        if number % 50 == 0:
            settle(bridged)
    settle(bridged)
    assert 100 < len(participant._remotes) <= 256
    assert [each for each in bridged.reports if "other participants" in each.message]
    # Those that were made up do not leave by themselves.
    for prefix in list(participant._remotes):
        bridged.bridge._loop.call(lambda prefix=prefix: participant._lose(prefix)).result(120)


def test_fragments_of_giants_take_no_memory(bridged: Ros2Bridged, sender: socket.socket) -> None:
    participant = dds_of(bridged).participant
    prefix = b"\x01\x04" + bytes(10)
    sender.send(announcement(prefix, 9))
    settle(bridged)
    before = memory()
    for number in range(1, 400):
        head = wire.fragment_head(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            number=number,
            inline=b"",
            fragment=1,
            length=4,
            size=(1 << 31) if number % 2 else 20 << 20,
        )
        sender.send(wire.message(prefix, head, b"abcd"))
    settle(bridged)
    # Eight samples of 20 MiB may be under way from one writer.
    assert memory() - before < 300 << 20
    bridged.bridge._loop.call(lambda: participant._lose(prefix)).result(120)


def test_a_heartbeat_of_astronomical_numbers_costs_nothing(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    participant = dds_of(bridged).participant
    prefix = b"\x01\x05" + bytes(10)
    sender.send(announcement(prefix, 9))
    settle(bridged)
    for count in range(200):
        told = wire.heartbeat(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            first=1,
            last=(1 << 62) - count,
            count=count,
            final=False,
        )
        sender.send(wire.message(prefix, told))
        gap = wire.gap(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            start=5,
            end=1 << 61,
        )
        sender.send(wire.message(prefix, gap))
    settle(bridged)
    bridged.bridge._loop.call(lambda: participant._lose(prefix)).result(120)


@pytest.mark.skipif(bool(REASON), reason=REASON)
def test_others_are_served_meanwhile(bridged: Ros2Bridged, sender: socket.socket) -> None:
    peer = Peer(DOMAIN + 3)
    try:
        peer.subscribe("/odom", "nav_msgs/msg/Odometry")
        wait_for(lambda: peer.received("/odom"), "odometry")
        before = len(peer.received("/odom"))
        for _ in range(3000):
            sender.send(b"RTPS\x02\x03\x01\x02" + bytes(100))
        wait_for(lambda: len(peer.received("/odom")) > before + 50, "odometry beside the noise")
    finally:
        peer.close()


def test_variables_that_make_no_sense_are_told_of() -> None:
    assert domain_id({"ROS_DOMAIN_ID": "17"}) == 17
    for wrong in ("-1", "x", "233", "²"):
        with pytest.raises(CartwheelError, match="ROS_DOMAIN_ID"):
            domain_id({"ROS_DOMAIN_ID": wrong})
    with pytest.raises(CartwheelError, match="DISCOVERY_RANGE"):
        Reach.of({"ROS_AUTOMATIC_DISCOVERY_RANGE": "GALAXY"})
    with pytest.raises(CartwheelError, match="LOCALHOST_ONLY"):
        Reach.of({"ROS_LOCALHOST_ONLY": "yes"})
    with pytest.raises(CartwheelError, match="no name for a ROS 2 node"):
        Ros2Bridge(Graph(), node="my node")
    with pytest.raises(CartwheelError, match="middleware"):
        rmw("carrier_pigeon")


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({}, "LOCALHOST"),
        ({"ROS_LOCALHOST_ONLY": "1"}, "LOCALHOST"),
        ({"ROS_LOCALHOST_ONLY": "0"}, "SUBNET"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, "SUBNET"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"}, "SUBNET"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "OFF"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", "ROS_LOCALHOST_ONLY": "1"}, "LOCALHOST"),
    ],
)
def test_discovery_reaches_as_far_as_ros_says(variables: dict[str, str], expected: str) -> None:
    assert Reach.of(variables).range == expected


def test_on_this_computer_only_nobody_else_can_connect(bridged: Ros2Bridged) -> None:
    network = dds_of(bridged).participant._network
    assert network.unicast.getsockname()[0] == "127.0.0.1"
    assert {host for host, _ in network.locators} == {"127.0.0.1"}
    assert not network.hears("192.0.2.77")


def test_who_is_named_is_heard_and_nobody_where_that_is_off() -> None:
    peers = Reach.of({"ROS_STATIC_PEERS": "localhost; 192.0.2.7 ;;"})
    assert peers.peers == ("localhost", "192.0.2.7")
    network = Network(DOMAIN + 6, peers)
    try:
        assert network.hears("127.0.0.1")
        assert network.hears("192.0.2.7")
        assert not network.hears("192.0.2.8")
        assert ("192.0.2.7", 7400 + 250 * (DOMAIN + 6) + 10) in network.announce
    finally:
        network.close()
    off = Network(DOMAIN + 6, Reach.of({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}))
    try:
        assert not off.announce
        assert not off.hears("127.0.0.1")
    finally:
        off.close()
    with pytest.raises(CartwheelError, match="ROS_STATIC_PEERS"):
        Network(DOMAIN + 6, Reach.of({"ROS_STATIC_PEERS": "no.such.host.invalid"}))


def test_a_peer_is_heard_by_what_its_name_means(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket, "gethostbyname", {"lab-robot": "192.0.2.9"}.__getitem__)
    network = Network(DOMAIN + 6, Reach(peers=("lab-robot",)))
    try:
        assert network.hears("192.0.2.9")
    finally:
        network.close()


def test_zenoh_that_is_missing_is_told_with_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "zenoh", None)
    with pytest.raises(CartwheelError) as caught:
        Ros2Bridge(Graph(), rmw="zenoh")
    assert "pip install 'cartwheel[ros2]'" in str(caught.value)
