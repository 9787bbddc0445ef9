"""Liveliness tokens, with which rmw_zenoh announces nodes and endpoints.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import hashlib
import itertools
from typing import Any

from cartwheel.bridges.ros2 import names
from cartwheel.bridges.ros2.middleware import Endpoint


class Tokens:
    """The tokens of a session. The main node exists also without endpoints.

    Args:
        session: Session of Zenoh.
        domain: ROS domain ID.
        node: Full name of the main node.
    """

    def __init__(self, session: Any, domain: int, node: str) -> None:
        self._session = session
        self.session_id = str(session.zid())
        self.prefix = names.token_prefix(domain, self.session_id)
        self._main = node
        self._numbers = itertools.count(1)
        self._nodes = {node: _NodeToken(self, 0, node)}
        self._nodes[node].enter()

    def add(self, kind: str, endpoint: Endpoint) -> Token:
        """Declares an endpoint to other nodes, and its node with the first endpoint.

        Args:
            kind: MP and MS for publishers and subscriptions, SS for services.
            endpoint: The endpoint.
        """
        node = endpoint.node or self._main
        if node not in self._nodes:
            self._nodes[node] = _NodeToken(self, next(self._numbers), node)
        return Token(self._nodes[node], next(self._numbers), kind, endpoint)

    def declare(self, key: str) -> Any:
        """Declares a token of Zenoh, which exists until its `undeclare`."""
        return self._session.liveliness().declare_token(key)


class _NodeToken:
    """A node, declared while it has endpoints."""

    def __init__(self, tokens: Tokens, number: int, name: str) -> None:
        self.tokens = tokens
        self.number = number
        self.name = name
        self._token: Any = None
        self._endpoints = 0

    def enter(self) -> None:
        """Counts a new endpoint, and declares the node if it is the first."""
        self._endpoints += 1
        if self._endpoints == 1:
            key = names.node_token(self.tokens.prefix, self.number, self.name)
            self._token = self.tokens.declare(key)

    def leave(self) -> None:
        """Removes an endpoint, and undeclares the node if it was the last."""
        self._endpoints -= 1
        if not self._endpoints:
            self._token.undeclare()


class Token:
    """An endpoint, declared until `undeclare`. Created by `Tokens.add`."""

    def __init__(self, node: _NodeToken, number: int, kind: str, endpoint: Endpoint) -> None:
        key = names.endpoint_token(
            node.tokens.prefix, (node.number, node.name), number, kind, endpoint
        )
        self._node = node
        self.identity = hashlib.md5(key.encode(), usedforsecurity=False).digest()
        """Identifier of the endpoint."""
        node.enter()
        self._token = node.tokens.declare(key)

    def undeclare(self) -> None:
        """Undeclares the endpoint."""
        self._token.undeclare()
        self._node.leave()
