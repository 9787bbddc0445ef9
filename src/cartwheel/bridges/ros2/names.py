"""Names of ROS 2 topics, services, nodes and types in DDS and Zenoh.

Source: the design article on topic and service name mapping; rmw_zenoh's design document.
"""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.bridges.ros2.middleware import Endpoint
from cartwheel.messages.ros2.types import Ros2Service, Ros2Type

_LONGEST_KEY = 4096
"""Maximum length in characters. The names of a type, a topic and a node have at most 255 each."""
_PARTS = 10
"""Minimum number of parts in an endpoint's key."""
_LONGEST_TYPE = 100
"""Maximum number of characters of a type's name in a message to the user."""


def split_node(name: str) -> tuple[str, str]:
    """Namespace and base name of a full node name; the root namespace is empty."""
    namespace, _, base = name.rpartition("/")
    return namespace, base


# -- DDS


def dds_topic(topic: str) -> str:
    """DDS topic of a ROS topic."""
    return f"rt{topic}"


def dds_request(service: str) -> str:
    """DDS topic of the requests to a service."""
    return f"rq{service}Request"


def dds_response(service: str) -> str:
    """DDS topic of the responses of a service."""
    return f"rr{service}Reply"


def topic_of(dds: str) -> str:
    """ROS topic of a DDS topic; empty if it is the topic of a service, or not of ROS."""
    return dds[2:] if dds.startswith("rt/") else ""


def service_of(dds: str) -> str:
    """Service to which the requests on a DDS topic are sent; empty for other topics."""
    return dds[2:].removesuffix("Request") if dds.startswith("rq/") else ""


def type_of(dds: str) -> str:
    """ROS name of a DDS type, truncated in case a malicious peer sent it."""
    plain = dds.replace("::dds_::", "::").replace("::", "/").removesuffix("_")
    return plain[:_LONGEST_TYPE]


# -- Zenoh


def zenoh_key(domain: int, name: str, type_: Ros2Type | Ros2Service) -> str:
    """Key for the data of a topic or service."""
    return f"{domain}/{name.strip('/')}/{type_.dds}/{type_.hash}"


def token_prefix(domain: int, session: str = "") -> str:
    """Prefix of the keys of all liveliness tokens, or of those of one session."""
    return "/".join(("@ros2_lv", str(domain), *filter(None, [session])))


def node_token(prefix: str, number: int, node: str) -> str:
    """Key of a node's token.

    Args:
        prefix: See `token_prefix`.
        number: Number of the node in its session.
        node: Full name of the node.
    """
    return f"{prefix}/{number}/{number}/NN/%/{_mangled_node(node)}"


def endpoint_token(
    prefix: str, node: tuple[int, str], number: int, kind: str, endpoint: Endpoint
) -> str:
    """Key of an endpoint's token.

    Args:
        prefix: See `token_prefix`.
        node: Number in the session and full name of the endpoint's node.
        number: Number of the endpoint in its session.
        kind: MP and MS for publishers and subscriptions, SS for services.
        endpoint: The endpoint.
    """
    return (
        f"{prefix}/{node[0]}/{number}/{kind}/%/{_mangled_node(node[1])}/{_mangled(endpoint.name)}/"
        f"{endpoint.type.dds}/{endpoint.type.hash}/{endpoint.profile.zenoh}"
    )


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
    namespace, name = split_node(node)
    return f"{_mangled(namespace)}/{name}"
