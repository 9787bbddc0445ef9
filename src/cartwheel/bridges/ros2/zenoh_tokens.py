"""Liveliness tokens, with which rmw_zenoh announces nodes and endpoints.

Source: rmw_zenoh's design document.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.ros2.middleware import Profile

_LONGEST_KEY = 4096
"""Maximum length in characters. The names of a type, a topic and a node have at most 255 each."""
_PARTS = 10
"""Minimum number of parts in an endpoint's key."""


class NodeToken:
    """A node, declared while it has endpoints.

    Args:
        session: Session of Zenoh.
        lead: Prefix of the token's key.
        number: Number of the node in its session.
        name: Full name, with namespace.
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
        """Counts a new endpoint, and declares the node if it is the first."""
        self._endpoints += 1
        if self._endpoints == 1:
            self._token = self.session.liveliness().declare_token(self._key)

    def leave(self) -> None:
        """Removes an endpoint, and undeclares the node if it was the last."""
        self._endpoints -= 1
        if not self._endpoints:
            self._token.undeclare()


class Token:
    """An endpoint, declared until `undeclare`.

    Args:
        node: Node of the endpoint.
        number: Number of the endpoint in its session.
        kind: MP and MS for topics, SS and SC for services.
        name: Name of the topic or service.
        type_: DDS name of the type, and its hash.
        profile: QoS of the endpoint.
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
        """Identifier of the endpoint."""
        node.enter()
        self._token = node.session.liveliness().declare_token(key)

    def undeclare(self) -> None:
        """Undeclares the endpoint."""
        self._token.undeclare()
        self._node.leave()


@dataclass(frozen=True, slots=True)
class Published:
    """A topic with a publisher."""

    session: str
    node: str
    """Node name without its namespace."""
    topic: str


def published(key: str) -> Published | None:
    """Decodes a publisher's token. Returns None for other tokens."""
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
    """QoS as in rmw_zenoh, which omits default values."""
    reliability = "" if profile.reliable else "2"
    durability = "1" if profile.transient_local else ""
    lifespan = f"{profile.lifespan},0" if profile.lifespan else ","
    return f"{reliability}:{durability}:,{profile.depth}:,:{lifespan}:,,"
