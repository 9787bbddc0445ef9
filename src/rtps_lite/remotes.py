"""The known remote participants with their endpoints, and the limits on their number."""

from __future__ import annotations

import time
from collections import Counter, OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from rtps_lite.discovery import Address, Endpoint, ParticipantData
from rtps_lite.interface import LimitWarning
from rtps_lite.network import PARTICIPANTS
from rtps_lite.wire import Guid, Prefix

_PARTICIPANTS = 512
"""Maximum number of remote participants. On each computer, the limit is `network.PARTICIPANTS`."""
_UNANSWERED = 10.0
"""Timeout in s for a participant to respond. Real ones respond at once, or are discovered
again."""
_FRESH = 1.0
"""Time in s for which a participant without a response is not replaced."""
_REPLACED = 200
"""Maximum number of replaced participants per s."""
_RESPONDED = 512
"""Number of responding participants that are remembered although the limit was reached."""
_ENDPOINTS = 2000
"""Maximum number of endpoints per participant, far above that of any ROS program."""
_ENDPOINTS_IN_ALL = 20_000
"""Maximum number of endpoints in total, at most 60 MB. Two hundred nodes have some 8,000."""


@dataclass(slots=True)
class Remote:
    """A remote participant."""

    data: ParticipantData
    address: Address
    host: str
    """Source of its datagrams. All addresses of this computer count as one."""
    found: float
    """Time of its discovery, s of the monotonic clock."""
    heard: float
    """Time of its last datagram, s of the monotonic clock."""
    knows_us: bool = False
    """Whether it has responded. Before, it receives no samples and its endpoints are not
    connected, because it may be fake: an attempt to redirect traffic to a victim, or to fill the
    memory."""
    writers: dict[Guid, Endpoint] = field(default_factory=dict)
    readers: dict[Guid, Endpoint] = field(default_factory=dict)


class Remotes:
    """The known remote participants. A participant without a response can be replaced by another.

    Args:
        warn: Receives a warning when a limit is reached.
        lose: Disconnects and removes a participant that is replaced.
    """

    def __init__(
        self, *, warn: Callable[[LimitWarning], None], lose: Callable[[Prefix], None]
    ) -> None:
        self._warn = warn
        self._lose = lose
        self.by_prefix: dict[Prefix, Remote] = {}
        """The participants, in the order of their discovery."""
        self._hosts: Counter[str] = Counter()
        """Number of participants per computer."""
        self._responded: OrderedDict[Prefix, None] = OrderedDict()
        """Participants that responded while they were not connected."""
        self._replaced = 0.0
        """Replaced participants, minus the number that the rate limit has released."""
        self._endpoints = 0
        """Number of endpoints of all participants."""

    def responding(self) -> Iterable[Remote]:
        """The participants that have responded, whose endpoints may be connected."""
        return (remote for remote in self.by_prefix.values() if remote.knows_us)

    def endpoints(self) -> tuple[list[Endpoint], list[Endpoint]]:
        """All writers and all readers."""
        remotes = self.by_prefix.values()
        return (
            [one for remote in remotes for one in remote.writers.values()],
            [one for remote in remotes for one in remote.readers.values()],
        )

    def expired(self, now: float) -> list[Prefix]:
        """The participants whose lease has ended, or that did not respond in time.

        Args:
            now: Time in s of the monotonic clock.
        """
        return [
            prefix
            for prefix, remote in self.by_prefix.items()
            if (not remote.knows_us and now - remote.found > _UNANSWERED)
            or now - remote.heard > remote.data.lease
        ]

    def elapse(self, seconds: float) -> None:
        """Allows more replacements after a time."""
        self._replaced = max(0.0, self._replaced - _REPLACED * seconds)

    def note_response(self, prefix: Prefix) -> None:
        """Remembers an unknown participant that responded, so that it may replace another."""
        self._responded[prefix] = None
        if len(self._responded) > _RESPONDED:
            self._responded.popitem(last=False)

    def has_place(self, prefix: Prefix, host: str) -> bool:
        """Whether one more participant is allowed; it may replace one that has not responded.

        Warns if it is not allowed.

        Args:
            prefix: The new participant.
            host: Source of its datagrams, as in `Remote`.
        """
        full = self._hosts.get(host, 0) >= PARTICIPANTS
        if not full and len(self.by_prefix) < _PARTICIPANTS:
            return True
        if self._replaced < _REPLACED:
            self._replaced += 1
            remotes = self.by_prefix.values()
            silent = (one for one in remotes if not one.knows_us and (one.host == host or not full))
            oldest = next(silent, None)
            if oldest is not None and (
                prefix in self._responded or time.monotonic() - oldest.found > _FRESH
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

    def add(self, remote: Remote) -> None:
        """Adds a participant for which there is a place."""
        self.by_prefix[remote.data.prefix] = remote
        self._hosts[remote.host] += 1

    def remove(self, prefix: Prefix) -> Remote | None:
        """Removes and returns a participant; None if it is not known."""
        remote = self.by_prefix.pop(prefix, None)
        if remote is None:
            return None
        self._endpoints -= len(remote.writers) + len(remote.readers)
        self._hosts[remote.host] -= 1
        if not self._hosts[remote.host]:
            del self._hosts[remote.host]
        return remote

    def add_endpoint(self, known: dict[Guid, Endpoint], endpoint: Endpoint) -> bool:
        """Adds or updates an endpoint; warns if the limit is reached.

        Args:
            known: The writers or readers of the endpoint's participant.
            endpoint: The endpoint.

        Returns:
            Whether the endpoint is now known.
        """
        if endpoint.guid not in known:
            if len(known) >= _ENDPOINTS or self._endpoints >= _ENDPOINTS_IN_ALL:
                self._warn(
                    LimitWarning(
                        message=f"there are more than {_ENDPOINTS} publishers or subscribers in "
                        f"one process, or more than {_ENDPOINTS_IN_ALL} in total, so some of them "
                        "are ignored",
                        values={"most": _ENDPOINTS},
                    )
                )
                return False
            self._endpoints += 1
        known[endpoint.guid] = endpoint
        return True

    def remove_endpoint(self, known: dict[Guid, Endpoint], guid: Guid) -> bool:
        """Removes an endpoint from its participant's writers or readers; whether it was known."""
        if known.pop(guid, None) is None:
            return False
        self._endpoints -= 1
        return True
