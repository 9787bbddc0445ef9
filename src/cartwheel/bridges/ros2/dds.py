"""ROS 2 over DDS: names and formats of topics, services and nodes.

Source: the design article on topic and service name mapping, rmw_dds_common, rmw_fastrtps,
rmw_cyclonedds.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Sequence

import numpy as np

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.bridges.ros2.middleware import Profile, Served
from cartwheel.codes.wires import (
    CALL_LIMIT,
    DOMAIN_FULL,
    NETWORK_FULL,
    PEER_LIMIT,
    PEER_TYPE_MISMATCH,
    QOS_INCOMPATIBLE,
    ROS_VARIABLE_INVALID,
    SLOW_SUBSCRIBER,
    UNRESPONSIVE_SUBSCRIBER,
)
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.messages import encode_cdr, message_class
from cartwheel.messages.ros2.types import Ros2Type, ros2_type
from rtps_lite import discovery, wire
from rtps_lite.discovery import Endpoint, EndpointQos
from rtps_lite.interface import DomainFullError, LimitWarning, UnknownHostError
from rtps_lite.participant import Participant
from rtps_lite.reader import Reader, Taken
from rtps_lite.wire import Guid, Prefix
from rtps_lite.writer import ReaderProxy, Writer

_NODES = "ros_discovery_info"
_ENTITIES = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_SOON = 0.03
"""Delay in s during which changes of endpoints are collected."""
_HEADER = 16
"""Bytes in front of requests and responses in rmw_cyclonedds: client and sequence number."""
_PATIENCE, _PAUSE = 2.0, 0.02
"""Timeout in s for a response whose reader is not discovered yet, and the polling interval."""
_PENDING = 100
"""Maximum number of requests and responses per service that wait for a reader."""
_HASH = re.compile(rb"typehash=(\w+)", re.ASCII)
_CALLS = 100
"""Minimum number of responses to keep, so that clients with many requests lose none."""


class Dds:
    """A DDS participant with one main node.

    Args:
        loop: Event loop of the bridge.
        node: Name of the node.
        namespace: Namespace of the node.
        tell: Receives warnings.

    Raises:
        CartwheelError: A ROS environment variable is invalid, or no port is free.
    """

    def __init__(
        self, loop: Loop, *, node: str, namespace: str, tell: Callable[[Diagnostic], None]
    ) -> None:
        self.loop = loop
        self._tell = tell
        self._name = f"{namespace.rstrip('/')}/{node}"
        self._domain = domain_id()
        self._reach = discovery_range()
        try:
            self.participant = Participant(
                loop,
                domain=self._domain,
                reach=self._reach,
                name=self._name,
                user_data=b"enclave=/;",
                warn=self._limit_reached,
            )
        except DomainFullError:
            raise CartwheelError(
                "all ports for participants in this ROS domain are in use",
                code=DOMAIN_FULL,
                hint="Set ROS_DOMAIN_ID to a different domain.",
            ) from None
        except UnknownHostError as error:
            raise CartwheelError(
                f'ROS_STATIC_PEERS contains the unknown host "{error}"',
                code=ROS_VARIABLE_INVALID,
                values={"variable": "ROS_STATIC_PEERS", "value": str(error)},
            ) from None
        self.on_others: Callable[[], None] = lambda: None
        self._endpoints: dict[Writer | Reader, str] = {}
        """Endpoints, with their nodes."""
        self._info: Writer | None = None
        self._due = False
        self._closed = False

    def _limit_reached(self, warning: LimitWarning) -> None:
        self._tell(PEER_LIMIT.diagnostic(warning.message, values=warning.values))

    @property
    def description(self) -> str:
        """Description of the middleware and its domain."""
        where = {
            "OFF": "to no other participant",
            "LOCALHOST": "on this computer",
            "SUBNET": "on the network",
        }
        return f"DDS domain {self._domain}, visible {where[self._reach.range]}"

    def start(self) -> None:
        """Starts discovery."""
        self.participant.on_endpoints = self._found_others
        self.participant.on_misfit = self._found_misfit
        self.participant.start()
        type_ = ros2_type(_ENTITIES)
        self._info = self.participant.writer(
            _NODES,
            type_.dds,
            EndpointQos(transient_local=True, depth=1),
            user_data=_hash(type_.hash),
        )
        self._changed()

    def close(self) -> None:
        """Disconnects."""
        self._closed = True
        self.participant.close()

    def publish(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        on_readers: Callable[[bool], None],
        *,
        node: str = "",
    ) -> _Outlet:
        """See `Middleware`."""
        writer = self.participant.writer(
            f"rt{topic}", type_.dds, _qos(profile), user_data=_hash(type_.hash)
        )
        writer.on_readers = lambda: on_readers(bool(writer.proxies))
        writer.on_drop = lambda: self._tell(
            SLOW_SUBSCRIBER.diagnostic(
                f"a node receives {topic} too slowly, so messages to this node are dropped",
                values={"topic": topic},
            )
        )
        writer.on_refusal = lambda: self._tell(
            NETWORK_FULL.diagnostic(
                f"the operating system's send buffer is full, so messages on {topic} are dropped",
                values={"topic": topic},
            )
        )
        writer.on_silence = lambda: self._tell(
            UNRESPONSIVE_SUBSCRIBER.diagnostic(
                f"a subscriber of {topic} no longer responds, so messages to this subscriber are "
                "dropped",
                values={"topic": topic},
            )
        )
        if writer.proxies:
            on_readers(True)
        self._add(node, writer)
        return _Outlet(self, writer)

    def subscribe(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        take: Callable[[bytes], None],
        *,
        node: str = "",
    ) -> _Inlet:
        """See `Middleware`."""
        reader = self.participant.reader(
            f"rt{topic}",
            type_.dds,
            _qos(profile),
            lambda taken: take(taken.payload),
            user_data=_hash(type_.hash),
        )
        self._add(node, reader)
        return _Inlet(self, reader)

    def serve(self, name: str, served: Sequence[Served], *, depth: int, node: str = "") -> _Service:
        """See `Middleware`."""
        qos = EndpointQos(depth=max(depth, _CALLS))
        return _Service(self, name, served, qos=qos, node=node)

    def topics_of_others(self) -> set[str]:
        """See `Middleware`."""
        writers, _ = self.participant.others()
        # Ignore other simulations, because both would stop publishing for each other in turn.
        return {
            writer.topic.removeprefix("rt")
            for writer in writers
            if writer.topic.startswith("rt/") and not writer.guid.startswith(wire.VENDOR)
        }

    def _found_others(self) -> None:
        self.on_others()

    def _found_misfit(self, ours: Endpoint, other: Endpoint, policy: str) -> None:
        """Reports incompatible endpoints, as ROS nodes do, because no messages arrive."""
        kind, slash, name = ours.topic.partition("/")
        if kind == "rt":
            does, then = (
                ("reads", "so it receives no messages")
                if ours.is_writer
                else ("publishes", "so its messages are not received")
            )
        elif kind == "rq":
            name, does, then = (
                name.removesuffix("Request"),
                "calls",
                ("so its calls get no response"),
            )
        else:
            return
        if not policy:
            why = f"with type {_plain(other.type)}, but the type here is {_plain(ours.type)}"
        elif ours.is_writer:
            why = f"but requests a stricter QoS than is offered ({policy})"
        else:
            why = f"but offers a weaker QoS than is requested ({policy})"
        self._tell(
            (QOS_INCOMPATIBLE if policy else PEER_TYPE_MISMATCH).diagnostic(
                f"a node {does} {slash}{name} {why}, {then}",
                values={"name": f"{slash}{name}", "type": _plain(other.type), "policy": policy},
            )
        )

    def _add(self, node: str, *endpoints: Writer | Reader) -> None:
        self._endpoints.update(dict.fromkeys(endpoints, node or self._name))
        self._changed()

    def _remove(self, *endpoints: Writer | Reader) -> None:
        for endpoint in endpoints:
            if self._endpoints.pop(endpoint, None) is not None:
                self.participant.remove(endpoint)
        self._changed()

    def _changed(self) -> None:
        if not self._due:
            self._due = True
            self.loop.after(_SOON, self._tell_entities)

    def _tell_entities(self) -> None:
        """Publishes the endpoints of each node, for ``ros2 node info``."""
        self._due = False
        if self._info is None or self._closed:
            return
        nodes: dict[str, list[Writer | Reader]] = {self._name: []}
        for endpoint, node in self._endpoints.items():
            nodes.setdefault(node, []).append(endpoint)
        info = message_class(_ENTITIES)(
            gid=_gid(self.participant.prefix + discovery.PARTICIPANT),
            node_entities_info_seq=[_node_info(*each) for each in nodes.items()],
        )
        self._info.write(encode_cdr(info))


class _Outlet:
    """See `middleware.Outlet`."""

    def __init__(self, dds: Dds, writer: Writer) -> None:
        self._dds = dds
        self.writer = writer

    @property
    def dropped(self) -> int:
        return self.writer.dropped

    def send(self, payload: bytes) -> None:
        self.writer.write(payload)

    def close(self) -> None:
        self._dds._remove(self.writer)


class _Inlet:
    """See `middleware.Closable`."""

    def __init__(self, dds: Dds, reader: Reader) -> None:
        self._dds = dds
        self.reader = reader

    def close(self) -> None:
        self._dds._remove(self.reader)


class _Service:
    """A service: receives requests and sends responses to the client.

    A response identifies its request in one of two ways: rmw_fastrtps sends the identifier in
    inline parameters, rmw_cyclonedds inside the payload. Each client receives its own form.
    """

    def __init__(
        self,
        dds: Dds,
        name: str,
        served: Sequence[Served],
        *,
        qos: EndpointQos,
        node: str,
    ) -> None:
        self._dds = dds
        self._loop = dds.loop
        self._served = served
        self._name = name
        self._pending = 0
        type_ = served[0].type
        identity = ".".join(f"{byte:02x}" for byte in os.urandom(16))
        user_data = f"serviceid={identity};".encode() + _hash(type_.hash)
        self._writer = dds.participant.writer(
            f"rr{name}Reply", type_.dds_response, qos, user_data=user_data
        )
        self._reader = dds.participant.reader(
            f"rq{name}Request", type_.dds_request, qos, self._take, user_data=user_data
        )
        dds._add(node, self._writer, self._reader)

    def close(self) -> None:
        self._dds._remove(self._writer, self._reader)

    def _take(self, taken: Taken, patience: float = _PATIENCE) -> None:
        readers = self._readers_of(taken.writer[:12])
        served = self._versions_of(taken.writer, readers)
        if len(served) > 1 and not readers and patience > 0:
            # The response reader, which identifies the version, may be discovered later.
            self._again(lambda: self._take(taken, patience - _PAUSE))
            return
        self._answer(taken, served[0])

    def _answer(self, taken: Taken, served: Served) -> None:
        payload = taken.payload
        related = taken.inline.get(discovery.RELATED) or taken.inline.get(discovery.RELATED_FASTDDS)
        bare = payload[:4] + payload[4 + _HEADER :]
        # Some clients use both forms at once. Then the payload itself must show which one it has.
        within = len(payload) >= 4 + _HEADER and (
            taken.vendor == wire.CYCLONE or (not served.fits(payload) and served.fits(bare))
        )
        head = b""
        if within:
            head, payload = payload[4 : 4 + _HEADER], bare
        asker: Guid = taken.writer
        if related is not None and len(related) >= 16 and any(related[:16]):
            # Fast DDS specifies the reader of the response.
            asker = related[:16]
        inline = b"" if within else discovery.related(asker, taken.number)

        def reply(response: bytes) -> None:
            data = response[:4] + head + response[4:]
            self._send(data, inline, taken.writer[:12], asker, _PATIENCE)

        served.answer(payload, reply)

    def _readers_of(self, prefix: Prefix) -> list[ReaderProxy]:
        """Response readers of a participant."""
        return [one for guid, one in self._writer.proxies.items() if guid[:12] == prefix]

    def _versions_of(self, writer: Guid, readers: Sequence[ReaderProxy]) -> Sequence[Served]:
        """Versions of the type that a client may use, according to the hashes of its endpoints.

        The hashes belong to the request and the response. Two versions may share one of them.
        """
        if len(self._served) == 1 or writer not in self._reader.proxies:
            return self._served[:1]
        told = [self._reader.proxies[writer].user_data, *(each.user_data for each in readers)]
        hashes = {found[1].decode() for data in told if (found := _HASH.search(data))}
        fitting = [each for each in self._served if all(map(each.is_of, hashes))]
        return fitting or self._served[:1]

    def _send(self, data: bytes, inline: bytes, to: Prefix, asker: Guid, patience: float) -> None:
        # A participant may also have readers for other clients of the service.
        ready = asker in self._writer.proxies if _is_reader(asker) else bool(self._readers_of(to))
        if ready or patience <= 0:
            self._writer.write(data, inline=inline, to=to)
        else:
            # The response reader may be discovered after the request writer.
            self._again(lambda: self._send(data, inline, to, asker, patience - _PAUSE))

    def _again(self, function: Callable[[], None]) -> None:
        """Retries soon, unless too many retries are pending."""
        if self._pending >= _PENDING:
            self._dds._tell(
                CALL_LIMIT.diagnostic(
                    f"more than {_PENDING} responses of {self._name} are waiting for DDS "
                    "to discover the clients, so one is dropped",
                    values={"service": self._name, "most": _PENDING},
                )
            )
            return
        self._pending += 1

        def run() -> None:
            self._pending -= 1
            function()

        self._loop.after(_PAUSE, run)


def _qos(profile: Profile) -> EndpointQos:
    return EndpointQos(
        reliable=profile.reliable,
        transient_local=profile.transient_local,
        depth=profile.depth,
        lifespan=profile.lifespan or math.inf,
    )


def _is_reader(guid: Guid) -> bool:
    """Whether an endpoint is a reader, according to the lower bits of its last byte."""
    return guid[15] & 0x3F in (0x04, 0x07)


def _plain(dds: str) -> str:
    """ROS name of a type, truncated in case a malicious peer sent it."""
    return dds.replace("::dds_::", "::").replace("::", "/").removesuffix("_")[:100]


def _hash(value: str) -> bytes:
    return f"typehash={value};".encode()


def _node_info(node: str, endpoints: Sequence[Writer | Reader]) -> object:
    namespace, _, name = node.rpartition("/")
    return message_class("rmw_dds_common/msg/NodeEntitiesInfo")(
        node_namespace=namespace or "/",
        node_name=name,
        reader_gid_seq=[_gid(one.endpoint.guid) for one in endpoints if isinstance(one, Reader)],
        writer_gid_seq=[_gid(one.endpoint.guid) for one in endpoints if isinstance(one, Writer)],
    )


def _gid(guid: Guid) -> object:
    return message_class("rmw_dds_common/msg/Gid")(data=np.frombuffer(guid, np.uint8))
