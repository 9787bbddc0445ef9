"""Services: decodes requests, calls handlers, and encodes responses."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.mirror import Closable
from cartwheel.bridges.ros2.middleware import Endpoint, Middleware, Reply, Served
from cartwheel.bridges.ros2.qos import CALLS, Profile
from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.codes.wires import CALL_LIMIT, MALFORMED_MESSAGE
from cartwheel.errors import Diagnostic, GraphError, one_line
from cartwheel.messages import decode_cdr, encode_cdr, zero
from cartwheel.messages.ros2.types import Ros2Service, ros2_service
from cartwheel.messages.ros2.versions import OlderService, older_versions

_MOST_CALLS = 32
"""Maximum number of simultaneous calls."""

Respond = Callable[[Any], None]
"""Encodes and sends a response. Callable on any thread."""
Handler = Callable[[Any, Respond], None]
"""Handles a request, and responds at once or later. Called on the loop's thread."""


class Services:
    """Offers services. Used on the loop's thread.

    Args:
        loop: Event loop of the bridge.
        middleware: Middleware to offer services on.
        warn: Receives warnings.
    """

    def __init__(
        self, loop: Loop, middleware: Middleware, warn: Callable[[Diagnostic], None]
    ) -> None:
        self._loop = loop
        self._middleware = middleware
        self._warn = warn
        self._calls = 0

    def offer(
        self,
        name: str,
        type_name: str,
        function: Callable[[Any], Any],
        *,
        threaded: bool = False,
        depth: int = CALLS,
        node: str = "",
    ) -> Closable:
        """Offers a service that a function implements.

        Args:
            name: Service name.
            type_name: ``pkg/srv/Name``.
            function: Takes a request, and returns the response or raises.
            threaded: Whether the function may be slow, and so runs on a separate thread per call.
            depth: Queue depth for requests, and for responses.
            node: See `Endpoint.node`.
        """
        versions = [
            (ros2_service(type_name), function),
            *((older.type, _for_older(older, function)) for older in older_versions(type_name)),
        ]
        handlers = [
            self._served(name, type_, self._handler(name, type_, each, threaded=threaded))
            for type_, each in versions
        ]
        return self._serve(name, handlers, depth, node)

    def offer_deferred(
        self, name: str, type_name: str, handler: Handler, *, node: str = ""
    ) -> Closable:
        """Offers a service whose handler may respond later, without a waiting thread."""
        served = self._served(name, ros2_service(type_name), handler)
        return self._serve(name, [served], CALLS, node)

    def _serve(self, name: str, versions: list[Served], depth: int, node: str) -> Closable:
        profile = Profile(depth=depth)
        endpoint = Endpoint(name=name, type=versions[0].type, profile=profile, node=node)
        return self._middleware.serve(endpoint, versions)

    def _served(self, name: str, type_: Ros2Service, handler: Handler) -> Served:
        def answer(data: bytes, reply: Reply) -> None:
            try:
                request = decode_cdr(data, type_.request)
            except GraphError as error:
                self._warn(
                    MALFORMED_MESSAGE.because(
                        f"malformed request to {name}", error, values={"service": name}
                    )
                )
                return
            handler(request, lambda response: respond(encode_cdr(response), reply))

        def respond(data: bytes, reply: Reply) -> None:
            self._loop.post(lambda: reply(data))

        return Served(type_, answer)

    def _handler(
        self, name: str, type_: Ros2Service, function: Callable[[Any], Any], *, threaded: bool
    ) -> Handler:
        def call(request: Any, respond: Respond) -> None:
            try:
                respond(function(request))
            except Exception as error:  # noqa: BLE001 - the client waits for a response
                respond(self._failure(name, type_, error))

        if threaded:
            return lambda request, respond: self._in_thread(lambda: call(request, respond), name)
        return call

    def _in_thread(self, function: Callable[[], None], name: str) -> None:
        if self._calls >= _MOST_CALLS:
            self._warn(
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
        self._warn(SERVICE_FAILED.because(f"{name} failed", error, values={"service": name}))
        return response


def _for_older(older: OlderService, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda request: older.response(function(older.request(request)))
