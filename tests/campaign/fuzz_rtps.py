"""Datagrams to a participant of DDS with topics and services, from one that is real at first."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from random import Random
from typing import Any
from unittest import mock

from tests.campaign import mutating
from tests.campaign.fuzz_cdr import filled
from tests.campaign.target import FaultError, Target

from cartwheel.bridges.ros2.dds import Dds
from cartwheel.bridges.ros2.middleware import Endpoint, Reply, Served, publisher
from cartwheel.bridges.ros2.qos import DEFAULT, SENSOR
from cartwheel.errors import GraphError
from cartwheel.messages import decode_cdr, encode_cdr, zero
from cartwheel.messages.ros2.types import ros2_service, ros2_type
from rtps_lite import participant as participants
from rtps_lite import room, wire
from rtps_lite.discovery import EndpointQos
from rtps_lite.network import Network

OURS, THEIRS = ("127.0.0.1", 20001), ("127.0.0.1", 20002)
_TWIST, _ODOMETRY, _TF = (
    "geometry_msgs/msg/Twist",
    "nav_msgs/msg/Odometry",
    "tf2_msgs/msg/TFMessage",
)
_SERVICE = "rcl_interfaces/srv/SetParameters"
_TIMERS = 60
"""Functions of the loop that are run after the datagrams of an input."""
_TALK = 8 << 20
"""Bytes that may be sent in answer to one input, which has 64 KiB at most, besides once the
samples of which it may ask for all."""


class Loop:
    """Time advances only when it is set."""

    def __init__(self) -> None:
        self.timers: list[Callable[[], None]] = []

    def after(self, _: float, function: Callable[[], None]) -> None:
        self.timers.append(function)

    def post(self, function: Callable[[], None]) -> None:
        self.timers.append(function)

    def watch(self, *_: Any) -> None:
        """Nothing to watch."""

    def forget(self, _: Any) -> None:
        """Nothing to forget."""

    def pass_time(self, count: int = _TIMERS) -> None:
        """Runs what was asked for, some of it after what that asks for."""
        for _ in range(count):
            if not self.timers:
                return
            self.timers.pop(0)()


class Net(Network):
    """A network of two."""

    def __init__(self, address: tuple[str, int]) -> None:
        self.locators = (address,)
        self.unicast = self
        self.multicast = None
        self.coming: list[bytes] = []
        self.sent: list[tuple[bytes, tuple[str, int]]] = []

    def hears(self, _: str) -> bool:
        return True

    def is_own(self, host: str) -> bool:
        return host.startswith("127.")

    nearest = Network.nearest

    def cast(self, data: bytes) -> None:
        self.sent.append((data, THEIRS))
        self.sent.append((data, OURS))

    def sendmsg(self, parts: Sequence[Any], _: Any, __: int, address: tuple[str, int]) -> None:
        self.sent.append((b"".join(parts), address))

    def recvfrom(self, _: int) -> tuple[bytes, tuple[str, int]]:
        if not self.coming:
            raise BlockingIOError
        return self.coming.pop(0), (THEIRS[0], 40000)

    def close(self) -> None:
        """Nothing to close."""


class Node:
    """A node that publishes, reads and serves what is worth attacking."""

    def __init__(self) -> None:
        self.loop, self.net = Loop(), Net(OURS)
        self.taken = 0
        with _fixed(self.net, b"o"):
            self.dds = Dds(self.loop, "/gazebo", lambda _: None)  # type: ignore[arg-type]
        self.dds.start()
        odometry = self.dds.publish(publisher("/odom", _ODOMETRY))
        latched = self.dds.publish(publisher("/tf_static", _TF))
        self.image = self.dds.publish(publisher("/image", "sensor_msgs/msg/Image", "sensor"))
        latched.send(encode_cdr(filled(_TF)))
        self.odometry = odometry
        for topic, profile in (("/cmd_vel", DEFAULT), ("/fast", SENSOR)):
            endpoint = Endpoint(name=topic, type=ros2_type(_TWIST), profile=profile)
            self.dds.subscribe(endpoint, self._take)
        type_ = ros2_service(_SERVICE)
        service = Endpoint(name="/gazebo/set_parameters", type=type_, profile=DEFAULT)
        self.dds.serve(service, (Served(type_, self._answer),))
        self._response = encode_cdr(zero(type_.response))
        self._request = type_.request

    def _take(self, data: bytes) -> None:
        self.taken += 1
        try:
            decode_cdr(data, _TWIST)
        except GraphError:
            return

    def _answer(self, data: bytes, reply: Reply) -> None:
        try:
            decode_cdr(data, self._request)
        except GraphError:
            return
        reply(self._response)

    def receive(self, datagrams: Sequence[bytes]) -> None:
        """Takes datagrams as a socket brings them."""
        participant = self.dds.participant
        self.net.coming += datagrams
        while self.net.coming:
            participant._receive(self.net)  # type: ignore[arg-type]


def _fixed(net: Net, letter: bytes) -> Any:
    """A participant that is known by the same bytes each time, on that network."""
    return mock.patch.multiple(
        participants,
        Network=lambda *_: net,
        os=mock.Mock(urandom=lambda count: letter * count, getpid=lambda: 1),
    )


def _exchange() -> list[bytes]:
    """All that a real peer sends to the node until it has had everything."""
    node, net, loop = Node(), Net(THEIRS), Loop()
    with _fixed(net, b"t"):
        peer = participants.Participant(
            loop,  # type: ignore[arg-type]
            domain=0,
            reach=mock.Mock(),
            name="peer",
            user_data=b"enclave=/;",
            warn=lambda _: None,
        )
    peer.start()
    twist, odometry = ros2_type(_TWIST).dds, ros2_type(_ODOMETRY).dds
    peer.reader("rt/odom", odometry, EndpointQos(), lambda _: None)
    peer.reader(
        "rt/tf_static", ros2_type(_TF).dds, EndpointQos(transient_local=True), lambda _: None
    )
    image = ros2_type("sensor_msgs/msg/Image").dds
    peer.reader("rt/image", image, EndpointQos(reliable=False), lambda _: None)
    commands = peer.writer("rt/cmd_vel", twist, EndpointQos())
    fast = peer.writer("rt/fast", twist, EndpointQos(reliable=False))
    service = ros2_service(_SERVICE)
    calls = peer.writer("rq/gazebo/set_parametersRequest", service.dds_request, EndpointQos())
    peer.reader(
        "rr/gazebo/set_parametersReply", service.dds_response, EndpointQos(), lambda _: None
    )
    found: list[bytes] = []

    def carry() -> None:
        for _ in range(8):
            loop.pass_time(60)
            to_node = [data for data, address in net.sent if address == OURS]
            net.sent.clear()
            found.extend(to_node)
            node.receive(to_node)
            node.loop.pass_time(60)
            net.coming += [data for data, address in node.net.sent if address == THEIRS]
            node.net.sent.clear()
            while net.coming:
                peer._receive(net)  # type: ignore[arg-type]

    carry()
    node.odometry.send(encode_cdr(filled(_ODOMETRY)))
    node.image.send(encode_cdr(filled("sensor_msgs/msg/Image", 200_000)))
    for writer in (commands, fast):
        writer.write(encode_cdr(filled(_TWIST)))
        writer.write(encode_cdr(filled(_TWIST)) + bytes(130_000))
    calls.write(encode_cdr(filled(service.request)))
    carry()
    if not node.taken:
        raise FaultError("the exchange of the seeds has failed")
    peer.close()
    found += [data for data, address in net.sent if address == OURS]
    return found


def _nack_frag() -> bytes:
    """That the peer lacks two fragments of a sample, which none of ours ever says."""
    writer = b"\x00\x00\x03\x03"
    body = b"\x00\x00\x01\x04" + writer + struct.pack("<iIIIIi", 0, 1, 1, 2, 3 << 30, 1)
    head = struct.pack("<BBH", 0x12, 1, len(body))
    ours = wire.VENDOR + b"oo" + struct.pack("<I", 1) + b"oooo"
    theirs = wire.VENDOR + b"tt" + struct.pack("<I", 1) + b"tttt"
    return wire.message(theirs, head + body, to=ours)


def framed(datagrams: Sequence[bytes]) -> bytes:
    """Datagrams as one input."""
    return b"".join(struct.pack("<H", len(data)) + data for data in datagrams)


def split(data: bytes) -> Iterator[bytes]:
    """The datagrams of an input."""
    at = 0
    while at + 2 <= len(data):
        (length,) = struct.unpack_from("<H", data, at)
        yield data[at + 2 : at + 2 + length]
        at += 2 + length


def seeds() -> list[bytes]:
    """The exchange without what is long, and each of its long datagrams after its beginning."""
    found = _exchange()
    short = list(dict.fromkeys(data for data in found if len(data) < 3000))
    short = [*short[:80], _nack_frag(), short[-1]]
    beginning = short[:40]
    long = [data[:2000] for data in found if len(data) >= 3000]
    return [framed(short), framed(beginning), *(framed([*beginning, data]) for data in long[:4])]


def mutate(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """Some datagrams changed, dropped, repeated, moved or taken from others."""
    found = list(split(data)) or [b""]
    pool = list(split(random.choice(others))) if others else found
    for _ in range(random.choice((1, 1, 2, 3, 6))):
        at = random.randrange(len(found))
        kind = random.random()
        if kind < 0.6:
            found[at] = mutating.binary(found[at], pool or found, random)[:65000]
        elif kind < 0.7:
            found[at : at + 1] = [found[at]] * random.choice((2, 5, 30))
        elif kind < 0.8 and len(found) > 1:
            del found[at]
        elif kind < 0.9:
            found.insert(random.randrange(len(found)), found.pop(at))
        elif pool:
            found.insert(at, random.choice(pool))
    while len(framed(found)) > 60_000 and len(found) > 1:
        found.pop()
    return framed(found)


def run_one(data: bytes) -> None:
    """Takes datagrams, then lets time pass."""
    node = Node()
    faults: list[str] = []
    try:
        node.loop.pass_time(40)
        node.net.sent.clear()
        for datagram in split(data):
            node.receive([datagram])
            node.odometry.send(b"\0\1\0\0" + bytes(712))
        node.loop.pass_time()
        node.dds.participant._outbox.tick()
        sent = [(len(each), address) for each, address in node.net.sent]
        if any(not address[0].startswith("127.") for _, address in sent):
            faults.append("something was sent to another than the sender")
        if sum(size for size, _ in sent) > _TALK:
            faults.append(f"{sum(size for size, _ in sent)} bytes were sent")
        if not 0 <= node.dds.participant._room.held <= 2 * room.LARGEST + (64 << 20):
            faults.append("what is held is not what it can be")
    finally:
        node.dds.close()
    if faults:
        raise FaultError("; ".join(faults))


TARGETS = (Target(name="rtps", seeds=seeds, run_one=run_one, mutate=mutate, share=2.0),)
