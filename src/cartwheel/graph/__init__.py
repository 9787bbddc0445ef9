"""Topics and services in process."""

from cartwheel.graph.graph import (
    Callback,
    Graph,
    Publisher,
    Qos,
    Service,
    Subscription,
    TopicInfo,
    resolve_name,
)
from cartwheel.graph.mailbox import Mailbox

__all__ = [
    "Callback",
    "Graph",
    "Mailbox",
    "Publisher",
    "Qos",
    "Service",
    "Subscription",
    "TopicInfo",
    "resolve_name",
]
