"""Offers the topics, services and robot descriptions of a graph on a Foxglove server."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.foxglove.incoming import offered
from cartwheel.bridges.foxglove.log import Log
from cartwheel.bridges.foxglove.publication import READER, Publication
from cartwheel.bridges.mirror import offered_by_others
from cartwheel.bridges.rosout import TOPIC as LOG
from cartwheel.codes.wires import TYPE_UNSUPPORTED
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.graph import Service, TopicInfo

_CHANGES = 64
"""Maximum number of channels that are opened and closed at a time. The library disconnects
every client for which more than `bridge.BACKLOG` notifications of such changes are queued."""
_STRING = "std_msgs/msg/String"


class Mirror:
    """Makes a server offer what a graph offers. Used on the bridge's thread, after `start`.

    Args:
        graph: Graph of the simulation.
        time_ns: Simulation time.
        wake: Called with a topic that has a message to send, on any thread.
        again: Makes the bridge call `update` again soon.
        described: Called with the topic of a changed robot description, on any thread.
        warn: Receives warnings.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        *,
        time_ns: Callable[[], int],
        wake: Callable[[str], None],
        again: Callable[[], None],
        described: Callable[[str], None],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._graph = graph
        self._time_ns = time_ns
        self._wake = wake
        self._again = again
        self._described = described
        self._warn = warn
        self._server: Any = None
        self._context: Any = None
        self.publications: dict[str, Publication] = {}
        """By topic."""
        self.by_channel: dict[int, Publication | Log] = {}
        self.descriptions: dict[str, str] = {}
        """Robot descriptions by topic."""
        self._services: dict[str, Service] = {}
        self._watched: dict[str, BridgedSubscription] = {}

    def start(self, server: Any, context: Any, log: Log) -> None:
        """Starts with a server, its context, and the channel of the log."""
        self._server, self._context = server, context
        self.by_channel[log.channel.id()] = log

    def close(self) -> None:
        """Closes all subscriptions and channels, except the log's."""
        for subscription in self._watched.values():
            subscription.close()
        for publication in self.publications.values():
            publication.close()

    def update(self) -> None:
        """Makes the server offer what the graph offers, a limited number of changes at a time."""
        topics = offered_by_others(self._graph, READER)
        topics.pop(LOG, None)  # The bridge provides this topic itself.
        services = {service.name: service for service in self._graph.services()}
        self._mirror_topics(topics)
        self._mirror_descriptions(topics)
        self._mirror_services(services)
        self._publish_connections(topics, services)

    def _mirror_topics(self, topics: dict[str, TopicInfo]) -> None:
        """Opens and closes channels, at most `_CHANGES` at a time."""
        changes = 0
        for name, publication in list(self.publications.items()):
            if name in topics and topics[name].type == publication.info.type:
                publication.latched = topics[name].qos == "latched"
            elif changes < _CHANGES:
                changes += 1
                del self.publications[name]
                del self.by_channel[publication.channel.id()]
                publication.close()
        for name, info in topics.items():
            if name not in self.publications and changes < _CHANGES:
                changes += 1
                publication = Publication(
                    self._graph,
                    info,
                    context=self._context,
                    time_ns=self._time_ns,
                    wake=partial(self._wake, name),
                    warn=self._warn,
                )
                self.publications[name] = publication
                self.by_channel[publication.channel.id()] = publication
        if changes == _CHANGES:
            # More changes may remain.
            self._again()

    def _mirror_descriptions(self, topics: dict[str, TopicInfo]) -> None:
        """Subscribes to topics with robot descriptions, which are also offered as parameters."""
        described = {
            name
            for name, info in topics.items()
            if info.type == _STRING and name.endswith("robot_description") and info.publishers
        }
        for name in set(self._watched) - described:
            self._watched.pop(name).close()
            self.descriptions.pop(name, None)
        for name in described - set(self._watched):
            self._watched[name] = self._graph.subscribe(name, self._describer(name), node=READER)

    def _describer(self, name: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            self.descriptions[name] = message.data
            self._described(name)

        return take

    def _mirror_services(self, services: dict[str, Service]) -> None:
        gone = [name for name, one in self._services.items() if services.get(name) is not one]
        if gone:
            self._server.remove_services(gone)
            for name in gone:
                del self._services[name]
        made = []
        for name, service in services.items():
            if name not in self._services:
                try:
                    made.append(offered(self._graph, service, self._warn))
                except CartwheelError as error:
                    self._warn(
                        TYPE_UNSUPPORTED.because(
                            f"service {name} is not available to Foxglove",
                            error,
                            values={"service": name},
                        )
                    )
                self._services[name] = service
        if made:
            self._server.add_services(made)

    def _publish_connections(
        self, topics: dict[str, TopicInfo], services: dict[str, Service]
    ) -> None:
        import foxglove

        graph = foxglove.ConnectionGraph()
        for info in topics.values():
            if info.publishers:
                graph.set_published_topic(info.name, sorted(set(info.publishers)))
            if info.subscribers:
                graph.set_subscribed_topic(info.name, sorted(set(info.subscribers)))
        for service in services.values():
            graph.set_advertised_service(service.name, [service.node])
        self._server.publish_connection_graph(graph)
