"""Services: decodes requests, calls handlers, and encodes responses."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.middleware import CALLS, Closable, Middleware, Reply, Served
from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.codes.wires import CALL_LIMIT, MALFORMED_MESSAGE
from cartwheel.errors import Diagnostic, GraphError, one_line
from cartwheel.messages import decode_cdr, encode_cdr, zero
from cartwheel.messages.ros2.types import Ros2Service, ros2_service
from cartwheel.messages.ros2.versions import OlderService, older_versions

_MOST_CALLS = 32
"""Maximum number of simultaneous calls."""


class Services:
    """Offers services. Used on the loop's thread.

    Args:
        loop: Event loop of the bridge.
        middleware: Middleware to offer services on.
        tell: Receives warnings.
    """

    def __init__(
        self, loop: Loop, middleware: Middleware, tell: Callable[[Diagnostic], None]
    ) -> None:
        self._loop = loop
        self._middleware = middleware
        self._tell = tell
        self._calls = 0

    def offer(
        self,
        name: str,
        type_name: str,
        handler: Callable[[Any], Any],
        *,
        threaded: bool = False,
        depth: int = CALLS,
        node: str = "",
    ) -> Closable:
        """Offers a service.

        Args:
            name: Service name.
            type_name: ``pkg/srv/Name``.
            handler: Takes a request, and returns the response or raises.
            threaded: Whether the handler may be slow, and so runs on a separate thread per call.
            depth: See `Middleware.serve`.
            node: See `Middleware.publish`.
        """
        served = functools.partial(self._served, name, threaded=threaded)
        versions = (
            served(ros2_service(type_name), handler),
            *(
                served(older.type, _for_older(older, handler))
                for older in older_versions(type_name)
            ),
        )
        return self._middleware.serve(name, versions, depth=depth, node=node)

    def _served(
        self,
        name: str,
        type_: Ros2Service,
        handler: Callable[[Any], Any],
        *,
        threaded: bool,
    ) -> Served:
        def answer(data: bytes, reply: Reply) -> None:
            try:
                request = decode_cdr(data, type_.request)
            except GraphError as error:
                self._tell(
                    MALFORMED_MESSAGE.because(
                        f"malformed request to {name}", error, values={"service": name}
                    )
                )
                return
            if threaded:
                self._in_thread(lambda: respond(request, reply), name)
            else:
                respond(request, reply)

        def respond(request: Any, reply: Reply) -> None:
            try:
                response = handler(request)
                data = encode_cdr(response)
            except Exception as error:  # noqa: BLE001 - the client waits for a response
                data = encode_cdr(self._failure(name, type_, error))
            self._loop.post(lambda: reply(data))

        return Served(type_, answer)

    def _in_thread(self, function: Callable[[], None], name: str) -> None:
        if self._calls >= _MOST_CALLS:
            self._tell(
                CALL_LIMIT.diagnostic(
                    f"there are more than {_MOST_CALLS} concurrent service calls, so one call to "
                    f"{name} gets no response",
                    values={"service": name, "most": _MOST_CALLS},
                )
            )
            return
        self._calls += 1

        def run() -> None:
            try:
                function()
            finally:
                self._loop.post(done)

        def done() -> None:
            self._calls -= 1

        threading.Thread(target=run, name=f"ros2 call {name}", daemon=True).start()

    def _failure(self, name: str, type_: Ros2Service, error: Exception) -> Any:
        """Response for a failed call, with the error in a text field if there is one."""
        response = zero(type_.response)
        for field in ("status_message", "message"):
            if isinstance(getattr(response, field, None), str):
                setattr(response, field, one_line(error))
                return response
        self._tell(SERVICE_FAILED.because(f"{name} failed", error, values={"service": name}))
        return response


def _for_older(older: OlderService, handler: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda request: older.response(handler(older.request(request)))
