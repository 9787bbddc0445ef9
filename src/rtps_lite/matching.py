"""Connects local endpoints with the remote endpoints of the same topic, type and policies."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping

from rtps_lite.discovery import Address, Endpoint
from rtps_lite.interface import LimitWarning
from rtps_lite.network import Network
from rtps_lite.reader import Reader
from rtps_lite.remotes import Remote
from rtps_lite.wire import Guid, Prefix
from rtps_lite.writer import Writer

_MATCHES = 1000
"""Maximum number of remote endpoints connected to one local endpoint."""


class Matcher:
    """Connects local and remote endpoints.

    Args:
        network: Determines the address to send to.
        writers: The local writers by entity ID; the participant changes it.
        readers: The local readers, likewise.
        warn: Receives a warning when a limit is reached.
    """

    def __init__(
        self,
        network: Network,
        writers: Mapping[bytes, Writer],
        readers: Mapping[bytes, Reader],
        warn: Callable[[LimitWarning], None],
    ) -> None:
        self._network = network
        self._writers = writers
        self._readers = readers
        self._warn = warn
        self.on_misfit: Callable[[Endpoint, Endpoint, str], None] = lambda *_: None
        """Called with an incompatible local and remote endpoint, and the policy; empty for the
        type."""

    def match_remote(self, remote: Remote) -> None:
        """Connects all endpoints of a participant."""
        for other in remote.writers.values():
            self.match_endpoint(other, remote, is_writer=True)
        for other in remote.readers.values():
            self.match_endpoint(other, remote, is_writer=False)

    def match_endpoint(self, other: Endpoint, remote: Remote, *, is_writer: bool) -> None:
        """Connects one endpoint of a participant with all compatible local endpoints."""
        if is_writer:
            for reader in list(self._readers.values()):
                self._match_writer(reader, other, remote)
        else:
            for writer in list(self._writers.values()):
                self._match_reader(writer, other, remote)

    def match_readers(self, writer: Writer, remote: Remote) -> None:
        """Connects a local writer with all compatible readers of a participant."""
        for other in remote.readers.values():
            self._match_reader(writer, other, remote)

    def match_writers(self, reader: Reader, remote: Remote) -> None:
        """Connects a local reader with all compatible writers of a participant."""
        for other in remote.writers.values():
            self._match_writer(reader, other, remote)

    def _match_reader(self, writer: Writer, other: Endpoint, remote: Remote) -> None:
        offered = writer.endpoint
        if self._is_match(offered, other, offered.qos.misfit(other.qos), writer.proxies):
            writer.match(other, self._address(other, remote))

    def _match_writer(self, reader: Reader, other: Endpoint, remote: Remote) -> None:
        requested = reader.endpoint
        if self._is_match(requested, other, other.qos.misfit(requested.qos), reader.proxies):
            reader.match(other, self._address(other, remote))

    def _address(self, endpoint: Endpoint, remote: Remote) -> Address:
        return self._network.nearest(endpoint.locators or remote.data.user, remote.address[0])

    def _is_match(
        self, ours: Endpoint, other: Endpoint, policy: str, connected: Collection[Guid]
    ) -> bool:
        """Whether to connect two endpoints; reports incompatible ones and exceeded limits.

        Args:
            ours: The local endpoint.
            other: The remote endpoint.
            policy: The incompatible policy; empty if all policies are compatible.
            connected: Remote endpoints that are connected with the local endpoint.
        """
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


def disconnect(endpoints: Iterable[Writer | Reader], prefix: Prefix) -> None:
    """Disconnects local endpoints from all endpoints of a participant."""
    for one in endpoints:
        for guid in [each for each in one.proxies if each[:12] == prefix]:
            one.unmatch(guid)
