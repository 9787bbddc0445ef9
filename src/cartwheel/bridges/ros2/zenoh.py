"""ROS 2 over Zenoh as in rmw_zenoh: keys, liveliness tokens, attachments, queryables.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import json
import os
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.bridges.ros2.middleware import Answer, Profile, Served
from cartwheel.bridges.ros2.zenoh_tokens import NodeToken, Token, published
from cartwheel.codes.wires import INCOMING_DROPPED, PACKAGE_MISSING, PEER_LIMIT, ZENOH_NOT_OPENED
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.messages.ros2.types import Ros2Type
from cartwheel.options import RMW

PORT = 7447
"""Port of the Zenoh router. If no router responds there, the session listens on it."""
_INSTALL = "pip install 'cartwheel[ros2]'"
_ENDING = 1.0
"""Timeout in s for threads to end."""
_LONGEST_ID = 16
"""Maximum length of a caller's identifier in bytes."""
_TOKENS = 20_000
"""Maximum number of publishers of other nodes."""
_GATHER = 0.03
"""Delay in s during which changes of other nodes are collected."""
_ARRIVALS, _ARRIVING = 2000, 128 << 20
"""Maximum number of messages and calls that wait for the loop, and of their bytes."""
_NOTICE = 0.5
"""Timeout in s for a router to respond."""


class Zenoh:
    """A Zenoh session with one main node. If no router responds, the session acts as a router.

    Args:
        loop: Event loop of the bridge.
        node: Name of the node.
        namespace: Namespace of the node.
        tell: Receives warnings.

    Raises:
        CartwheelError: Zenoh is not installed, or an environment variable is invalid.
    """

    def __init__(
        self, loop: Loop, *, node: str, namespace: str, tell: Callable[[Diagnostic], None]
    ) -> None:
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
        self._zenoh = zenoh
        self.loop = loop
        self._node = node
        self._name = f"{namespace.rstrip('/')}/{node}"
        self._tell = tell
        self._domain = domain_id()
        self._reach = discovery_range()
        self._is_router = False
        self._session: Any = None
        self._zid = ""
        self._lead = ""
        """Prefix of all token keys."""
        self._nodes: dict[str, NodeToken] = {}
        self._entities = itertools.count(1)
        self._kept: list[Any] = []
        self._callers: list[threading.Thread] = []
        """Threads of Zenoh, one for each registered callback."""
        self._others: dict[str, str] = {}
        """Topics that other nodes publish, by token."""
        self._told_due = False
        self.on_others: Callable[[], None] = lambda: None
        self.arrivals = Arrivals(loop, tell)

    @property
    def description(self) -> str:
        """Description of the middleware and its domain."""
        place = (
            (f"with its own router on port {PORT}")
            if self._is_router
            else ("through an external router")
        )
        return f"Zenoh domain {self._domain} {place}"

    def start(self) -> None:
        """Connects to other nodes.

        Raises:
            CartwheelError: No session can be opened.
        """
        zenoh = self._zenoh
        try:
            self._session = zenoh.open(self._configuration())
        except zenoh.ZError as error:
            raise CartwheelError(
                f"Zenoh cannot open a session: {error}", code=ZENOH_NOT_OPENED
            ) from None
        self._zid = str(self._session.zid())
        self._lead = f"@ros2_lv/{self._domain}/{self._zid}"
        # The main node exists even without endpoints.
        self._nodes[self._name] = main = NodeToken(self._session, self._lead, 0, self._name)
        main.enter()
        with self.calling():
            self._kept.append(
                self._session.liveliness().declare_subscriber(
                    f"@ros2_lv/{self._domain}/**", self._seen, history=True
                )
            )

    def close(self) -> None:
        """Disconnects."""
        if self._session is not None:
            with contextlib.suppress(self._zenoh.ZError):
                self._session.close()
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

    def publish(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        on_readers: Callable[[bool], None],
        *,
        node: str = "",
    ) -> _Outlet:
        """See `Middleware`."""
        return _Outlet(self, topic, type_, profile, on_readers, node=node)

    def subscribe(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        take: Callable[[bytes], None],
        *,
        node: str = "",
    ) -> _Declared:
        """See `Middleware`."""

        def taken(sample: Any) -> None:
            data = sample.payload.to_bytes()
            self.arrivals.post(len(data), lambda: take(data))

        token = self.token("MS", topic, type_.dds, type_.hash, profile, node=node)
        key = self.key(topic, type_.dds, type_.hash)
        with self.calling():
            if profile.transient_local:
                subscriber: Any = self._zenoh.ext.declare_advanced_subscriber(
                    self._session,
                    key,
                    taken,
                    allowed_origin=self._zenoh.Locality.REMOTE,
                    history=self._zenoh.ext.HistoryConfig(detect_late_publishers=True),
                )
            else:
                subscriber = self._session.declare_subscriber(
                    key, taken, allowed_origin=self._zenoh.Locality.REMOTE
                )
        return _Declared(token, subscriber)

    def serve(self, name: str, served: Sequence[Served], *, depth: int, node: str = "") -> _Service:
        """See `Middleware`."""
        return _Service(self, name, served, Profile(depth=depth), node=node)

    def topics_of_others(self) -> set[str]:
        """See `Middleware`."""
        return set(self._others.values())

    # -- names

    def key(self, name: str, dds: str, hash_: str) -> str:
        """Key for the data of a topic or service."""
        return f"{self._domain}/{name.strip('/')}/{dds}/{hash_}"

    def token(
        self, kind: str, name: str, dds: str, hash_: str, profile: Profile, *, node: str
    ) -> Token:
        """Declares an endpoint to other nodes, and its node with the first endpoint."""
        node = node or self._name
        if node not in self._nodes:
            self._nodes[node] = NodeToken(self._session, self._lead, next(self._entities), node)
        return Token(
            self._nodes[node],
            next(self._entities),
            kind=kind,
            name=name,
            type_=(dds, hash_),
            profile=profile,
        )

    def _seen(self, sample: Any) -> None:
        """Handles a token that appeared or disappeared. Called on a thread of Zenoh."""
        key = str(sample.key_expr)
        found = published(key)
        # Ignore other simulations, because both would stop publishing for each other in turn.
        if found is None or found.session == self._zid or found.node == self._node:
            return
        topic = found.topic
        there = sample.kind == self._zenoh.SampleKind.PUT

        def change() -> None:
            if not there:
                self._others.pop(key, None)
            elif len(self._others) < _TOKENS:
                self._others[key] = topic
            else:
                self._tell(
                    PEER_LIMIT.diagnostic(
                        f"other nodes have more than {_TOKENS} publishers, so additional "
                        "publishers are ignored",
                        values={"most": _TOKENS},
                    )
                )
            if not self._told_due:
                self._told_due = True
                self.loop.after(_GATHER, self._tell_of_others)

        self.arrivals.post(len(key), change)

    def _tell_of_others(self) -> None:
        self._told_due = False
        self.on_others()

    # -- the session

    def _configuration(self) -> Any:
        uri = os.environ.get("ZENOH_SESSION_CONFIG_URI")
        if uri:
            try:
                made = self._zenoh.Config.from_file(uri)
            except self._zenoh.ZError as error:
                raise CartwheelError(
                    f"ZENOH_SESSION_CONFIG_URI refers to {uri}, which cannot be used: {error}",
                    code=ZENOH_NOT_OPENED,
                    values={"variable": "ZENOH_SESSION_CONFIG_URI", "value": uri},
                ) from None
        else:
            made = self._own_configuration()
        for pair in os.environ.get("ZENOH_CONFIG_OVERRIDE", "").split(";"):
            if not pair.strip():
                continue
            name, _, value = pair.partition("=")
            try:
                made.insert_json5(name.strip(), value.strip())
            except self._zenoh.ZError as error:
                raise CartwheelError(
                    f"ZENOH_CONFIG_OVERRIDE contains {pair}, which cannot be used: {error}",
                    code=ZENOH_NOT_OPENED,
                    values={"variable": "ZENOH_CONFIG_OVERRIDE", "value": pair},
                ) from None
        return made

    def _own_configuration(self) -> Any:
        made = self._zenoh.Config()
        self._is_router = not _answers(PORT)
        if self._is_router:
            host = "[::]" if self._reach.range == "SUBNET" else "127.0.0.1"
            settings: dict[str, Any] = {
                "mode": "router",
                "listen/endpoints": [f"tcp/{host}:{PORT}"],
                "connect/endpoints": [f"tcp/{peer}:{PORT}" for peer in self._reach.peers],
            }
        else:
            settings = {
                "mode": "peer",
                "listen/endpoints": ["tcp/127.0.0.1:0"],
                "connect/endpoints": [f"tcp/127.0.0.1:{PORT}"],
            }
        settings["scouting/multicast/enabled"] = False
        settings["timestamping/enabled"] = True
        for name, value in settings.items():
            made.insert_json5(name, json.dumps(value))
        return made


class Arrivals:
    """A bounded queue from Zenoh's threads to the loop's thread.

    Args:
        loop: Event loop on which the functions run.
        tell: Receives warnings.
    """

    def __init__(self, loop: Loop, tell: Callable[[Diagnostic], None]) -> None:
        self._loop = loop
        self._tell = tell
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
            self._tell(
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


class _Outlet:
    """See `middleware.Outlet`."""

    def __init__(
        self,
        zenoh: Zenoh,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        on_readers: Callable[[bool], None],
        *,
        node: str,
    ) -> None:
        self._loop = zenoh.loop
        self._numbers = itertools.count(1)
        self._token = zenoh.token("MP", topic, type_.dds, type_.hash, profile, node=node)
        key = zenoh.key(topic, type_.dds, type_.hash)
        api, session = zenoh._zenoh, zenoh._session
        # Never wait for subscribers. Messages that a subscriber does not receive are dropped.
        drop = api.CongestionControl.DROP
        # Local subscribers receive messages through the graph.
        others = api.Locality.REMOTE
        self._closed = False
        if profile.transient_local:
            self._publisher = api.ext.declare_advanced_publisher(
                session,
                key,
                congestion_control=drop,
                allowed_destination=others,
                cache=api.ext.CacheConfig(max_samples=profile.depth),
                publisher_detection=True,
            )
            # New subscribers request messages from the cache, so it must have content.
            on_readers(True)
            return
        self._publisher = session.declare_publisher(
            key, congestion_control=drop, allowed_destination=others
        )

        def matched(status: Any) -> None:
            there = bool(status.matching)
            self._loop.post(lambda: None if self._closed else on_readers(there))

        with zenoh.calling():
            self._listener = self._publisher.declare_matching_listener(matched)
        if self._publisher.matching_status.matching:
            on_readers(True)

    @property
    def dropped(self) -> int:
        # Zenoh does not report the number of dropped messages.
        return 0

    def send(self, payload: bytes) -> None:
        if not self._closed:
            stamp = struct.pack("<qqB", next(self._numbers), time.time_ns(), 16)
            self._publisher.put(payload, attachment=stamp + self._token.identity)

    def close(self) -> None:
        self._closed = True
        self._publisher.undeclare()
        self._token.undeclare()


class _Service:
    """A queryable for each version of the type, whose hash is part of the key, and one token."""

    def __init__(
        self, zenoh: Zenoh, name: str, served: Sequence[Served], profile: Profile, *, node: str
    ) -> None:
        self._zenoh = zenoh
        newest = served[0].type
        self._token = zenoh.token("SS", name, newest.dds, newest.hash, profile, node=node)
        with zenoh.calling():
            self._queryables = [
                zenoh._session.declare_queryable(
                    zenoh.key(name, one.type.dds, one.type.hash),
                    functools.partial(self._asked, one.answer),
                    complete=True,
                )
                for one in served
            ]

    def close(self) -> None:
        for queryable in self._queryables:
            queryable.undeclare()
        self._token.undeclare()

    def _asked(self, answer: Answer, query: Any) -> None:
        """Called on a thread of Zenoh."""
        data = query.payload.to_bytes() if query.payload is not None else b""
        stamp = query.attachment.to_bytes() if query.attachment is not None else b""
        if not self._zenoh.arrivals.post(len(data), lambda: take_query(answer, query, data, stamp)):
            query.drop()


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


def _answers(port: int) -> bool:
    try:
        with socket.create_connection(("127.0.0.1", port), _NOTICE):
            return True
    except OSError:
        return False
