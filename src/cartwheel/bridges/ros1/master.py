"""Parameters that are kept by the ROS master, and what stands there of this node."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.bridges.ros1.rpc import Peer, RpcError, UnreachableError, value_of

Call = tuple[str, tuple[Any, ...]]
_PATIENCE = 2.0
"""s that whoever reads a parameter waits for the master."""
_INT32 = 1 << 31


class MasterParameters:
    """The master's parameters behind the graph's; see `cartwheel.graph.ParameterServer`.

    Values are set by the registrar's thread, soon: whoever sets one, the simulation above all,
    does not wait. Who reads one waits, unless it was set here.

    Args:
        uri: The master's.
        node: Our name.
        outer: The master's name of a parameter.
        wake: Tells the registrar that there is something to set.
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
        """All that was set here, for the next master."""
        self.reachable = True
        """Kept by the registrar: an absent master is not asked."""

    def get(self, name: str) -> Any:
        """The value, a mapping for a namespace, or None."""
        name = self._outer(name)
        with self._lock:
            if name in self._unsent or not self.reachable:
                return self._ours.get(name)
        try:
            return self._peer.call("getParam", self._node, name)
        except UnreachableError:
            # Nobody else is to wait for it, until the registrar has found one that answers.
            self.reachable = False
            with self._lock:
                return self._ours.get(name)
        except RpcError:
            return None

    def set(self, name: str, value: Any) -> None:
        """Stores a value, soon."""
        name = self._outer(name)
        plain = _plain(value)
        with self._lock:
            self._ours[name] = plain
            self._unsent[name] = plain
        self._wake()

    def remember(self) -> None:
        """All that was set here is to be set again."""
        with self._lock:
            self._unsent = dict(self._ours)

    def take(self) -> dict[str, Any]:
        """What is to be set; see `sent`."""
        with self._lock:
            return dict(self._unsent)

    def sent(self, values: Mapping[str, Any]) -> None:
        """These are set."""
        with self._lock:
            for name, value in values.items():
                if name in self._unsent and self._unsent[name] is value:
                    del self._unsent[name]


def call_all(peer: Peer, calls: list[Call]) -> list[Any]:
    """The values of several calls of the master; an `RpcError` in place of one that failed.

    Raises:
        UnreachableError: No answer.
    """
    try:
        answers = peer.call_all(calls)
    except UnreachableError:
        raise
    except RpcError:
        # A master that knows no such calls gets them one by one.
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
    """A value that XML-RPC can carry; its integers have 32 bits."""
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
