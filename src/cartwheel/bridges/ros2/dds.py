"""ROS 2 over DDS: topics, services and nodes as DDS endpoints.

Source: rmw_dds_common, rmw_fastrtps, rmw_cyclonedds.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from cartwheel.bridges.loop import Coalesced, Loop
from cartwheel.bridges.ros2 import names
from cartwheel.bridges.ros2.middleware import Endpoint, Middleware, Served, ignore
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
from cartwheel.errors import CartwheelError, Code, Diagnostic
from cartwheel.messages import encode_cdr, message_class
from cartwheel.messages.ros2.types import Ros2Service, Ros2Type, ros2_type
from rtps_lite import discovery, wire
from rtps_lite.discovery import EndpointQos
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
_REACH = {
    "OFF": "to no other participant",
    "LOCALHOST": "on this computer",
    "SUBNET": "on the network",
}


class Dds(Middleware):
    """A DDS participant with one main node; see `Middleware`."""

    def __init__(self, loop: Loop, node: str, warn: Callable[[Diagnostic], None]) -> None:
        super().__init__(loop, node, warn)
        try:
            self.participant = Participant(
                loop,
                domain=self.domain,
                reach=self.reach,
                name=node,
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
        self._endpoints: dict[Writer | Reader, str] = {}
        """Endpoints, with their nodes."""
        self._info: Writer | None = None
        self._changed = Coalesced(loop, _SOON, self._announce_entities)
        self._closed = False

    def _limit_reached(self, warning: LimitWarning) -> None:
        self.warn(PEER_LIMIT.diagnostic(warning.message, values=warning.values))

    @property
    def description(self) -> str:
        """See `Middleware`."""
        return f"DDS domain {self.domain}, visible {_REACH[self.reach.range]}"

    def start(self) -> None:
        """Starts discovery."""
        self.participant.on_endpoints = self._others_changed
        self.participant.on_misfit = self._report_misfit
        self.participant.start()
        type_ = ros2_type(_ENTITIES)
        self._info = self.participant.writer(
            _NODES,
            type_.dds,
            EndpointQos(transient_local=True, depth=1),
            user_data=_hash(type_),
        )
        self._changed()

    def close(self) -> None:
        """See `Middleware`."""
        self._closed = True
        self.participant.close()

    def publish(self, endpoint: Endpoint, on_readers: Callable[[bool], None] = ignore) -> _Outlet:
        """See `Middleware`."""
        topic = endpoint.name
        writer = self.participant.writer(
            names.dds_topic(topic),
            endpoint.type.dds,
            endpoint.profile.dds,
            user_data=_hash(endpoint.type),
        )
        writer.on_readers = lambda: on_readers(bool(writer.proxies))
        writer.on_drop = self._loss(
            SLOW_SUBSCRIBER,
            topic,
            f"a node receives {topic} too slowly, so messages to this node are dropped",
        )
        writer.on_refusal = self._loss(
            NETWORK_FULL,
            topic,
            f"the operating system's send buffer is full, so messages on {topic} are dropped",
        )
        writer.on_silence = self._loss(
            UNRESPONSIVE_SUBSCRIBER,
            topic,
            f"a subscriber of {topic} no longer responds, so messages to this subscriber are "
            "dropped",
        )
        if writer.proxies:
            on_readers(True)
        return _Outlet(self, endpoint.node, writer)

    def _loss(self, code: Code, topic: str, message: str) -> Callable[[], None]:
        return partial(self.warn, code.diagnostic(message, values={"topic": topic}))

    def subscribe(self, endpoint: Endpoint, take: Callable[[bytes], None]) -> _Part:
        """See `Middleware`."""
        reader = self.participant.reader(
            names.dds_topic(endpoint.name),
            endpoint.type.dds,
            endpoint.profile.dds,
            lambda taken: take(taken.payload),
            user_data=_hash(endpoint.type),
        )
        return _Part(self, endpoint.node, reader)

    def serve(self, endpoint: Endpoint, versions: Sequence[Served]) -> _Service:
        """See `Middleware`."""
        return _Service(self, endpoint, versions)

    def topics_of_others(self) -> set[str]:
        """See `Middleware`."""
        writers, _ = self.participant.others()
        # Ignore other simulations, because both would stop publishing for each other in turn.
        others = (each for each in writers if not each.guid.startswith(wire.VENDOR))
        return {names.topic_of(each.topic) for each in others} - {""}

    def _report_misfit(
        self, ours: discovery.Endpoint, other: discovery.Endpoint, policy: str
    ) -> None:
        """Reports incompatible endpoints, as ROS nodes do, because no messages arrive."""
        name = names.topic_of(ours.topic)
        if not name:
            name = names.service_of(ours.topic)
            does, then = "calls", "so its calls get no response"
        elif ours.is_writer:
            does, then = "reads", "so it receives no messages"
        else:
            does, then = "publishes", "so its messages are not received"
        if not name:
            return
        type_ = names.type_of(other.type)
        if not policy:
            why = f"with type {type_}, but the type here is {names.type_of(ours.type)}"
        elif ours.is_writer:
            why = f"but requests a stricter QoS than is offered ({policy})"
        else:
            why = f"but offers a weaker QoS than is requested ({policy})"
        self.warn(
            (QOS_INCOMPATIBLE if policy else PEER_TYPE_MISMATCH).diagnostic(
                f"a node {does} {name} {why}, {then}",
                values={"name": name, "type": type_, "policy": policy},
            )
        )

    def add(self, node: str, *endpoints: Writer | Reader) -> None:
        """Announces endpoints of a node, or of the main node if it is empty."""
        self._endpoints.update(dict.fromkeys(endpoints, node or self.node))
        self._changed()

    def remove(self, *endpoints: Writer | Reader) -> None:
        """Removes endpoints."""
        for endpoint in endpoints:
            if self._endpoints.pop(endpoint, None) is not None:
                self.participant.remove(endpoint)
        self._changed()

    def _announce_entities(self) -> None:
        """Publishes the endpoints of each node, for ``ros2 node info``."""
        if self._info is None or self._closed:
            return
        nodes: dict[str, list[Writer | Reader]] = {self.node: []}
        for endpoint, node in self._endpoints.items():
            nodes.setdefault(node, []).append(endpoint)
        info = message_class(_ENTITIES)(
            gid=_gid(self.participant.prefix + discovery.PARTICIPANT),
            node_entities_info_seq=[_node_info(*each) for each in nodes.items()],
        )
        self._info.write(encode_cdr(info))


class _Part:
    """A topic, a subscription or a service, with its endpoints."""

    def __init__(self, dds: Dds, node: str, *endpoints: Writer | Reader) -> None:
        self._dds = dds
        self._all = endpoints
        dds.add(node, *endpoints)

    def close(self) -> None:
        self._dds.remove(*self._all)


class _Outlet(_Part):
    """See `middleware.Outlet`."""

    def __init__(self, dds: Dds, node: str, writer: Writer) -> None:
        super().__init__(dds, node, writer)
        self.writer = writer
        self.send = writer.write

    @property
    def dropped(self) -> int:
        return self.writer.dropped


class _Service(_Part):
    """A service: receives requests and sends responses to the client.

    A response identifies its request in one of two ways: rmw_fastrtps sends the identifier in
    inline parameters, rmw_cyclonedds inside the payload. Each client receives its own form.
    """

    def __init__(self, dds: Dds, endpoint: Endpoint, versions: Sequence[Served]) -> None:
        self._loop = dds.loop
        self._served = versions
        self._name = name = endpoint.name
        self._pending = 0
        type_ = versions[0].type
        identity = ".".join(f"{byte:02x}" for byte in os.urandom(16))
        user_data = f"serviceid={identity};".encode() + _hash(type_)
        qos = EndpointQos(depth=max(endpoint.profile.depth, _CALLS))
        self._writer = dds.participant.writer(
            names.dds_response(name), type_.dds_response, qos, user_data=user_data
        )
        self._reader = dds.participant.reader(
            names.dds_request(name), type_.dds_request, qos, self._take, user_data=user_data
        )
        super().__init__(dds, endpoint.node, self._writer, self._reader)

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
        all_data = [self._reader.proxies[writer].user_data, *(each.user_data for each in readers)]
        hashes = {found[1].decode() for data in all_data if (found := _HASH.search(data))}
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
            self._dds.warn(
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


def _is_reader(guid: Guid) -> bool:
    """Whether an endpoint is a reader, according to the lower bits of its last byte."""
    return guid[15] & 0x3F in (0x04, 0x07)


def _hash(type_: Ros2Type | Ros2Service) -> bytes:
    return f"typehash={type_.hash};".encode()


def _node_info(node: str, endpoints: Sequence[Writer | Reader]) -> object:
    namespace, name = names.split_node(node)
    return message_class("rmw_dds_common/msg/NodeEntitiesInfo")(
        node_namespace=namespace or "/",
        node_name=name,
        reader_gid_seq=[_gid(one.endpoint.guid) for one in endpoints if isinstance(one, Reader)],
        writer_gid_seq=[_gid(one.endpoint.guid) for one in endpoints if isinstance(one, Writer)],
    )


def _gid(guid: Guid) -> object:
    return message_class("rmw_dds_common/msg/Gid")(data=np.frombuffer(guid, np.uint8))
