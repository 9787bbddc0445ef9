"""The built-in endpoints, which exchange the descriptions of all other endpoints.

Source: RTPS 2.5, 8.5.4 (Simple Endpoint Discovery Protocol).
"""

from __future__ import annotations

from functools import partial
from typing import Protocol

from rtps_lite import discovery
from rtps_lite.discovery import Endpoint, EndpointQos
from rtps_lite.matching import disconnect
from rtps_lite.outbox import Outbox, Send
from rtps_lite.reader import Reader, Taken
from rtps_lite.remotes import Remote
from rtps_lite.room import Room
from rtps_lite.wire import Prefix
from rtps_lite.writer import Writer

_QOS = EndpointQos(reliable=True, transient_local=True, depth=5000)


class Found(Protocol):
    """Receives the description or the disposal of a remote endpoint."""

    def __call__(self, taken: Taken, /, *, are_writers: bool) -> None:
        """Called with a sample about a writer or a reader."""


class BuiltinEndpoints:
    """The built-in writers and readers of a participant. Used on the loop's thread.

    Args:
        prefix: GUID prefix of the participant.
        send: Sends a datagram.
        outbox: See `Writer`.
        room: See `Reader`.
        found: See `Found`.
    """

    def __init__(
        self,
        prefix: Prefix,
        *,
        send: Send,
        outbox: Outbox,
        room: Room,
        found: Found,
    ) -> None:
        self.writers = {
            entity: Writer(_endpoint(prefix, entity), send, outbox=outbox)
            for entity in (discovery.PUBLICATIONS_WRITER, discovery.SUBSCRIPTIONS_WRITER)
        }
        """By entity ID."""
        self.readers = {
            entity: Reader(
                _endpoint(prefix, entity),
                send,
                partial(found, are_writers=entity == discovery.PUBLICATIONS_READER),
                room=room,
                again=True,
            )
            for entity in (discovery.PUBLICATIONS_READER, discovery.SUBSCRIPTIONS_READER)
        }
        """By entity ID."""

    def announce(self, endpoint: Writer | Reader) -> None:
        """Sends the description of a local endpoint to all participants."""
        self._announcer(endpoint).write(discovery.encode_endpoint(endpoint.endpoint))

    def withdraw(self, endpoint: Writer | Reader) -> None:
        """Announces that a local endpoint has been removed."""
        guid = endpoint.endpoint.guid
        self._announcer(endpoint).write(
            discovery.encode_key(guid), inline=discovery.disposed(guid), keyed=True
        )

    def connect(self, remote: Remote) -> None:
        """Connects to the built-in endpoints of a participant that may be fake."""
        prefix = remote.data.prefix
        for (ours, writer), (theirs, reader) in zip(
            self.writers.items(), self.readers.items(), strict=True
        ):
            writer.match(_endpoint(prefix, theirs), remote.address, proved=False)
            reader.match(_endpoint(prefix, ours), remote.address)

    def disconnect(self, prefix: Prefix) -> None:
        """Disconnects from the built-in endpoints of a participant."""
        disconnect((*self.writers.values(), *self.readers.values()), prefix)

    def _announcer(self, endpoint: Writer | Reader) -> Writer:
        return self.writers[
            discovery.PUBLICATIONS_WRITER
            if isinstance(endpoint, Writer)
            else discovery.SUBSCRIPTIONS_WRITER
        ]


def _endpoint(prefix: Prefix, entity: bytes) -> Endpoint:
    return Endpoint(guid=prefix + entity, topic="", type="", qos=_QOS)
