"""Where a component acts: its model, its names, and the objects that components share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from cartwheel.errors import Origin
from cartwheel.graph import Graph, TopicRenaming, resolve_frame, resolve_name
from cartwheel.simulation import Part

if TYPE_CHECKING:
    from cartwheel.component.component import Component

T = TypeVar("T")


class Shared:
    """The objects that all components of one simulation share.

    Args:
        graph: The graph on which the components publish.
        renaming: Topics that have different names and types in ROS.
    """

    def __init__(self, graph: Graph, renaming: TopicRenaming | None = None) -> None:
        self.graph = graph
        self.renaming = TopicRenaming() if renaming is None else renaming
        self._objects: dict[type, Any] = {}

    def get(self, kind: type[T]) -> T:
        """Returns the simulation's only object of a class, which is created at first use."""
        if kind not in self._objects:
            self._objects[kind] = kind()
        existing: T = self._objects[kind]
        return existing

    def objects(self) -> Iterator[tuple[str, object]]:
        """Yields the objects that exist, by the names of their classes."""
        for kind, each in self._objects.items():
            yield f"{kind.__module__}.{kind.__qualname__}", each


@dataclass(kw_only=True, slots=True)
class Scope:
    """Where a component acts: its model, and the rules for its names.

    A device has the scope of the plugin or controller that creates it.
    """

    part: Part
    """The model's part of the simulation."""
    shared: Shared
    node: str
    """Node name for listings."""
    title: str
    """Name of the component in messages: ``plugin "libgazebo_ros_imu.so" of model "cart"``."""
    origin: Origin | None
    """File and line at which the component is described."""
    namespace: str = ""
    frame_prefix: str = ""
    remappings: Mapping[str, str] = field(default_factory=dict)
    """New names of topics and services by their names before the remapping."""
    input_name: str = ""
    """Name of the inputs for manual joint positions; empty: the node name."""
    owner: object | None = None
    """The plugin that fails if a callback raises an exception; None: the simulation reports it."""
    common: bool = False
    """Whether its topics are those of the world, so that the components of all models use them."""
    holder: Component | None = field(default=None, init=False)
    """The first component of the scope. It holds the resources of the others, even if one of them
    cannot be created completely."""

    def resolve(self, name: str) -> str:
        """Returns a topic or service name in the namespace, after remapping."""
        if name in self.remappings:
            return resolve_name(self.remappings[name], self.namespace)
        full = resolve_name(name, self.namespace)
        for source, target in self.remappings.items():
            if resolve_name(source, self.namespace) == full:
                return resolve_name(target, self.namespace)
        return full

    def published(self, name: str, type_name: str) -> str:
        """Returns the topic on which messages for a name are published."""
        return self.shared.renaming.published(self.resolve(name), type_name)

    def subscribed(
        self, name: str, type_name: str, callback: Callable[[Any], None]
    ) -> tuple[str, str, Callable[[Any], None]]:
        """Returns the topic, type and callback of a subscription to a name."""
        return self.shared.renaming.read(self.resolve(name), type_name, callback)

    def frame(self, name: str) -> str:
        """Returns a frame ID with the robot's prefix."""
        return resolve_frame(name, self.frame_prefix)

    def place_of(self, parameter: str) -> Origin | None:  # noqa: ARG002
        """Returns the file and line of a parameter; the component's own if it is not stated."""
        return self.origin
