"""Components hold what they advertise, also those that fail."""

import dataclasses
from types import SimpleNamespace

import pytest

from cartwheel.component import Component, Scope, Shared
from cartwheel.errors import GraphError
from cartwheel.graph import Graph

CHATTER = "std_msgs/msg/Empty"


class Speaker(Component):
    """Advertises topics in their order."""

    def __init__(self, scope, *topics):
        super().__init__(scope)
        for topic, kind in topics:
            self.advertise(topic, kind)


@pytest.fixture
def graph():
    return Graph()


@pytest.fixture
def scope(graph):
    return Scope(
        part=SimpleNamespace(published=set(), subscribed=set(), services=set()),
        shared=Shared(graph),
        node="n",
        title="t",
        origin=None,
    )


def names(graph):
    return sorted(topic.name for topic in graph.topics() if topic.publishers)


def test_a_device_is_closed_with_its_owner(graph, scope):
    owner = Component(scope)
    owner.add(Speaker(scope, ("/one", CHATTER)))
    assert names(graph) == ["/one"]
    owner.close()
    assert names(graph) == []


def test_a_device_that_cannot_be_created_leaves_nothing_behind(graph, scope):
    owner = Component(scope)
    other = Speaker(dataclasses.replace(scope), ("/taken", "std_msgs/msg/Bool"))
    with pytest.raises(GraphError):
        owner.add(Speaker(scope, ("/one", CHATTER), ("/taken", CHATTER)))
    owner.close()
    assert names(graph) == ["/taken"]
    other.close()
    assert names(graph) == []


def test_a_device_can_be_closed_before_its_owner(graph, scope):
    owner = Component(scope)
    device = owner.add(Speaker(scope, ("/one", CHATTER)))
    owner.advertise("/two", CHATTER)
    device.close()
    assert names(graph) == ["/two"]
    owner.close()
    assert names(graph) == []
