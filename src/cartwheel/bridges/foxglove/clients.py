"""Limits for what the library stores per client, because the library has no limits."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from cartwheel.codes.wires import CLIENT_REQUEST_IGNORED
from cartwheel.errors import Diagnostic, Pickled

_MOST, _MOST_BYTES = 1000, 1 << 20
"""Maximum number of entries of one kind per client, and of their characters."""
_ALL, _ALL_BYTES = 10_000, 16 << 20
"""The same limits for all clients together."""


class Clients:
    """Limits the channels and the watched parameters of clients, per client and in total.

    A message that exceeds the limits is not forwarded. The client stays connected, and is warned.

    Args:
        warn: Receives warnings for clients and the user. All calls are on the gate's thread.
    """

    def __init__(self, warn: Callable[[Diagnostic], None]) -> None:
        self._warn = warn
        self._channels = _Total("channels")
        self._parameters = _Total("watched parameters")

    def join(self) -> JoinedClient:
        """Adds a client that has connected."""
        return JoinedClient(_Share(self._channels), _Share(self._parameters), self._warn)


class JoinedClient:
    """A connected client; see `cartwheel.gate.gate.Client`.

    Args:
        channels: Channels that the client advertises.
        parameters: Parameters that the client watches.
        warn: See `Clients`.
    """

    def __init__(
        self, channels: _Share, parameters: _Share, warn: Callable[[Diagnostic], None]
    ) -> None:
        self._channels = channels
        self._parameters = parameters
        self._warn = warn

    def passes(self, text: bytes) -> bool:
        """Whether to forward a text message to the server."""
        try:
            self._take(json.loads(text.decode()))
        except (ValueError, RecursionError):
            # Not forwarded, because the library may parse more text as JSON than Python does.
            self._warn(
                CLIENT_REQUEST_IGNORED.diagnostic(
                    "a client request is ignored because it is not valid JSON"
                )
            )
            return False
        except _FullError as error:
            self._warn(
                CLIENT_REQUEST_IGNORED.diagnostic(
                    f"{error}; additional requests are ignored", values={"limit": error.limit}
                )
            )
            return False
        return True

    def broke(self, fault: str) -> None:
        """Warns that the client is disconnected."""
        self._warn(
            CLIENT_REQUEST_IGNORED.diagnostic(
                f"a client is disconnected: {fault}", values={"fault": fault}
            )
        )

    def end(self) -> None:
        """Releases the entries of a client that has disconnected."""
        self._channels.clear()
        self._parameters.clear()

    def _take(self, asked: Any) -> None:
        operation = asked.get("op") if isinstance(asked, dict) else None
        if operation == "advertise":
            given = [one for one in _items(asked, "channels") if isinstance(one, dict)]
            self._channels.add({repr(one.get("id")): len(repr(one)) for one in given})
        elif operation == "unadvertise":
            self._channels.remove(map(repr, _items(asked, "channelIds")))
        elif operation == "subscribeParameterUpdates":
            names = map(repr, _items(asked, "parameterNames"))
            self._parameters.add({name: len(name) for name in names})
        elif operation == "unsubscribeParameterUpdates":
            self._parameters.remove(map(repr, _items(asked, "parameterNames")))


class _FullError(Pickled, Exception):
    """The limit on entries is reached."""

    def __init__(self, limit: str, text: str) -> None:
        super().__init__(text)
        self.limit = limit


class _Total:
    """Entries of one kind of all clients.

    Args:
        title: Plural name of the kind.
    """

    def __init__(self, title: str) -> None:
        self.title = title
        self.count = 0
        self.size = 0


class _Share:
    """Entries of one kind of one client."""

    def __init__(self, total: _Total) -> None:
        self._total = total
        self._sizes: dict[str, int] = {}

    def add(self, sizes: Mapping[str, int]) -> None:
        """Adds all entries or none.

        Raises:
            _FullError: There are too many entries, or their text is too long.
        """
        new = {name: size for name, size in sizes.items() if name not in self._sizes}
        total, size = self._total, sum(new.values())
        if len(self._sizes) + len(new) > _MOST or sum(self._sizes.values()) + size > _MOST_BYTES:
            raise _FullError(
                f"{total.title} of a client",
                f"a client may have at most {_MOST} {total.title}, with at most "
                f"{_MOST_BYTES >> 20} MiB of names and descriptions",
            )
        if total.count + len(new) > _ALL or total.size + size > _ALL_BYTES:
            raise _FullError(
                f"{total.title} of all clients",
                f"all clients together may have at most {_ALL} {total.title}, with at most "
                f"{_ALL_BYTES >> 20} MiB of names and descriptions",
            )
        self._sizes.update(new)
        total.count += len(new)
        total.size += size

    def remove(self, names: Iterable[str]) -> None:
        """Removes those of the names that exist."""
        for name in names:
            size = self._sizes.pop(name, None)
            if size is not None:
                self._total.count -= 1
                self._total.size -= size

    def clear(self) -> None:
        """Removes all entries."""
        self.remove(list(self._sizes))


def _items(asked: Mapping[str, Any], key: str) -> list[Any]:
    found = asked.get(key)
    return found if isinstance(found, list) else []
