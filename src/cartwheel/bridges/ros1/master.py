"""Parameters on the ROS master, and calls of the master."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.bridges.ros1.rpc import Peer, RpcError, UnreachableError, value_of

Call = tuple[str, tuple[Any, ...]]
_PATIENCE = 2.0
"""Timeout in s for reading a parameter from the master."""
_INT32 = 1 << 31


class MasterParameters:
    """Parameters of the ROS master, as a `cartwheel.graph.ParameterServer`.

    The registrar's thread sets values soon, so that the setting thread, usually the simulation's,
    does not wait. Reading waits for the master, unless the value was just set here.

    Args:
        uri: URI of the master.
        node: Name of the node.
        outer: Returns the master's name of a parameter.
        wake: Notifies the registrar of new values.
    """

    def __init__(
        self, uri: str, *, node: str, outer: Callable[[str], str], wake: Callable[[], None]
    ) -> None:
        self._node = node
        self._outer = outer
        self._wake = wake
        self._peer = Peer(uri, timeout=_PATIENCE)
        self._lock = threading.Lock()
        self._unsent: dict[str, Any] = {}
        self._ours: dict[str, Any] = {}
        """All values set by this process, for a restarted master."""
        self.reachable = True
        """Set by the registrar. An unreachable master is not called."""

    def get(self, name: str) -> Any:
        """Value, mapping for a namespace, or None."""
        name = self._outer(name)
        with self._lock:
            if name in self._unsent or not self.reachable:
                return self._ours.get(name)
        try:
            return self._peer.call("getParam", self._node, name)
        except UnreachableError:
            # Other reads must not wait until the registrar has reached the master again.
            self.reachable = False
            with self._lock:
                return self._ours.get(name)
        except RpcError:
            return None

    def set(self, name: str, value: Any) -> None:
        """Sets a value soon."""
        name = self._outer(name)
        plain = _plain(value)
        with self._lock:
            self._ours[name] = plain
            self._unsent[name] = plain
        self._wake()

    def remember(self) -> None:
        """Marks all values of this process to be set again."""
        with self._lock:
            self._unsent = dict(self._ours)

    def take(self) -> dict[str, Any]:
        """Values that must be set on the master; see `sent`."""
        with self._lock:
            return dict(self._unsent)

    def sent(self, values: Mapping[str, Any]) -> None:
        """Marks values as set."""
        with self._lock:
            for name, value in values.items():
                if name in self._unsent and self._unsent[name] is value:
                    del self._unsent[name]


def call_all(peer: Peer, calls: list[Call]) -> list[Any]:
    """Results of several calls of the master, with an `RpcError` in place of each failed call.

    Raises:
        UnreachableError: The master does not respond.
    """
    try:
        answers = peer.call_all(calls)
    except UnreachableError:
        raise
    except RpcError:
        # This master does not support combined calls.
        return [_tried(peer, call) for call in calls]
    return [_value(answer) for answer in answers]


def _tried(peer: Peer, call: Call) -> Any:
    try:
        return peer.call(call[0], *call[1])
    except UnreachableError:
        raise
    except RpcError as error:
        return error


def _value(answer: Any) -> Any:
    try:
        return value_of(answer)
    except RpcError as error:
        return error


def _plain(value: Any) -> Any:
    """Converts a value for XML-RPC, whose integers have 32 bits."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, bool | float | str):
        return value
    if isinstance(value, int):
        return value if -_INT32 <= value < _INT32 else float(value)
    return str(value)
