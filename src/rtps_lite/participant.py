"""A DDS participant: its sockets, announcements, writers and readers."""

from __future__ import annotations

import os
import socket
import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from rtps_lite import discovery, wire
from rtps_lite.alarm import Alarm
from rtps_lite.builtin_endpoints import BuiltinEndpoints
from rtps_lite.discovery import (
    Address,
    Endpoint,
    EndpointQos,
    ParticipantData,
    decode_endpoint,
    decode_participant,
)
from rtps_lite.interface import READ, EventLoop, LimitWarning
from rtps_lite.matching import Matcher, disconnect
from rtps_lite.network import LOOPBACK, Network, Reach
from rtps_lite.outbox import Outbox
from rtps_lite.reader import Reader, Taken
from rtps_lite.remotes import Remote, Remotes
from rtps_lite.room import Room
from rtps_lite.wire import Guid, MalformedError, Prefix, Received
from rtps_lite.writer import Writer

_ANNOUNCE_FIRST, _ANNOUNCE = (0.0, 0.1, 0.3, 0.6, 1.0), 3.0
"""Times in s of the first announcements after startup, and the interval of all later ones."""
_AGAIN = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Delays in s of repeated announcements to a new participant, which may not receive data yet."""
_TICK = 0.05
_AT_ONCE = 64
_AT_ONCE_SECONDS = 0.005
"""Datagrams that are handled before anything else, and the time limit for this in s."""


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
        self._network = Network(domain, reach)
        # Vendor, host, process, and a random part for several participants in one process.
        self.prefix: Prefix = (
            wire.VENDOR + os.urandom(2) + struct.pack("<I", os.getpid()) + os.urandom(4)
        )
        self.on_endpoints: Callable[[], None] = lambda: None
        """Called each time that remote writers or readers appear or disappear."""
        self._alarm = Alarm(loop)
        self._outbox = Outbox(self._send, self._alarm.after)
        self._room = Room()
        self._builtin = BuiltinEndpoints(
            self.prefix, send=self._send, outbox=self._outbox, room=self._room, found=self._found
        )
        self._writers: dict[bytes, Writer] = dict(self._builtin.writers)
        self._readers: dict[bytes, Reader] = dict(self._builtin.readers)
        """By entity ID, including the built-in ones."""
        self._matcher = Matcher(self._network, self._writers, self._readers, warn)
        data = ParticipantData(
            prefix=self.prefix,
            meta=self._network.locators,
            user=self._network.locators,
            name=name,
            user_data=user_data,
        )
        self._announcement = discovery.announcement(data, domain=domain)
        self._remotes = Remotes(warn=warn, lose=self._lose)
        self._next_entity = 1
        self._closed = False
        self.malformed = 0
        """Number of invalid datagrams."""

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
        bye = discovery.farewell(self.prefix)
        self._network.cast(bye)
        for remote in self._remotes.by_prefix.values():
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
        writer = self._writers[endpoint.guid[12:]] = Writer(
            endpoint, self._send, outbox=self._outbox
        )
        self._builtin.announce(writer)
        for remote in self._remotes.responding():
            self._matcher.match_readers(writer, remote)
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
        self._builtin.announce(reader)
        for remote in self._remotes.responding():
            self._matcher.match_writers(reader, remote)
        return reader

    def remove(self, endpoint: Writer | Reader) -> None:
        """Removes a writer or reader."""
        known = self._writers if isinstance(endpoint, Writer) else self._readers
        if known.pop(endpoint.endpoint.guid[12:], None) is not None and not self._closed:
            self._builtin.withdraw(endpoint)

    def others(self) -> tuple[list[Endpoint], list[Endpoint]]:
        """All writers and all readers of remote participants."""
        return self._remotes.endpoints()

    @property
    def on_misfit(self) -> Callable[[Endpoint, Endpoint, str], None]:
        """Called with an incompatible local and remote endpoint, and the policy; empty for the
        type.
        """
        return self._matcher.on_misfit

    @on_misfit.setter
    def on_misfit(self, callback: Callable[[Endpoint, Endpoint, str], None]) -> None:
        self._matcher.on_misfit = callback

    def _endpoint(
        self, kind: bytes, topic: str, type_: str, qos: EndpointQos, user_data: bytes
    ) -> Endpoint:
        entity = self._next_entity.to_bytes(3, "big") + kind
        self._next_entity += 1
        return Endpoint(
            guid=self.prefix + entity, topic=topic, type=type_, qos=qos, user_data=user_data
        )

    # -- time

    def _announce(self) -> None:
        if not self._closed:
            self._network.cast(self._announcement)

    def _keep_announcing(self) -> None:
        if self._closed:
            return
        self._announce()
        now = time.monotonic()
        for prefix in self._remotes.expired(now):
            self._lose(prefix)
        for remote in self._remotes.by_prefix.values():
            # The participant may be in a network that announcements do not reach.
            self._send((self._announcement,), remote.address)
        for reader in self._readers.values():
            reader.give_up(now)
        self._loop.after(_ANNOUNCE, self._keep_announcing)

    def _tick(self) -> None:
        if self._closed:
            return
        now = time.monotonic()
        self._remotes.elapse(_TICK)
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
        remote = self._remotes.by_prefix.get(received.prefix)
        if remote is not None:
            remote.heard = time.monotonic()
        elif received.to is not None:
            self._remotes.note_response(received.prefix)
        content = received.content
        if isinstance(content, wire.Data):
            if content.writer == discovery.SPDP_WRITER:
                self._take_announcement(content, received.prefix, host)
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

    def _take_announcement(self, data: wire.Data, prefix: Prefix, host: str) -> None:
        """Adds the participant that an announcement describes, or removes it at its end.

        Raises:
            MalformedError: The announcement is invalid.
        """
        if discovery.is_disposal(data.inline):
            gone = self._remotes.by_prefix.get(prefix)
            guid = discovery.key_of(data.inline, data.payload)
            # A participant can only announce its own end.
            here = LOOPBACK if self._network.is_own(host) else host
            if gone is not None and gone.host == here and (guid is None or guid[:12] == prefix):
                self._lose(prefix)
            return
        announced = decode_participant(data.payload)
        if announced.prefix != prefix or not announced.meta:
            return
        domain = discovery.domain_of(data.payload)
        if domain is not None and domain != self._domain:
            return
        known = self._remotes.by_prefix.get(announced.prefix)
        if known is not None:
            known.heard = time.monotonic()
            return
        place = LOOPBACK if self._network.is_own(host) else host
        if not self._remotes.has_place(announced.prefix, place):
            return
        now = time.monotonic()
        announced = replace(announced, user=announced.user or announced.meta)
        remote = Remote(announced, self._network.nearest(announced.meta, host), place, now, now)
        self._remotes.add(remote)
        # Send it before all else, so that the receiver can assign the following messages.
        self._send((self._announcement,), remote.address)
        self._builtin.connect(remote)
        for wait in _AGAIN:
            self._loop.after(wait, lambda: self._announce_again(remote))

    def _believe(self, remote: Remote) -> None:
        """Connects the endpoints of a participant that has responded for the first time."""
        remote.knows_us = True
        self._matcher.match_remote(remote)
        self.on_endpoints()

    def _announce_again(self, remote: Remote) -> None:
        if not remote.knows_us and self._remotes.by_prefix.get(remote.data.prefix) is remote:
            self._send((self._announcement,), remote.address)

    def _lose(self, prefix: Prefix) -> None:
        """Removes a participant and disconnects its endpoints."""
        remote = self._remotes.remove(prefix)
        if remote is None:
            return
        if not remote.knows_us:
            self._builtin.disconnect(prefix)
            return
        disconnect((*self._writers.values(), *self._readers.values()), prefix)
        self.on_endpoints()

    def _found(self, taken: Taken, *, are_writers: bool) -> None:
        """Adds or removes an endpoint that a participant has announced."""
        remote = self._remotes.by_prefix.get(taken.writer[:12])
        if remote is None:
            return
        known = remote.writers if are_writers else remote.readers
        try:
            if taken.keyed or discovery.is_disposal(taken.inline):
                guid = discovery.key_of(taken.inline, taken.payload)
                if guid is not None and self._remotes.remove_endpoint(known, guid):
                    for one in (self._readers if are_writers else self._writers).values():
                        one.unmatch(guid)
                    self.on_endpoints()
                return
            endpoint = decode_endpoint(taken.payload, writer=are_writers)
        except MalformedError:
            self.malformed += 1
            return
        if endpoint.guid[:12] != remote.data.prefix:
            return
        if not self._remotes.add_endpoint(known, endpoint):
            return
        if not remote.knows_us:
            return
        self._matcher.match_endpoint(endpoint, remote, is_writer=are_writers)
        self.on_endpoints()
