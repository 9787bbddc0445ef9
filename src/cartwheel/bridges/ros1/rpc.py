"""XML-RPC calls to the ROS master and to other nodes."""

from __future__ import annotations

import http.client
import socket
import threading
import time
import xmlrpc.client
from collections.abc import Sequence
from typing import Any

from cartwheel.bridges.ros1.marshalling import read_values
from cartwheel.codes.wires import ROS_CALL_FAILED
from cartwheel.errors import CartwheelError

TIMEOUT = 5.0
"""Timeout in s for a node's response."""
LARGEST = 32 << 20
"""Maximum size of a response in bytes. Robot descriptions are stored as parameters."""
_ADDRESSES = 4
"""Maximum number of addresses of a host name that are tried."""


class RpcError(CartwheelError):
    """A node or master is unreachable, or refused a call."""

    code = ROS_CALL_FAILED


class UnreachableError(RpcError):
    """A node or master is unreachable.

    Args:
        message: Description of the attempt.
        silent: Whether the connection was accepted, but no response arrived.
    """

    def __init__(self, message: str, *, silent: bool) -> None:
        super().__init__(message)
        self.silent = silent


def connect(host: str, port: int, seconds: float) -> socket.socket:
    """Opens a connection within a timeout, regardless of the number of addresses.

    Raises:
        OSError: No address accepts connections.
    """
    deadline = time.monotonic() + seconds
    try:
        addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (UnicodeError, OverflowError, ValueError) as error:
        raise OSError(f"invalid host name: {error}") from None
    failure = OSError("the host name has no IP address")
    for family, kind, protocol, _, address in addresses[:_ADDRESSES]:
        rest = deadline - time.monotonic()
        if rest <= 0:
            raise TimeoutError("timed out")
        sock = socket.socket(family, kind, protocol)
        sock.settimeout(rest)
        try:
            sock.connect(address)
        except OSError as error:
            sock.close()
            failure = error
        else:
            return sock
    raise failure


class _Socket(socket.socket):
    """Fails if a response is too large or takes too long, even if it comes in small parts."""

    deadline = 0.0
    left = 0
    """Remaining bytes."""

    def sendall(self, data: Any, flags: int = 0) -> None:
        self._hurry()
        super().sendall(data, flags)

    def recv_into(self, buffer: Any, nbytes: int = 0, flags: int = 0) -> int:
        self._hurry()
        count = super().recv_into(buffer, nbytes, flags)
        self.left -= count
        if self.left < 0:
            raise ValueError("the response is too long")
        return count

    def _hurry(self) -> None:
        rest = self.deadline - time.monotonic()
        if rest <= 0:
            raise TimeoutError("timed out")
        self.settimeout(rest)


class _HttpConnection(http.client.HTTPConnection):
    """An HTTP connection with limits for each call; see `begin`."""

    def begin(self, seconds: float, size: int) -> None:
        """Resets the time and byte limits for a new call."""
        self._deadline = time.monotonic() + seconds
        self._size = size
        if isinstance(self.sock, _Socket):
            self.sock.deadline, self.sock.left = self._deadline, size

    def connect(self) -> None:
        made = connect(self.host, self.port, self._deadline - time.monotonic())
        made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.sock = _Socket(fileno=made.detach())
        self.sock.deadline, self.sock.left = self._deadline, self._size


class _Transport(xmlrpc.client.Transport):
    """Limits the time of a call and the size of its response."""

    def __init__(self, timeout: float, largest: int) -> None:
        super().__init__()
        self._timeout = timeout
        self._largest = largest
        # Do not request compressed responses; `parse_response` rejects them.
        self.accept_gzip_encoding = False

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        made = self._connection[1] if self._connection else None
        if host != self._connection[0] or not isinstance(made, _HttpConnection):
            chost, self._extra_headers, _ = self.get_host_info(host)
            made = _HttpConnection(chost)
            self._connection = host, made
        made.begin(self._timeout, self._largest)
        return made

    def parse_response(self, file: Any) -> Any:
        if file.getheader("Content-Encoding"):
            # A few bytes can decompress to any size.
            raise ValueError("the response is compressed, although compression was not requested")
        return read_values(file.read())[0]


class Peer:
    """XML-RPC client for a node or master. Thread-safe; calls run one by one.

    Args:
        uri: URI of the interface.
        timeout: Timeout of a call in s.
        largest: Maximum size of a response in bytes.
    """

    def __init__(self, uri: str, *, timeout: float = TIMEOUT, largest: int = LARGEST) -> None:
        self.uri = uri
        self._lock = threading.Lock()
        self._proxy = xmlrpc.client.ServerProxy(
            uri, transport=_Transport(timeout, largest), allow_none=False
        )

    def call(self, method: str, *arguments: Any) -> Any:
        """Calls a method, and returns the value of the response.

        Raises:
            UnreachableError: No response arrived.
            RpcError: The response reports an error.
        """
        return value_of(self._answer(method, arguments))

    def call_all(self, calls: Sequence[tuple[str, tuple[Any, ...]]]) -> list[Any]:
        """Runs several calls in one request. Each response is a triple of code, message and value.

        Raises:
            UnreachableError: No response arrived.
            RpcError: The master does not support combined calls, or reports an error.
        """
        packed = [{"methodName": method, "params": list(rest)} for method, rest in calls]
        found = self._answer("system.multicall", (packed,))
        if not isinstance(found, list) or len(found) != len(calls):
            raise RpcError(
                f"{self.uri} did not respond to all {len(calls)} calls", values={"uri": self.uri}
            )
        answers = []
        for answer in found:
            if isinstance(answer, list) and len(answer) == 1:
                answers.append(answer[0])
            else:
                said = answer.get("faultString") if isinstance(answer, dict) else None
                answers.append([-1, str(said or "refused"), 0])
        return answers

    def close(self) -> None:
        """Closes the connection."""
        with self._lock:
            self._proxy("close")()

    def _answer(self, method: str, arguments: tuple[Any, ...]) -> Any:
        with self._lock:
            try:
                return getattr(self._proxy, method)(*arguments)
            except xmlrpc.client.Fault as fault:
                said = str(fault.faultString)[:500]
                raise RpcError(
                    f"{self.uri} rejected {method}: {said}",
                    values={"uri": self.uri, "method": method, "reason": said},
                ) from None
            except OSError as error:
                self._proxy("close")()
                raise UnreachableError(
                    f"{self.uri} does not respond: {_reason(error)}",
                    silent=isinstance(error, TimeoutError),
                ) from None
            except Exception as error:  # noqa: BLE001
                # Any error of the HTTP and XML parsers for an invalid response.
                self._proxy("close")()
                raise RpcError(
                    f"{self.uri} sent an invalid response to {method}: {error}",
                    values={"uri": self.uri, "method": method},
                ) from None


def value_of(answer: Any) -> Any:
    """Value of a triple of code, message and value.

    Raises:
        RpcError: The triple is invalid, or reports an error.
    """
    if not isinstance(answer, list | tuple) or len(answer) != 3:
        raise RpcError(f"expected a response with three elements (got {str(answer)[:80]})")
    code, message, value = answer
    if code != 1:
        raise RpcError(str(message)[:500], values={"reason": str(message)[:500]})
    return value


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return "the request timed out"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__
