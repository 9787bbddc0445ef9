"""Topics that two models use although each expects to be the only one."""

from __future__ import annotations

import weakref
from collections.abc import Collection, Iterator, Mapping

from cartwheel.codes.graph import TOPICS_SHARED
from cartwheel.errors import Diagnostic
from cartwheel.graph import Graph
from cartwheel.simulation import Part, Simulation

_COMMON = frozenset({"Clock", "DiagnosticArray", "Log", "ParameterEvent", "TFMessage"})
"""Types of topics that all robots share in ROS. Their messages name the robot or the frame."""
_JOINTS = "sensor_msgs/msg/JointState"
"""The messages name the joints, so robots whose joints have different names can share it."""
_LISTED = 6
"""Number of topics that a message names."""


class TopicSharing:
    """Reports models that share topics, once for each pair of names.

    Args:
        graph: The graph.
        simulation: The simulation, whose models are compared at once.
    """

    def __init__(self, graph: Graph, simulation: Simulation) -> None:
        self._graph = graph
        self._simulation = simulation
        self._seen: weakref.WeakSet[Part] = weakref.WeakSet()
        self._reported: set[tuple[str, str]] = set()
        self.report()

    def report(self) -> None:
        """Compares the models that were spawned since the last call with all others."""
        parts = {
            name: resident.part
            for name, resident in self._simulation.population.residents.items()
            if resident.part.published or resident.part.subscribed
        }
        added = {name for name, part in parts.items() if part not in self._seen}
        self._seen.update(parts[name] for name in added)
        if len(parts) < 2 or not added:
            return
        for name, other, warning in shared_topics(parts, added, self._graph):
            if (name, other) not in self._reported:
                self._reported.add((name, other))
                self._simulation.engine.report(warning)


def shared_topics(
    parts: Mapping[str, Part], added: Collection[str], graph: Graph
) -> Iterator[tuple[str, str, Diagnostic]]:
    """Yields each new model, an older one with the same topics, and a warning.

    Topics are shared if both models publish on them or both subscribe to them. A model that
    subscribes to a topic of another one is no mistake. Of a topic that several models share, only
    the oldest one is named.

    Args:
        parts: All models, in the order in which they were spawned.
        added: The new models.
        graph: The graph, for the types of the topics.
    """
    types = {topic.name: topic.type for topic in graph.topics()}
    first: dict[tuple[str, bool], str] = {}
    for name, part in parts.items():
        shared: dict[str, dict[bool, list[str]]] = {}
        for publishes, topics in ((True, part.published), (False, part.subscribed)):
            for topic in sorted(topics):
                # A topic that was closed again has no type.
                kind = types.get(topic, "")
                if not kind or kind.rpartition("/")[2] in _COMMON:
                    continue
                other = first.setdefault((topic, publishes), name)
                if other == name or name not in added:
                    continue
                if kind != _JOINTS or _same_joints(part, parts[other]):
                    shared.setdefault(other, {}).setdefault(publishes, []).append(topic)
        for other, roles in shared.items():
            yield name, other, _warning(name, other, roles, part)


def _same_joints(one: Part, other: Part) -> bool:
    names = ({each.name for each in part.description.joints} for part in (one, other))
    return not set.isdisjoint(*names)


def _warning(name: str, other: str, roles: Mapping[bool, list[str]], part: Part) -> Diagnostic:
    published, subscribed = roles.get(True, []), roles.get(False, [])
    done = [
        f"{verb} {_listed(topics)}"
        for verb, topics in (("publish on", published), ("subscribe to", subscribed))
        if topics
    ]
    return TOPICS_SHARED.diagnostic(
        f'the models "{other}" and "{name}" both {" and ".join(done)}',
        origin=part.description.origin,
        hint=f'Spawn each with a namespace of its own, such as namespace="{name}" in Python or '
        "robot_namespace in a spawn service. It does not apply to names that begin with / in the "
        "description.",
        values={
            "model": name,
            "other": other,
            "published": tuple(published),
            "subscribed": tuple(subscribed),
        },
    )


def _listed(topics: list[str]) -> str:
    more = len(topics) - _LISTED
    shown = topics if more <= 1 else topics[:_LISTED]
    return ", ".join(shown) + (f" and {more} others" if more > 1 else "")
