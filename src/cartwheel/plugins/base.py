"""What every plugin is: parameters, names it answers to, and its part of a simulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Generic, TypeVar

from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import Diagnostic, GraphError
from cartwheel.graph import Graph, Publisher, Qos, Service, Subscription, resolve_name
from cartwheel.plugins.parameters import read
from cartwheel.simulation import Part

C = TypeVar("C")


class Plugin(Generic[C]):
    """Base of all plugins; made before the model is compiled, so that it can ask for motors.

    A subclass sets `filenames` and `parameters`, and in `configure` takes its handles,
    advertises its topics and schedules its work. Third parties name theirs under the
    entry point group ``cartwheel.plugins``.
    """

    filenames: ClassVar[tuple[str, ...]]
    """Without ``lib`` and ``.so``: ``gazebo_ros_diff_drive``."""
    parameters: ClassVar[type]
    """A frozen dataclass of `tag` fields."""
    for_sensor: ClassVar[bool] = False
    """Whether it belongs inside a ``<sensor>``."""

    def __init__(self, part: Part, graph: Graph, tag: PluginTag, sensor: Sensor | None) -> None:
        self.part = part
        self.graph = graph
        self.tag = tag
        self.sensor = sensor
        self.config: C
        self.config, diagnostics = read(self.parameters, tag.element)
        for diagnostic in diagnostics:
            part.report(diagnostic)
        ros = tag.element.find("ros/namespace")
        plain = tag.element.find("robotNamespace")
        found = ros or plain
        self.namespace = found.text.strip() if found is not None else ""
        self._remappings = _remappings(tag)
        self._open: list[Publisher | Subscription | Service] = []
        self.configure()

    def configure(self) -> None:
        """Takes handles, advertises, schedules.

        Raises:
            PluginError: Parameters that make no sense.
            UnknownNameError: A link or joint that does not exist.
        """
        raise NotImplementedError

    def reset(self) -> None:
        """Time goes back to zero."""

    def close(self) -> None:
        """The model leaves the world: takes everything off the graph."""
        for item in self._open:
            if isinstance(item, Service):
                self.graph.withdraw(item)
            else:
                item.close()
        self._open.clear()

    def resolve(self, name: str) -> str:
        """A topic or service name in the plugin's namespace, remapped."""
        name = self._remappings.get(name, name)
        return resolve_name(name, self.namespace)

    def advertise(
        self, topic: str, type_name: str, *, rate: float | None = None, qos: Qos = "default"
    ) -> Publisher:
        """A publisher that closes with the plugin."""
        publisher = self.graph.advertise(
            self.resolve(topic), type_name, node=self.node, rate=rate, qos=qos
        )
        self._open.append(publisher)
        return publisher

    def subscribe(self, topic: str, type_name: str, callback: Callable[[Any], None]) -> None:
        """A subscription that closes with the plugin."""
        self._open.append(
            self.graph.subscribe(self.resolve(topic), callback, type_name=type_name, node=self.node)
        )

    def serve(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> None:
        """A service that closes with the plugin; left to another that offers it already.

        Two robots of one kind can share topics, and a service must not keep the second out.
        """
        try:
            service = self.graph.serve(self.resolve(name), type_name, handler, node=self.node)
        except GraphError as error:
            self.warn(f"{error.message}: give one of the two a namespace")
        else:
            self._open.append(service)

    def warn(self, message: str) -> None:
        """Tells the user something about this plugin's tag."""
        self.part.report(Diagnostic(severity="warning", message=message, origin=self.tag.origin))

    @property
    def node(self) -> str:
        """Who publishes, for listings."""
        return f"{self.part.name}/{self.tag.name}" if self.tag.name else self.part.name


def _remappings(tag: PluginTag) -> dict[str, str]:
    ros = tag.element.find("ros")
    pairs = {}
    for remapping in ros.find_all("remapping") if ros else ():
        source, separator, target = remapping.text.strip().partition(":=")
        if separator:
            pairs[source.removeprefix("~/")] = target.removeprefix("~/")
    return pairs
