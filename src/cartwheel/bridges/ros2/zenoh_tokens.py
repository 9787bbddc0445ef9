"""Liveliness tokens, by which rmw_zenoh tells of nodes and endpoints.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.ros2.middleware import Profile

_LONGEST_KEY = 4096
"""Characters; a type, a topic and a node have names of 255 at most."""
_PARTS = 10
"""Of an endpoint's key at least."""


class NodeToken:
    """A node, told of while it has endpoints.

    Args:
        session: Zenoh's.
        lead: Of the token's key.
        number: Of the node in its session.
        name: With its namespace.
    """

    def __init__(self, session: Any, lead: str, number: int, name: str) -> None:
        self.session = session
        self.lead = lead
        self.number = number
        self.name = name
        self._key = f"{lead}/{number}/{number}/NN/%/{_mangled_node(name)}"
        self._token: Any = None
        self._endpoints = 0

    def enter(self) -> None:
        """An endpoint has come."""
        self._endpoints += 1
        if self._endpoints == 1:
            self._token = self.session.liveliness().declare_token(self._key)

    def leave(self) -> None:
        """An endpoint is gone."""
        self._endpoints -= 1
        if not self._endpoints:
            self._token.undeclare()


class Token:
    """An endpoint, told of until it is undeclared.

    Args:
        node: Whose it is.
        number: Of the endpoint in its session.
        kind: MP and MS of topics, SS and SC of services.
        name: Of the topic or service.
        type_: Its name in DDS, and its hash.
        profile: How it is sent.
    """

    def __init__(
        self,
        node: NodeToken,
        number: int,
        *,
        kind: str,
        name: str,
        type_: tuple[str, str],
        profile: Profile,
    ) -> None:
        dds, hash_ = type_
        key = (
            f"{node.lead}/{node.number}/{number}/{kind}/%/{_mangled_node(node.name)}/"
            f"{_mangled(name)}/{dds}/{hash_}/{_qos(profile)}"
        )
        self._node = node
        self.identity = hashlib.md5(key.encode(), usedforsecurity=False).digest()
        """What it is known by."""
        node.enter()
        self._token = node.session.liveliness().declare_token(key)

    def undeclare(self) -> None:
        """It is gone."""
        self._token.undeclare()
        self._node.leave()


@dataclass(frozen=True, slots=True)
class Published:
    """A topic that somebody publishes."""

    session: str
    node: str
    """Its name without its namespace."""
    topic: str


def published(key: str) -> Published | None:
    """What a token's key tells of a publisher; None where it is something else's."""
    parts = key.split("/")
    if len(key) > _LONGEST_KEY or len(parts) < _PARTS or parts[5] != "MP":
        return None
    return Published(session=parts[2], node=parts[8], topic=parts[9].replace("%", "/"))


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def _mangled_node(node: str) -> str:
    namespace, _, name = node.rpartition("/")
    return f"{_mangled(namespace)}/{name}"


def _qos(profile: Profile) -> str:
    """A profile as rmw_zenoh writes it: what is as usual is left out."""
    reliability = "" if profile.reliable else "2"
    durability = "1" if profile.transient_local else ""
    lifespan = f"{profile.lifespan},0" if profile.lifespan else ","
    return f"{reliability}:{durability}:,{profile.depth}:,:{lifespan}:,,"
