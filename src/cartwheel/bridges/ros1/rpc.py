"""Calls of the XML-RPC interfaces of ROS 1's master and nodes."""

from __future__ import annotations

import http.client
import threading
import xmlrpc.client
from collections.abc import Sequence
from typing import Any

from cartwheel.errors import CartwheelError

TIMEOUT = 5.0
"""s that another node may take to answer."""


class RpcError(CartwheelError):
    """A node or master that cannot be reached, or refuses a call."""


class UnreachableError(RpcError):
    """Nobody answers there.

    Args:
        message: What was tried.
        silent: Somebody listens there, but says nothing.
    """

    def __init__(self, message: str, *, silent: bool) -> None:
        super().__init__(message)
        self.silent = silent


class _Transport(xmlrpc.client.Transport):
    """Waits no longer than a time-out."""

    def __init__(self, timeout: float) -> None:
        super().__init__()
        self._timeout = timeout
        # Requests go in one packet each, but for this.
        self.accept_gzip_encoding = False

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        if self._connection and host == self._connection[0] and self._connection[1]:
            return self._connection[1]
        chost, self._extra_headers, _ = self.get_host_info(host)
        made = http.client.HTTPConnection(chost, timeout=self._timeout)
        self._connection = host, made
        return made


class Peer:
    """The XML-RPC interface of a node or master; for any thread, one call at a time.

    Args:
        uri: Its address.
        timeout: s for a call.
    """

    def __init__(self, uri: str, *, timeout: float = TIMEOUT) -> None:
        self.uri = uri
        self._lock = threading.Lock()
        self._proxy = xmlrpc.client.ServerProxy(
            uri, transport=_Transport(timeout), allow_none=False
        )

    def call(self, method: str, *arguments: Any) -> Any:
        """The value of a call's answer.

        Raises:
            UnreachableError: No answer.
            RpcError: The answer is no success.
        """
        return value_of(self._answer(method, arguments))

    def call_all(self, calls: Sequence[tuple[str, tuple[Any, ...]]]) -> list[Any]:
        """Several calls in one; the answers are triples of code, message and value.

        Raises:
            UnreachableError: No answer.
            RpcError: It does not know such calls, or fails.
        """
        packed = [{"methodName": method, "params": list(rest)} for method, rest in calls]
        answers = []
        for answer in self._answer("system.multicall", (packed,)):
            if isinstance(answer, dict):
                answers.append([-1, str(answer.get("faultString", "refused")), 0])
            else:
                answers.append(answer[0])
        return answers

    def _answer(self, method: str, arguments: tuple[Any, ...]) -> Any:
        with self._lock:
            try:
                return getattr(self._proxy, method)(*arguments)
            except xmlrpc.client.Fault as fault:
                raise RpcError(f"{self.uri} refuses {method}: {fault.faultString}") from None
            except OSError as error:
                self._proxy("close")()
                raise UnreachableError(
                    f"{self.uri} does not answer: {_reason(error)}",
                    silent=isinstance(error, TimeoutError),
                ) from None
            except Exception as error:  # noqa: BLE001
                # Whatever the parsers of HTTP and XML meet in an answer that is none.
                self._proxy("close")()
                raise RpcError(f"{self.uri} answers {method} with nonsense: {error}") from None


def value_of(answer: Any) -> Any:
    """The value of a triple of code, message and value.

    Raises:
        RpcError: It is none, or no success.
    """
    if not isinstance(answer, list | tuple) or len(answer) != 3:
        raise RpcError(f"an answer of ROS has three parts, not {str(answer)[:80]}")
    code, message, value = answer
    if code != 1:
        raise RpcError(str(message))
    return value


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return "it took too long"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__
