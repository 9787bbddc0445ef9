"""A DDS participant: discovers others, and connects its writers and readers with theirs."""

from __future__ import annotations

import os
import socket
import struct
import time
from collections import Counter, OrderedDict
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace

from rtps_lite import discovery, wire
from rtps_lite.alarm import Alarm
from rtps_lite.discovery import (
    Address,
    Endpoint,
    EndpointQos,
    ParticipantData,
    decode_endpoint,
    decode_participant,
)
from rtps_lite.interface import READ, EventLoop, LimitWarning
from rtps_lite.network import LOOPBACK, PARTICIPANTS, Network, Reach
from rtps_lite.outbox import Outbox
from rtps_lite.reader import Reader, Taken
from rtps_lite.room import Room
from rtps_lite.wire import Guid, MalformedError, Prefix, Received
from rtps_lite.writer import Writer

_ANNOUNCE_FIRST, _ANNOUNCE = (0.0, 0.1, 0.3, 0.6, 1.0), 3.0
"""Times in s of the first announcements after startup, and the interval of all later ones."""
_AGAIN = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Delays in s of repeated announcements to a new participant, which may not receive data yet."""
_TICK = 0.05
_PARTICIPANTS = 512
"""Maximum number of other participants. On each computer, the limit is `network.PARTICIPANTS`."""
_UNANSWERED = 10.0
"""Timeout in s for a participant to respond. Real ones respond at once, or are discovered
again."""
_FRESH = 1.0
"""Time in s for which a participant without a response is not replaced."""
_EXCHANGED = 200
"""Maximum number of replaced participants per s."""
_PROVED = 512
"""Number of responding participants that are remembered although the limit was reached."""
_ENDPOINTS = 2000
"""Maximum number of endpoints per participant, far above that of any ROS program."""
_ENDPOINTS_IN_ALL = 20_000
"""Maximum number of endpoints in total, at most 60 MB. Two hundred nodes have some 8,000."""
_MATCHES = 1000
"""Maximum number of remote endpoints connected to one local endpoint."""
_AT_ONCE = 64
_AT_ONCE_SECONDS = 0.005
"""Datagrams that are handled before anything else, and the time limit for this in s."""
_GATHER = 0.03
"""Delay in s during which changes of remote endpoints are collected."""
_BUILTIN = EndpointQos(reliable=True, transient_local=True, depth=5000)


@dataclass(slots=True)
class _Remote:
    """A remote participant."""

    data: ParticipantData
    address: Address
    host: str
    """Source of its datagrams. All addresses of this computer count as one."""
    found: float
    heard: float
    knows_us: bool = False
    """Whether it has responded. Before, it receives no samples and its endpoints are not
    connected, because it may be fake: an attempt to redirect traffic to a victim, or to fill the
    memory."""
    writers: dict[Guid, Endpoint] = field(default_factory=dict)
    readers: dict[Guid, Endpoint] = field(default_factory=dict)


class Participant:
    """A DDS participant. Used on the loop's thread, unless stated otherwise.

    Args:
        loop: Event loop of the bridge.
        domain: ROS domain ID.
        reach: Discovery range.
        name: Name for lists of participants.
        user_data: User data of the participant.
        warn: Receives warnings.

    Raises:
        DomainFullError: No port is free.
    """

    def __init__(
        self,
        loop: EventLoop,
        *,
        domain: int,
        reach: Reach,
        name: str,
        user_data: bytes,
        warn: Callable[[LimitWarning], None],
    ) -> None:
        self._loop = loop
        self._domain = domain
        self._warn = warn
        self._network = Network(domain, reach)
        # Vendor, host, process, and a random part for several participants in one process.
        self.prefix: Prefix = (
            wire.VENDOR + os.urandom(2) + struct.pack("<I", os.getpid()) + os.urandom(4)
        )
        self.on_endpoints: Callable[[], None] = lambda: None
        """Called when remote writers or readers appear or disappear."""
        self.on_misfit: Callable[[Endpoint, Endpoint, str], None] = lambda *_: None
        """Called with an incompatible local and remote endpoint, and the policy; empty for the
        type."""
        self._data = ParticipantData(
            prefix=self.prefix,
            meta=self._network.locators,
            user=self._network.locators,
            name=name,
            user_data=user_data,
        )
        self._announcement = wire.message(
            self.prefix,
            *self._sample_of_self(discovery.encode_participant(self._data, domain=domain)),
        )
        self._remotes: dict[Prefix, _Remote] = {}
        self._hosts: Counter[str] = Counter()
        """Number of remote participants per computer."""
        self._proved: OrderedDict[Prefix, None] = OrderedDict()
        """Participants that responded while they were not connected."""
        self._exchanged = 0.0
        """Replaced participants, minus the number that the rate limit has released."""
        self._count = 0
        """Number of remote endpoints."""
        self._others_due = False
        self._room = Room()
        self._alarm = Alarm(loop)
        self._outbox = Outbox(self._send, self._alarm.after)
        self._writers: dict[bytes, Writer] = {}
        self._readers: dict[bytes, Reader] = {}
        self._next_entity = 1
        self._closed = False
        self.malformed = 0
        """Number of invalid datagrams."""
        self._publications = self._builtin_writer(discovery.PUBLICATIONS_WRITER)
        self._subscriptions = self._builtin_writer(discovery.SUBSCRIPTIONS_WRITER)
        self._builtin_reader(discovery.PUBLICATIONS_READER, self._found_writer)
        self._builtin_reader(discovery.SUBSCRIPTIONS_READER, self._found_reader)

    def start(self) -> None:
        """Starts discovery. Call it on the loop's thread."""
        self._alarm.start(self._outbox.tick)
        for sock in (self._network.unicast, self._network.multicast):
            if sock is not None:
                self._loop.watch(sock, READ, lambda _, sock=sock: self._receive(sock))  # type: ignore[misc]
        for wait in _ANNOUNCE_FIRST:
            self._loop.after(wait, self._announce)
        self._loop.after(_ANNOUNCE, self._keep_announcing)
        self._tick()

    def close(self) -> None:
        """Announces the end and closes the sockets."""
        if self._closed:
            return
        self._closed = True
        key = discovery.encode_key(self.prefix + discovery.PARTICIPANT, participant=True)
        bye = wire.message(
            self.prefix,
            *self._sample_of_self(
                key, inline=discovery.disposed(self.prefix + discovery.PARTICIPANT)
            ),
        )
        self._network.cast(bye)
        for remote in self._remotes.values():
            self._send((bye,), remote.address)
        for sock in (self._network.unicast, self._network.multicast):
            if sock is not None:
                self._loop.forget(sock)
        self._alarm.close()
        self._network.close()

    # -- endpoints

    def writer(self, topic: str, type_: str, qos: EndpointQos, *, user_data: bytes = b"") -> Writer:
        """Creates a writer."""
        endpoint = self._endpoint(b"\x03", topic, type_, qos, user_data)
        writer = self._writers[endpoint.guid[12:]] = self._made_writer(endpoint)
        self._publications.write(discovery.encode_endpoint(endpoint))
        for remote in self._remotes.values():
            if remote.knows_us:
                for other in remote.readers.values():
                    self._match_reader(writer, other, remote)
        return writer

    def reader(
        self,
        topic: str,
        type_: str,
        qos: EndpointQos,
        take: Callable[[Taken], None],
        *,
        user_data: bytes = b"",
    ) -> Reader:
        """Creates a reader."""
        endpoint = self._endpoint(b"\x04", topic, type_, qos, user_data)
        reader = Reader(endpoint, self._send, take, room=self._room)
        self._readers[endpoint.guid[12:]] = reader
        self._subscriptions.write(discovery.encode_endpoint(endpoint))
        for remote in self._remotes.values():
            if remote.knows_us:
                for other in remote.writers.values():
                    self._match_writer(reader, other, remote)
        return reader

    def remove(self, endpoint: Writer | Reader) -> None:
        """Removes a writer or reader."""
        guid = endpoint.endpoint.guid
        known = self._writers if isinstance(endpoint, Writer) else self._readers
        teller = self._publications if isinstance(endpoint, Writer) else self._subscriptions
        if known.pop(guid[12:], None) is not None and not self._closed:
            teller.write(discovery.encode_key(guid), inline=discovery.disposed(guid), keyed=True)

    def others(self) -> tuple[list[Endpoint], list[Endpoint]]:
        """All writers and all readers of remote participants."""
        remotes = self._remotes.values()
        return (
            [one for remote in remotes for one in remote.writers.values()],
            [one for remote in remotes for one in remote.readers.values()],
        )

    def _endpoint(
        self, kind: bytes, topic: str, type_: str, qos: EndpointQos, user_data: bytes
    ) -> Endpoint:
        entity = self._next_entity.to_bytes(3, "big") + kind
        self._next_entity += 1
        return Endpoint(
            guid=self.prefix + entity, topic=topic, type=type_, qos=qos, user_data=user_data
        )

    def _builtin_writer(self, entity: bytes) -> Writer:
        endpoint = Endpoint(guid=self.prefix + entity, topic="", type="", qos=_BUILTIN)
        writer = self._writers[entity] = self._made_writer(endpoint)
        return writer

    def _made_writer(self, endpoint: Endpoint) -> Writer:
        return Writer(endpoint, self._send, outbox=self._outbox)

    def _builtin_reader(self, entity: bytes, take: Callable[[Taken], None]) -> None:
        endpoint = Endpoint(guid=self.prefix + entity, topic="", type="", qos=_BUILTIN)
        self._readers[entity] = Reader(endpoint, self._send, take, room=self._room, again=True)

    # -- time

    def _announce(self) -> None:
        if not self._closed:
            self._network.cast(self._announcement)

    def _keep_announcing(self) -> None:
        if self._closed:
            return
        self._announce()
        now = time.monotonic()
        for prefix, remote in list(self._remotes.items()):
            made_up = not remote.knows_us and now - remote.found > _UNANSWERED
            if made_up or now - remote.heard > remote.data.lease:
                self._lose(prefix)
            else:
                # The participant may be in a network that announcements do not reach.
                self._send((self._announcement,), remote.address)
        for reader in self._readers.values():
            reader.give_up(now)
        self._loop.after(_ANNOUNCE, self._keep_announcing)

    def _tick(self) -> None:
        if self._closed:
            return
        now = time.monotonic()
        self._exchanged = max(0.0, self._exchanged - _EXCHANGED * _TICK)
        for writer in self._writers.values():
            writer.remind(now)
        for reader in self._readers.values():
            reader.remind()
        self._loop.after(_TICK, self._tick)

    # -- datagrams

    def _send(self, parts: Sequence[bytes | memoryview], address: Address) -> bool:
        try:
            self._network.unicast.sendmsg(parts, (), 0, address)
        except OSError:
            # The buffer is full or the network is down. Reliable endpoints recover from this.
            return False
        return True

    def _receive(self, sock: socket.socket) -> None:
        end = time.monotonic() + _AT_ONCE_SECONDS
        for _ in range(_AT_ONCE):
            if time.monotonic() > end:
                return
            try:
                data, (host, _port) = sock.recvfrom(65536)
            except OSError:
                return
            if not self._network.hears(host):
                continue
            try:
                for received in wire.read(memoryview(data)):
                    if received.prefix != self.prefix and received.to in (None, self.prefix):
                        self._take(received, host)
            except MalformedError:
                self.malformed += 1

    def _take(self, received: Received, host: str) -> None:
        remote = self._remotes.get(received.prefix)
        if remote is not None:
            remote.heard = time.monotonic()
        elif received.to is not None:
            self._proved[received.prefix] = None
            if len(self._proved) > _PROVED:
                self._proved.popitem(last=False)
        content = received.content
        if isinstance(content, wire.Data):
            if content.writer == discovery.SPDP_WRITER:
                self._found_participant(content, received.prefix, host)
                return
            guid = received.prefix + content.writer
            for reader in self._addressed(content.reader, guid):
                reader.take_data(guid, received.vendor, content)
        elif isinstance(content, wire.Heartbeat):
            guid = received.prefix + content.writer
            for reader in self._addressed(content.reader, guid):
                reader.take_heartbeat(guid, content)
        elif isinstance(content, wire.Gap):
            guid = received.prefix + content.writer
            for reader in self._addressed(content.reader, guid):
                reader.take_gap(guid, content)
        else:
            writer = self._writers.get(content.writer)
            if writer is None:
                return
            if remote is not None and received.to is not None and not remote.knows_us:
                self._believe(remote)
            if isinstance(content, wire.Acknack):
                writer.take_acknack(received.prefix + content.reader, content)
            else:
                writer.take_nack_frag(received.prefix + content.reader, content)

    def _addressed(self, entity: bytes, writer: Guid) -> list[Reader]:
        if entity != wire.UNKNOWN:
            reader = self._readers.get(entity)
            return [reader] if reader is not None else []
        return [reader for reader in self._readers.values() if writer in reader.proxies]

    # -- others

    def _sample_of_self(self, payload: bytes, *, inline: bytes = b"") -> tuple[bytes, bytes]:
        head = wire.data_head(
            reader=wire.UNKNOWN if not inline else discovery.SPDP_READER,
            writer=discovery.SPDP_WRITER,
            # The final message has a new number. An announcement repeats the same number.
            number=2 if inline else 1,
            inline=inline,
            size=len(payload),
            keyed=bool(inline),
        )
        return head, payload

    def _found_participant(self, data: wire.Data, prefix: Prefix, host: str) -> None:
        if discovery.is_disposal(data.inline):
            gone = self._remotes.get(prefix)
            guid = discovery.key_of(data.inline, data.payload)
            # A participant can only announce its own end.
            here = LOOPBACK if self._network.is_own(host) else host
            if gone is not None and gone.host == here and (guid is None or guid[:12] == prefix):
                self._lose(prefix)
            return
        told = decode_participant(data.payload)
        if told.prefix != prefix or not told.meta:
            return
        domain = discovery.domain_of(data.payload)
        if domain is not None and domain != self._domain:
            return
        known = self._remotes.get(told.prefix)
        if known is not None:
            known.heard = time.monotonic()
            return
        place = LOOPBACK if self._network.is_own(host) else host
        if not self._has_place(told.prefix, place):
            return
        now = time.monotonic()
        told = replace(told, user=told.user or told.meta)
        remote = _Remote(told, self._nearest(told.meta, host), place, now, now)
        self._remotes[told.prefix] = remote
        self._hosts[place] += 1
        # Send it before all else, so that the receiver can assign the following messages.
        self._send((self._announcement,), remote.address)
        self._greet(remote)
        for wait in _AGAIN:
            self._loop.after(wait, lambda: self._announce_again(remote))

    def _has_place(self, prefix: Prefix, host: str) -> bool:
        """Whether one more participant is allowed. It may replace one that has not responded."""
        full = self._hosts.get(host, 0) >= PARTICIPANTS
        if not full and len(self._remotes) < _PARTICIPANTS:
            return True
        if self._exchanged < _EXCHANGED:
            self._exchanged += 1
            remotes = self._remotes.values()
            silent = (one for one in remotes if not one.knows_us and (one.host == host or not full))
            oldest = next(silent, None)
            if oldest is not None and (
                prefix in self._proved or time.monotonic() - oldest.found > _FRESH
            ):
                self._lose(oldest.data.prefix)
                return True
        self._warn(
            LimitWarning(
                message=f"there are more than {PARTICIPANTS} participants on {host}, or more than "
                f"{_PARTICIPANTS} in total, so some of them are ignored",
                values={"host": host, "most": PARTICIPANTS},
            )
        )
        return False

    def _believe(self, remote: _Remote) -> None:
        """Connects the endpoints of a participant that has responded for the first time."""
        remote.knows_us = True
        for other in remote.writers.values():
            for reader in list(self._readers.values()):
                self._match_writer(reader, other, remote)
        for other in remote.readers.values():
            for writer in list(self._writers.values()):
                self._match_reader(writer, other, remote)
        self._others_changed()

    def _others_changed(self) -> None:
        if not self._others_due:
            self._others_due = True
            self._loop.after(_GATHER, self._announce_others)

    def _announce_others(self) -> None:
        self._others_due = False
        if not self._closed:
            self.on_endpoints()

    def _announce_again(self, remote: _Remote) -> None:
        if not remote.knows_us and self._remotes.get(remote.data.prefix) is remote:
            self._send((self._announcement,), remote.address)

    def _greet(self, remote: _Remote) -> None:
        """Connects the built-in endpoints that exchange discovery data."""
        for entity, other in (
            (discovery.PUBLICATIONS_WRITER, discovery.PUBLICATIONS_READER),
            (discovery.SUBSCRIPTIONS_WRITER, discovery.SUBSCRIPTIONS_READER),
        ):
            guid = remote.data.prefix
            theirs = Endpoint(guid=guid + other, topic="", type="", qos=_BUILTIN)
            self._writers[entity].match(theirs, remote.address, proved=False)
            theirs = Endpoint(guid=guid + entity, topic="", type="", qos=_BUILTIN)
            self._readers[other].match(theirs, remote.address)

    def _lose(self, prefix: Prefix) -> None:
        remote = self._remotes.pop(prefix, None)
        if remote is None:
            return
        self._count -= len(remote.writers) + len(remote.readers)
        self._hosts[remote.host] -= 1
        if not self._hosts[remote.host]:
            del self._hosts[remote.host]
        if not remote.knows_us:
            for one in (self._publications, self._subscriptions):
                for guid in [each for each in one.proxies if each[:12] == prefix]:
                    one.unmatch(guid)
            for entity in (discovery.PUBLICATIONS_READER, discovery.SUBSCRIPTIONS_READER):
                reader = self._readers[entity]
                for guid in [each for each in reader.proxies if each[:12] == prefix]:
                    reader.unmatch(guid)
            return
        for writer in self._writers.values():
            for guid in [one for one in writer.proxies if one[:12] == prefix]:
                writer.unmatch(guid)
        for reader in self._readers.values():
            for guid in [one for one in reader.proxies if one[:12] == prefix]:
                reader.unmatch(guid)
        self._others_changed()

    def _nearest(self, addresses: Sequence[Address], host: str) -> Address:
        """The participant's address that matches the source of its datagrams.

        No other address is used, so that nobody can redirect traffic to a victim.
        """
        for address in addresses:
            if address[0] == host:
                return address
        if self._network.is_own(host):
            for address in addresses:
                if self._network.is_own(address[0]):
                    return address
        return host, addresses[0][1]

    def _found_writer(self, taken: Taken) -> None:
        self._found(taken, are_writers=True)

    def _found_reader(self, taken: Taken) -> None:
        self._found(taken, are_writers=False)

    def _found(self, taken: Taken, *, are_writers: bool) -> None:
        remote = self._remotes.get(taken.writer[:12])
        if remote is None:
            return
        known = remote.writers if are_writers else remote.readers
        try:
            if taken.keyed or discovery.is_disposal(taken.inline):
                guid = discovery.key_of(taken.inline, taken.payload)
                if guid is not None and known.pop(guid, None) is not None:
                    self._count -= 1
                    for one in (self._readers if are_writers else self._writers).values():
                        one.unmatch(guid)
                    self._others_changed()
                return
            endpoint = decode_endpoint(taken.payload, writer=are_writers)
        except MalformedError:
            self.malformed += 1
            return
        if endpoint.guid[:12] != remote.data.prefix:
            return
        if endpoint.guid not in known:
            if len(known) >= _ENDPOINTS or self._count >= _ENDPOINTS_IN_ALL:
                self._warn(
                    LimitWarning(
                        message=f"there are more than {_ENDPOINTS} publishers or subscribers in "
                        f"one process, or more than {_ENDPOINTS_IN_ALL} in total, so some of them "
                        "are ignored",
                        values={"most": _ENDPOINTS},
                    )
                )
                return
            self._count += 1
        known[endpoint.guid] = endpoint
        if not remote.knows_us:
            return
        if are_writers:
            for reader in list(self._readers.values()):
                self._match_writer(reader, endpoint, remote)
        else:
            for writer in list(self._writers.values()):
                self._match_reader(writer, endpoint, remote)
        self._others_changed()

    def _match_reader(self, writer: Writer, other: Endpoint, remote: _Remote) -> None:
        offered = writer.endpoint
        if self._fit(offered, other, offered.qos.misfit(other.qos), writer.proxies):
            writer.match(other, self._address(other, remote))

    def _match_writer(self, reader: Reader, other: Endpoint, remote: _Remote) -> None:
        asked = reader.endpoint
        if self._fit(asked, other, other.qos.misfit(asked.qos), reader.proxies):
            reader.match(other, self._address(other, remote))

    def _address(self, endpoint: Endpoint, remote: _Remote) -> Address:
        return self._nearest(endpoint.locators or remote.data.user, remote.address[0])

    def _fit(
        self, ours: Endpoint, other: Endpoint, policy: str, connected: Collection[Guid]
    ) -> bool:
        if not ours.topic or ours.topic != other.topic:
            return False
        if len(connected) >= _MATCHES and other.guid not in connected:
            self._warn(
                LimitWarning(
                    message=f"more than {_MATCHES} publishers or subscribers match {ours.topic}, "
                    "so some of them are ignored",
                    values={"topic": ours.topic, "most": _MATCHES},
                )
            )
            return False
        if ours.type != other.type or policy:
            self.on_misfit(ours, other, policy)
            return False
        return True
