"""ROS 2 over Zenoh as in rmw_zenoh: keys, liveliness tokens, attachments, queryables.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2 import names
from cartwheel.bridges.ros2.middleware import Answer, Endpoint, Middleware, Served, ignore
from cartwheel.bridges.ros2.zenoh_session import PORT, open_session
from cartwheel.bridges.ros2.zenoh_tokens import Tokens
from cartwheel.codes.wires import INCOMING_DROPPED, PACKAGE_MISSING, PEER_LIMIT
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.options import RMW

_INSTALL = "pip install 'cartwheel[ros2]'"
_ENDING = 1.0
"""Timeout in s for threads to end."""
_LONGEST_ID = 16
"""Maximum length of a caller's identifier in bytes."""
_TOKENS = 20_000
"""Maximum number of publishers of other nodes."""
_ARRIVALS, _ARRIVING = 2000, 128 << 20
"""Maximum number of messages and calls that wait for the loop, and of their bytes."""


class Zenoh(Middleware):
    """A Zenoh session with one main node; see `Middleware`.

    If no router responds, the session acts as a router.
    """

    def __init__(self, loop: Loop, node: str, warn: Callable[[Diagnostic], None]) -> None:
        try:
            import zenoh
            import zenoh.ext
        except ImportError:
            raise CartwheelError(
                f"{RMW.given('zenoh')} requires Zenoh, which is not installed",
                code=PACKAGE_MISSING,
                hint=_INSTALL,
                values={"package": "eclipse-zenoh", "extra": "ros2"},
            ) from None
        super().__init__(loop, node, warn)
        self.api = zenoh
        """Module of Zenoh."""
        self.session: Any = None
        self._is_router = False
        self._watch: Any = None
        """Subscriber of other nodes' tokens, which ends when it is no longer referenced."""
        self._callers: list[threading.Thread] = []
        """Threads of Zenoh, one for each registered callback."""
        self._others: dict[str, str] = {}
        """Topics that other nodes publish, by token."""
        self.arrivals = Arrivals(loop, warn)

    @property
    def description(self) -> str:
        """See `Middleware`."""
        own = f"with its own router on port {PORT}"
        place = own if self._is_router else "through an external router"
        return f"Zenoh domain {self.domain} {place}"

    def start(self) -> None:
        """Connects to other nodes.

        Raises:
            CartwheelError: No session can be opened, or an environment variable is invalid.
        """
        self.session, self._is_router = open_session(self.api, self.reach)
        self.tokens = Tokens(self.session, self.domain, self.node)
        with self.calling():
            self._watch = self.session.liveliness().declare_subscriber(
                f"{names.token_prefix(self.domain)}/**", self._seen, history=True
            )

    def close(self) -> None:
        """See `Middleware`."""
        if self.session is not None:
            with contextlib.suppress(self.api.ZError):
                self.session.close()
        # The threads end on their own now. A thread that still runs at interpreter shutdown would
        # abort the process.
        deadline = time.monotonic() + _ENDING
        for thread in self._callers:
            thread.join(max(0.0, deadline - time.monotonic()))

    @contextlib.contextmanager
    def calling(self) -> Iterator[None]:
        """Wraps the registration of a callback, and stores the thread that Zenoh starts."""
        before = set(threading.enumerate())
        yield
        begun = [thread for thread in threading.enumerate() if thread not in before]
        self._callers = [each for each in self._callers if each.is_alive()] + begun

    def publish(self, endpoint: Endpoint, on_readers: Callable[[bool], None] = ignore) -> _Outlet:
        """See `Middleware`."""
        return _Outlet(self, endpoint, on_readers)

    def subscribe(self, endpoint: Endpoint, take: Callable[[bytes], None]) -> _Declared:
        """See `Middleware`."""

        def taken(sample: Any) -> None:
            data = sample.payload.to_bytes()
            self.arrivals.post(len(data), lambda: take(data))

        token = self.tokens.add("MS", endpoint)
        declare, options = self.session.declare_subscriber, {}
        if endpoint.profile.transient_local:
            declare = functools.partial(self.api.ext.declare_advanced_subscriber, self.session)
            options = {"history": self.api.ext.HistoryConfig(detect_late_publishers=True)}
        with self.calling():
            subscriber = declare(
                self.key(endpoint), taken, allowed_origin=self.api.Locality.REMOTE, **options
            )
        return _Declared(token, subscriber)

    def serve(self, endpoint: Endpoint, versions: Sequence[Served]) -> _Declared:
        """See `Middleware`. Each version has a queryable, because its hash is part of the key."""
        token = self.tokens.add("SS", endpoint)
        with self.calling():
            queryables = [
                self.session.declare_queryable(
                    names.zenoh_key(self.domain, endpoint.name, one.type),
                    functools.partial(self._asked, one.answer),
                    complete=True,
                )
                for one in versions
            ]
        return _Declared(*queryables, token)

    def topics_of_others(self) -> set[str]:
        """See `Middleware`."""
        return set(self._others.values())

    def key(self, endpoint: Endpoint) -> str:
        """Key for the data of an endpoint."""
        return names.zenoh_key(self.domain, endpoint.name, endpoint.type)

    # -- on a thread of Zenoh

    def _asked(self, answer: Answer, query: Any) -> None:
        data = query.payload.to_bytes() if query.payload is not None else b""
        stamp = query.attachment.to_bytes() if query.attachment is not None else b""
        if not self.arrivals.post(len(data), lambda: take_query(answer, query, data, stamp)):
            query.drop()

    def _seen(self, sample: Any) -> None:
        """Handles a token that appeared or disappeared."""
        key = str(sample.key_expr)
        found = names.published(key)
        own = names.split_node(self.node)[1]
        # Ignore other simulations, because both would stop publishing for each other in turn.
        if found is None or found.session == self.tokens.session_id or found.node == own:
            return
        topic = found.topic
        there = sample.kind == self.api.SampleKind.PUT

        def change() -> None:
            if not there:
                self._others.pop(key, None)
            elif len(self._others) < _TOKENS:
                self._others[key] = topic
            else:
                self.warn(
                    PEER_LIMIT.diagnostic(
                        f"other nodes have more than {_TOKENS} publishers, so additional "
                        "publishers are ignored",
                        values={"most": _TOKENS},
                    )
                )
            self._others_changed()

        self.arrivals.post(len(key), change)


class Arrivals:
    """A bounded queue from Zenoh's threads to the loop's thread.

    Args:
        loop: Event loop on which the functions run.
        warn: Receives warnings.
    """

    def __init__(self, loop: Loop, warn: Callable[[Diagnostic], None]) -> None:
        self._loop = loop
        self._warn = warn
        self._lock = threading.Lock()
        self._count = self._bytes = 0

    def post(self, size: int, function: Callable[[], None]) -> bool:
        """Runs a function on the loop's thread. Returns False if the queue is full.

        Args:
            size: Bytes of data that the function uses.
            function: Function to run.
        """
        with self._lock:
            full = self._count >= _ARRIVALS or (self._count and self._bytes + size > _ARRIVING)
            if not full:
                self._count += 1
                self._bytes += size
        if full:
            self._warn(
                INCOMING_DROPPED.diagnostic(
                    "ROS nodes send messages faster than they can be read, so some messages are "
                    "dropped"
                )
            )
            return False

        def run() -> None:
            with self._lock:
                self._count -= 1
                self._bytes -= size
            function()

        self._loop.post(run)
        return True


class _Declared:
    """Closes Zenoh declarations together with their token."""

    def __init__(self, *declared: Any) -> None:
        self._declared = declared

    def close(self) -> None:
        for one in self._declared:
            one.undeclare()


class _Outlet(_Declared):
    """See `middleware.Outlet`."""

    dropped = 0
    """Zenoh does not report the number of dropped messages."""

    def __init__(
        self, zenoh: Zenoh, endpoint: Endpoint, on_readers: Callable[[bool], None]
    ) -> None:
        self._numbers = itertools.count(1)
        self._closed = False
        token = zenoh.tokens.add("MP", endpoint)
        self._identity = token.identity
        api, profile = zenoh.api, endpoint.profile
        declare, options = zenoh.session.declare_publisher, {}
        if profile.transient_local:
            declare = functools.partial(api.ext.declare_advanced_publisher, zenoh.session)
            cache = api.ext.CacheConfig(max_samples=profile.depth)
            options = {"cache": cache, "publisher_detection": True}
        self._publisher = declare(
            zenoh.key(endpoint),
            # Never wait for subscribers. Messages that a subscriber does not receive are dropped.
            congestion_control=api.CongestionControl.DROP,
            # Local subscribers receive messages through the graph.
            allowed_destination=api.Locality.REMOTE,
            **options,
        )
        super().__init__(self._publisher, token)
        if profile.transient_local:
            # New subscribers request messages from the cache, so it must have content.
            on_readers(True)
            return

        def matched(status: Any) -> None:
            there = bool(status.matching)
            zenoh.loop.post(lambda: None if self._closed else on_readers(there))

        with zenoh.calling():
            self._listener = self._publisher.declare_matching_listener(matched)
        if self._publisher.matching_status.matching:
            on_readers(True)

    def send(self, payload: bytes) -> None:
        if not self._closed:
            stamp = struct.pack("<qqB", next(self._numbers), time.time_ns(), 16)
            self._publisher.put(payload, attachment=stamp + self._identity)

    def close(self) -> None:
        self._closed = True
        super().close()


def take_query(answer: Answer, query: Any, data: bytes, stamp: bytes) -> None:
    """Answers a call, or ends it if its attachment is invalid.

    Args:
        answer: Handler of the service.
        query: Query of Zenoh.
        data: Request.
        stamp: Sequence number of the call, its time, and the caller's identifier after its length
            byte.
    """
    if not 17 <= len(stamp) <= 17 + _LONGEST_ID or len(stamp) != 17 + stamp[16]:
        query.drop()
        return
    (number,) = struct.unpack_from("<q", stamp)

    def reply(response: bytes) -> None:
        attachment = struct.pack("<qq", number, time.time_ns()) + stamp[16:]
        query.reply(query.key_expr, response, attachment=attachment)
        query.drop()

    answer(data, reply)
