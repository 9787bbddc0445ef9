"""Whatever comes to the sockets: nothing crashes, nothing grows, everybody else is served."""

from __future__ import annotations

import contextlib
import random
import resource
import socket
import struct
import threading
import time
from collections.abc import Iterator

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer, Ros2Bridged
from tests.coded import coded, raises

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2 import Ros2Bridge
from cartwheel.bridges.ros2.dds import Dds
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.cli.arguments import rmw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    PACKAGE_MISSING,
    PEER_LIMIT,
    ROS_NODE_NAME_INVALID,
    ROS_VARIABLE_INVALID,
)
from cartwheel.graph import Graph
from cartwheel.messages.ros2.types import ros2_type
from rtps_lite import discovery, wire
from rtps_lite import remotes as remotes_module
from rtps_lite.discovery import ParticipantData, encode_participant
from rtps_lite.interface import UnknownHostError
from rtps_lite.network import Network, Reach
from rtps_lite.outbox import Outbox
from rtps_lite.participant import Participant
from rtps_lite.reader import Reader, Taken
from rtps_lite.room import Room
from rtps_lite.writer import Writer

QOS = discovery.EndpointQos()
PATIENCE = 60.0


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
    assert not coded(bridged.reports, BRIDGE_FAULT)


def test_a_peer_that_may_not_have_listened_is_notified_until_it_answers(
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
            ours = dds_of(bridged).participant.prefix
            sender.send(wire.message(prefix, has_none, to=ours))
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


def lose_all(bridged: Ros2Bridged) -> None:
    """Those that were made up do not leave by themselves, not at once."""
    participant = dds_of(bridged).participant

    def lose() -> None:
        for prefix in list(participant._remotes.by_prefix):
            participant._lose(prefix)

    bridged.bridge._loop.call(lose).result(120)


def test_participants_without_number_are_bounded(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    participant = dds_of(bridged).participant
    for number in range(2000):
        sender.send(announcement(b"\x01\x03" + struct.pack("<IIH", number, 7, 7), 9))
        if number % 50 == 0:
            settle(bridged)
    settle(bridged)
    # As many as there are ports for on this computer.
    assert len(participant._remotes.by_prefix) == 120
    wait_for(
        lambda: coded(bridged.reports, PEER_LIMIT),
        "the warning",
    )
    lose_all(bridged)


@pytest.mark.skipif(bool(REASON), reason=REASON)
def test_a_real_one_gets_in_beside_any_number_that_are_made_up(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    """Hundreds a second, for as long as it takes; they never answer, and it does."""
    stop = threading.Event()

    def flood() -> None:
        number = 0
        while not stop.wait(0.02):
            for _ in range(10):
                number += 1
                sender.send(announcement(b"\x01\x06" + struct.pack("<IIH", number, 7, 7), 9))

    thread = threading.Thread(target=flood)
    thread.start()
    peer = None
    try:
        wait_for(lambda: len(dds_of(bridged).participant._remotes.by_prefix) == 120, "the flood")
        peer = Peer(DOMAIN + 3)
        peer.subscribe("/odom", "nav_msgs/msg/Odometry")
        wait_for(lambda: len(peer.received("/odom")) > 100, "odometry")
    finally:
        stop.set()
        thread.join()
        if peer is not None:
            peer.close()
        lose_all(bridged)


def test_who_never_answers_gets_no_samples_and_is_forgotten(
    bridged: Ros2Bridged, sender: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may be made up, and its address another's: what it is sent is no more than it sends."""
    participant = dds_of(bridged).participant
    prefix = b"\x01\x07" + bytes(10)
    endpoint = discovery.Endpoint(
        guid=prefix + b"\0\0\1\4",
        topic="rt/odom",
        type="nav_msgs::msg::dds_::Odometry_",
        qos=discovery.EndpointQos(reliable=False),
    )
    payload = discovery.encode_endpoint(endpoint)
    payload += b"\0" * (-len(payload) % 4)
    head = wire.data_head(
        reader=discovery.SUBSCRIPTIONS_READER,
        writer=discovery.SUBSCRIPTIONS_WRITER,
        number=1,
        inline=b"",
        size=len(payload),
    )
    sender.send(announcement(prefix, sender.getsockname()[1]))
    sender.send(wire.message(prefix, head, payload))
    settle(bridged)
    remote = participant._remotes.by_prefix[prefix]
    assert remote.readers.keys() == {endpoint.guid}
    kinds = [type(each) for each in contents(sender, 1.5)]
    assert kinds.count(wire.Data) <= 8, "announcements alone"
    assert not bridged.wanted("/odom")
    monkeypatch.setattr(remotes_module, "_UNANSWERED", 0.0)
    wait_for(lambda: prefix not in participant._remotes.by_prefix, "it to be forgotten")


def contents(sock: socket.socket, seconds: float) -> list[object]:
    """What comes within some time."""
    end = time.monotonic() + seconds
    found: list[object] = []
    while (left := end - time.monotonic()) > 0:
        sock.settimeout(left)
        with contextlib.suppress(TimeoutError):
            found += [each.content for each in wire.read(memoryview(sock.recv(65536)))]
    return found


def test_nobody_has_us_send_to_somebody_else(bridged: Ros2Bridged, sender: socket.socket) -> None:
    participant = dds_of(bridged).participant
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as elsewhere:
        prefix = b"\x01\x08" + bytes(10)
        address = (("192.0.2.1", 4711),)
        data = ParticipantData(prefix=prefix, meta=address, user=address)
        reported = encode_participant(data, domain=DOMAIN + 3)
        head = wire.data_head(
            reader=wire.UNKNOWN,
            writer=discovery.SPDP_WRITER,
            number=1,
            inline=b"",
            size=len(reported),
        )
        sender.send(wire.message(prefix, head, reported))
        settle(bridged)
        assert participant._remotes.by_prefix[prefix].address == ("127.0.0.1", 4711)
        # Nor does anybody say farewell for another.
        key = discovery.encode_key(prefix + discovery.PARTICIPANT, participant=True)
        inline = discovery.disposed(prefix + discovery.PARTICIPANT)
        head = wire.data_head(
            reader=discovery.SPDP_READER,
            writer=discovery.SPDP_WRITER,
            number=2,
            inline=inline,
            size=len(key),
            keyed=True,
        )
        elsewhere.connect(participant._network.locators[0])
        elsewhere.send(wire.message(b"\x01\x09" + bytes(10), head, key))
        settle(bridged)
        assert prefix in participant._remotes.by_prefix
    lose_all(bridged)


def fragment(*, number: int, size: int, fragment_size: int, payload: bytes) -> bytes:
    """The first fragment of a sample, of any size that somebody may claim."""
    head = bytearray(
        wire.fragment_head(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            number=number,
            inline=b"",
            fragment=1,
            length=len(payload),
            size=size,
        )
    )
    struct.pack_into("<H", head, 30, fragment_size)
    return bytes(head) + payload


@pytest.mark.parametrize("fragment_size", [1, 512, wire.LARGEST])
def test_fragments_of_giants_take_no_more_than_their_own_bytes(
    bridged: Ros2Bridged, sender: socket.socket, fragment_size: int
) -> None:
    """With a fragment size of 1, one datagram of 60 bytes once took some gigabytes."""
    prefix = b"\x01\x04" + bytes(10)
    sender.send(announcement(prefix, 9))
    settle(bridged)
    before = memory()
    for number in range(1, 400):
        size = (1 << 31) if number % 2 else 64 << 20
        data = fragment(number=number, size=size, fragment_size=fragment_size, payload=b"abcd")
        sender.send(wire.message(prefix, data))
        full = bytes(min(fragment_size, 1024))
        data = fragment(number=number, size=size, fragment_size=fragment_size, payload=full)
        sender.send(wire.message(prefix, data))
    settle(bridged)
    assert memory() - before < 20 << 20
    lose_all(bridged)


def test_what_is_held_for_others_is_bounded_whoever_they_are() -> None:
    """Of one, of all, and given back when a writer leaves or its samples do not come."""
    room = Room()
    readers = [
        Reader(
            discovery.Endpoint(guid=b"r" * 12 + b"\0\0\0\4", topic="rt/x", type="X", qos=QOS),
            lambda *_: True,
            lambda _: None,
            room=room,
        )
        for _ in range(2)
    ]
    here = ("127.0.0.1", 9)
    payload = bytes(wire.LARGEST)
    most = []
    for person in range(6):
        for each in range(4):
            guid = bytes([person]) * 12 + bytes([0, 0, each, 3])
            writer = discovery.Endpoint(guid=guid, topic="rt/x", type="X", qos=QOS)
            for reader in readers:
                reader.match(writer, here)
                for number in range(2, 260):
                    reader.take_data(
                        guid, b"", wire.Data(b"", guid[12:], number, {}, payload, keyed=False)
                    )
                for first in range(1, 200):
                    part = wire.Data(
                        b"", guid[12:], 1, {}, payload, False, first, wire.LARGEST, 128 << 20
                    )
                    reader.take_data(guid, b"", part)
        most.append(room.held)
    assert most[0] <= 160 << 20
    assert most[-1] <= 320 << 20
    for reader in readers:
        reader.give_up(time.monotonic() + 100.0)
        for guid in list(reader.proxies):
            reader.unmatch(guid)
    assert room.held == 0


def test_a_large_cloud_comes_in_whatever_size_its_fragments_have() -> None:
    """1920 x 1080 points of 32 bytes, as Cyclone DDS and others cut them."""
    for fragment_size in (1344, 8192, wire.LARGEST):
        whole = random.Random(1).randbytes(1920 * 1080 * 32 + 3)
        taken: list[Taken] = []
        ours = discovery.Endpoint(guid=b"r" * 12 + b"\0\0\0\4", topic="", type="", qos=QOS)
        guid = b"w" * 12 + b"\0\0\0\3"
        theirs = discovery.Endpoint(guid=guid, topic="", type="", qos=QOS)
        reader = Reader(ours, lambda *_: True, taken.append)
        reader.match(theirs, ("127.0.0.1", 9))
        for number, at in enumerate(range(0, len(whole), fragment_size)):
            part = whole[at : at + fragment_size]
            part += bytes(-len(part) % 4)
            reader.take_data(
                guid,
                b"",
                wire.Data(
                    b"", guid[12:], 1, {}, part, False, number + 1, fragment_size, len(whole)
                ),
            )
        assert [each.payload for each in taken] == [whole]


def test_who_asks_for_all_again_and_again_gets_it_at_a_bounded_pace() -> None:
    """Sixty bytes that ask for 60 MB: what is sent is set by time, not by how often it is asked."""
    sent: list[int] = []
    waits: list[float] = []
    outbox = Outbox(lambda parts, _: not sent.append(sum(map(len, parts))), waits.append)  # type: ignore[func-returns-value]
    guid = b"w" * 12 + b"\0\0\0\3"
    writer = Writer(
        discovery.Endpoint(guid=guid, topic="", type="", qos=QOS),
        lambda parts, _: not sent.append(sum(map(len, parts))),  # type: ignore[func-returns-value]
        outbox=outbox,
    )
    reader = b"r" * 12 + b"\0\0\0\4"
    writer.match(discovery.Endpoint(guid=reader, topic="", type="", qos=QOS), ("127.0.0.1", 9))
    writer.write(bytes(32 << 20))
    while outbox._jobs:
        outbox.tick()
    sent.clear()
    begin = time.monotonic()
    for count in range(2000):
        missing = tuple(range(1, 257))
        reported = wire.NackFrag(reader[12:], guid[12:], 1, missing)
        writer.take_nack_frag(reader, reported)
        writer.take_acknack(reader, wire.Acknack(reader[12:], guid[12:], 1, (1,), count, False))
        outbox.tick()
    passed = time.monotonic() - begin
    # Two datagrams a millisecond, and a heartbeat a millisecond.
    assert sum(sent) <= (passed / 0.001 + 1) * (2 * 60100 + 100)
    assert len(writer.proxies[reader].wanted) <= 1
    assert waits
    # Nothing sleeps: the loop does other things meanwhile.
    assert passed < 30


class Rude:
    """A participant with reliable readers that answers discovery and nothing else."""

    def __init__(self, domain: int) -> None:
        self.faults: list[Exception] = []
        self._loop = Loop(self.faults.append, name="rude")
        self._participant = Participant(
            self._loop,
            domain=domain,
            reach=discovery_range(),
            name="rude",
            user_data=b"",
            warn=lambda _: None,
        )
        self._count = 0
        self._loop.start()
        self.readers: list[Reader] = self._loop.call(self._begin).result(PATIENCE)

    def _begin(self) -> list[Reader]:
        self._participant.start()
        qos = discovery.EndpointQos(reliable=True)
        readers = [
            self._participant.reader(f"rt{topic}", ros2_type(kind).dds, qos, lambda _: None)
            for topic, kind in (
                ("/odom", "nav_msgs/msg/Odometry"),
                ("/joint_states", "sensor_msgs/msg/JointState"),
                ("/clock", "rosgraph_msgs/msg/Clock"),
            )
            for _ in range(10)
        ]
        for each in readers:
            each._send = lambda *_: True
        return readers

    @property
    def writers(self) -> int:
        """Those that it is connected with."""
        return self._loop.call(lambda: sum(len(one.proxies) for one in self.readers)).result(
            PATIENCE
        )

    def ask_for_all(self) -> None:
        """Says of each writer that nothing of it has come, with a request for all of it."""
        self._loop.call(self._ask).result(PATIENCE)

    def _ask(self) -> None:
        self._count += 1
        for reader in self.readers:
            for guid, proxy in reader.proxies.items():
                first = max(1, proxy.next - 255)
                reported = wire.acknack(
                    reader=reader.endpoint.guid[12:],
                    writer=guid[12:],
                    base=first,
                    missing=range(first, proxy.next + 1),
                    count=self._count,
                    final=False,
                )
                message = wire.message(self._participant.prefix, reported, to=guid[:12])
                self._participant._send((message,), proxy.address)

    def vanish(self) -> None:
        """Leaves without a word."""

        def end() -> None:
            self._participant._closed = True
            network = self._participant._network
            for sock in (network.unicast, network.multicast):
                if sock is not None:
                    self._loop.forget(sock)
            network.close()

        self._loop.call(end).result(PATIENCE)
        self._loop.stop()


@pytest.mark.skipif(bool(REASON), reason=REASON)
@pytest.mark.parametrize("way", ["never acknowledges", "asks for all again", "vanishes"])
def test_readers_that_do_not_acknowledge_hold_up_nobody(way: str) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 6))
        bridged = Ros2Bridged()
        peer = Peer(DOMAIN + 6)
        rude = [Rude(DOMAIN + 6)]
    try:
        peer.subscribe("/odom", "nav_msgs/msg/Odometry")
        wait_for(lambda: peer.received("/odom"), "odometry")
        wait_for(lambda: rude[0].writers == len(rude[0].readers), "the connection")
        before, begin = memory(), bridged.simulation.time_ns
        for _ in range(10):
            count = len(peer.received("/odom"))
            if way == "vanishes":
                rude[-1].vanish()
                rude.append(Rude(DOMAIN + 6))
            attack = rude[-1].ask_for_all if way == "asks for all again" else lambda: None
            wait_for(lambda: attack() or len(peer.received("/odom")) >= count + 30, "odometry")  # noqa: B023
        assert bridged.simulation.time_ns > begin + 2_000_000_000
        assert memory() - before < 40 << 20
        assert not coded(bridged.reports, BRIDGE_FAULT)
        assert [each.faults for each in rude] == [[]] * len(rude)
    finally:
        rude[-1].vanish()
        peer.close()
        bridged.close()


def test_a_heartbeat_of_astronomical_numbers_costs_nothing(
    bridged: Ros2Bridged, sender: socket.socket
) -> None:
    participant = dds_of(bridged).participant
    prefix = b"\x01\x05" + bytes(10)
    sender.send(announcement(prefix, 9))
    settle(bridged)
    before = memory()
    for count in range(200):
        reported = wire.heartbeat(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            first=1,
            last=(1 << 62) - count,
            count=count,
            final=False,
        )
        sender.send(wire.message(prefix, reported))
        gap = wire.gap(
            reader=discovery.PUBLICATIONS_READER,
            writer=discovery.PUBLICATIONS_WRITER,
            numbers=[5, (1 << 61)],
        )
        sender.send(wire.message(prefix, gap))
    settle(bridged)
    assert memory() - before < 20 << 20
    bridged.bridge._loop.call(lambda: participant._lose(prefix)).result(120)
    assert not coded(bridged.reports, BRIDGE_FAULT)


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


def test_variables_that_make_no_sense_are_reported() -> None:
    assert domain_id({"ROS_DOMAIN_ID": "17"}) == 17
    for wrong in ("-1", "x", "233", "²"):
        with raises(ROS_VARIABLE_INVALID, variable="ROS_DOMAIN_ID"):
            domain_id({"ROS_DOMAIN_ID": wrong})
    with raises(ROS_VARIABLE_INVALID, variable="ROS_AUTOMATIC_DISCOVERY_RANGE"):
        discovery_range({"ROS_AUTOMATIC_DISCOVERY_RANGE": "GALAXY"})
    with raises(ROS_VARIABLE_INVALID, variable="ROS_LOCALHOST_ONLY"):
        discovery_range({"ROS_LOCALHOST_ONLY": "yes"})
    with raises(ROS_NODE_NAME_INVALID):
        Ros2Bridge(Graph(), node="my node")
    with raises(OPTION_INVALID, option="--rmw", value="carrier_pigeon"):
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
    assert discovery_range(variables).range == expected


def test_on_this_computer_only_nobody_else_can_connect(bridged: Ros2Bridged) -> None:
    network = dds_of(bridged).participant._network
    assert network.unicast.getsockname()[0] == "127.0.0.1"
    assert {host for host, _ in network.locators} == {"127.0.0.1"}
    assert not network.hears("192.0.2.77")


def test_who_is_named_is_heard_and_nobody_where_that_is_off(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    peers = discovery_range({"ROS_STATIC_PEERS": "localhost; 192.0.2.7 ;;"})
    assert peers.peers == ("localhost", "192.0.2.7")
    network = Network(DOMAIN + 6, peers)
    try:
        assert network.hears("127.0.0.1")
        assert network.hears("192.0.2.7")
        assert not network.hears("192.0.2.8")
        assert ("192.0.2.7", 7400 + 250 * (DOMAIN + 6) + 10) in network.announce
    finally:
        network.close()
    off = Network(DOMAIN + 6, discovery_range({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}))
    try:
        assert not off.announce
        assert not off.hears("127.0.0.1")
    finally:
        off.close()
    with pytest.raises(UnknownHostError, match=r"^no\.such\.host\.invalid$"):
        Network(DOMAIN + 6, Reach(peers=("no.such.host.invalid",)))
    monkeypatch.setenv("ROS_STATIC_PEERS", "no.such.host.invalid")
    loop = Loop(lambda _: None, name="test")
    with raises(ROS_VARIABLE_INVALID, variable="ROS_STATIC_PEERS", value="no.such.host.invalid"):
        Dds(loop, "/gazebo", lambda _: None)


def test_a_peer_is_heard_by_what_its_name_means(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket, "gethostbyname", {"lab-robot": "192.0.2.9"}.__getitem__)
    network = Network(DOMAIN + 6, Reach(peers=("lab-robot",)))
    try:
        assert network.hears("192.0.2.9")
    finally:
        network.close()


def test_zenoh_that_is_missing_is_reported_with_the_command(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "zenoh", None)
    with raises(PACKAGE_MISSING, package="eclipse-zenoh", extra="ros2"):
        Ros2Bridge(Graph(), rmw="zenoh")
