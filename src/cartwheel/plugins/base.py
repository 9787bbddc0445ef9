"""What every plugin is: parameters, names it answers to, and its part of a simulation."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from cartwheel import errors
from cartwheel.codes import running
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import Code, GraphError, Origin, Severity
from cartwheel.graph import (
    Graph,
    JointInput,
    Publisher,
    Qos,
    ReconfigureParameter,
    ReconfigureServer,
    resolve_frame,
    resolve_name,
)
from cartwheel.graph.reconfigure import OnChange, Value
from cartwheel.plugins.gz_bridge import GzBridge
from cartwheel.plugins.inputs import obeyable, obeyable_positions
from cartwheel.plugins.parameters import SMALLEST, invalid, read
from cartwheel.simulation import LinkHandle, Part
from cartwheel.simulation.limits import FARTHEST


class Closable(Protocol):
    """What a plugin holds while it lives."""

    def close(self) -> None:
        """Ends it."""


C = TypeVar("C")
K = TypeVar("K", bound=Closable)


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
    sensor_type: ClassVar[str] = ""
    """Usual type of that sensor, shown in its documentation. Empty if `serves` is set."""
    for_world: ClassVar[bool] = False
    """Whether it belongs directly inside a ``<world>``; its part is then the world's own."""
    empty_is_model: ClassVar[bool] = False
    """Whether an empty ``<robotNamespace>`` is the model's name; for others it is none."""
    prefixes_by_namespace: ClassVar[bool] = False
    """Whether its frames have the namespace before them where there is no tf_prefix."""
    serves: ClassVar[tuple[str, ...]] = ()
    """Types of sensors that it makes work without a ``<plugin>``, as new Gazebo's systems do.

    Its parameters are then read from the ``<sensor>`` itself.
    """

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
        # As Gazebo does: what the tag says counts, and else what the spawner said.
        self.namespace = part.namespace.rstrip("/")
        self._frame_prefix = part.frame_prefix
        if ros is not None:
            self.namespace = ros.text.strip()
        elif plain is not None:
            self.namespace = plain.text.strip() or (part.name if self.empty_is_model else "")
        if ros is None and self.prefixes_by_namespace and not self._frame_prefix:
            self._frame_prefix = self.namespace
        self._remappings = _remappings(tag)
        self._open = contextlib.ExitStack()
        self._crowded = False
        try:
            self.configure()
        except Exception:
            # A subclass's own close counts on what it did not come to.
            Plugin.close(self)
            raise

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
        self._open.close()

    def keep(self, item: K) -> K:
        """What is to be closed with the plugin."""
        self._open.callback(item.close)
        return item

    def under_model(self) -> None:
        """Takes the model's name for a namespace where neither the tag nor the spawner says one.

        Most of Gazebo's plugins take none then.
        """
        element = self.tag.element
        told = element.find("robotNamespace") or element.find("ros")
        if told is None and not self.part.namespace:
            self.namespace = self.part.name

    def resolve(self, name: str) -> str:
        """A topic or service name in the plugin's namespace, remapped."""
        if name in self._remappings:
            return resolve_name(self._remappings[name], self.namespace)
        full = resolve_name(name, self.namespace)
        for source, target in self._remappings.items():
            if resolve_name(source, self.namespace) == full:
                return resolve_name(target, self.namespace)
        return full

    def remaps(self, name: str) -> bool:
        """Whether the tag gives that private name (``~/out`` is ``out``) another."""
        return name in self._remappings

    def frame(self, name: str) -> str:
        """A frame's name with the robot's prefix."""
        return resolve_frame(name, self._frame_prefix)

    def advertise(
        self, topic: str, type_name: str, *, rate: float | None = None, qos: Qos = "default"
    ) -> Publisher:
        """A publisher that closes with the plugin."""
        name = GzBridge.of(self.graph).published(self.resolve(topic), type_name)
        return self.keep(self.graph.advertise(name, type_name, node=self.node, rate=rate, qos=qos))

    def subscribe(self, topic: str, type_name: str, callback: Callable[[Any], None]) -> None:
        """A subscription that closes with the plugin.

        Messages with a number that nobody can obey, such as NaN, are ignored, with a warning.
        """
        callback = obeyable(callback, self.part, self.warn)
        bridge = GzBridge.of(self.graph)
        name, kind, taker = bridge.read(self.resolve(topic), type_name, callback)
        subscription = self.graph.subscribe(name, taker, type_name=kind, node=self.node)
        subscription.on_error = lambda _, error: self.part.fail(self, error)
        self.keep(subscription)

    def serve(
        self,
        name: str,
        type_name: str,
        handler: Callable[[Any], Any],
        *,
        threaded: bool = False,
    ) -> bool:
        """A service that closes with the plugin; left to another that offers it already.

        Two robots of one kind can share topics, and a service must not keep the second out.

        Returns:
            Whether it is offered.
        """
        try:
            service = self.graph.serve(
                self.resolve(name), type_name, handler, node=self.node, threaded=threaded
            )
        except GraphError as error:
            if not self._crowded:
                # Plugins that share one name share most: one warning is enough.
                self._crowded = True
                self.warn(
                    running.SERVICE_TAKEN,
                    error.message,
                    hint="Give one of the two models a namespace.",
                    values={"name": self.resolve(name)},
                )
            return False
        self._open.callback(self.graph.withdraw, service)
        return True

    def take_positions(
        self, joints: Sequence[str], put: Callable[[Mapping[str, float], float], None]
    ) -> None:
        """Takes positions for joints by hand too, while the plugin lives; see `JointInput`."""
        inputs = self.graph.joint_inputs
        made = JointInput(
            model=self.part.name,
            owner=self.tag.name or self.node,
            joints=tuple(joints),
            put=obeyable_positions(put, self.part),
        )
        inputs.add(made)
        self._open.callback(inputs.remove, made)

    def reconfigure(
        self,
        name: str,
        parameters: tuple[ReconfigureParameter, ...],
        on_change: OnChange,
        *,
        initial: Mapping[str, Value] | None = None,
        preset: bool = False,
    ) -> ReconfigureServer | None:
        """Parameters to be set while it runs, as `ReconfigureServer` has them.

        None where another offers them already, or where a preset value makes no sense.
        """
        full = self.resolve(name)
        try:
            server = ReconfigureServer(
                self.graph,
                full,
                parameters,
                on_change,
                node=self.node,
                initial=initial,
                preset=preset,
            )
        except GraphError as error:
            self.warn(
                running.RECONFIGURE_UNAVAILABLE,
                f"{error.message}, so {full} cannot be reconfigured",
                hint=error.hint or "",
                values={"name": full},
            )
            return None
        return self.keep(server)

    def warn(
        self,
        code: Code,
        message: str,
        *,
        at: Origin | None = None,
        hint: str = "",
        values: Mapping[str, errors.Value] | None = None,
        severity: Severity = "warning",
    ) -> None:
        """Reports something about this plugin.

        Args:
            code: Its kind. Plugins of other packages make their own: ``Code("ACME1", …)``.
            message: One sentence.
            at: The element that it is about; by default the plugin's tag.
            hint: The likely fix, as a sentence.
            values: What the message names, for programs.
            severity: By default a warning, whatever the code's is.
        """
        self.part.report(
            code.diagnostic(
                message,
                origin=at or self.tag.origin,
                hint=hint,
                values=values,
                severity=severity,
            )
        )

    def link_or_root(self, name: str) -> LinkHandle:
        """The link of that name; the root where it is a frame's and no link's."""
        description = self.part.description
        known = description.link(name) is not None
        return self.part.link(name if known else description.canonical_link)

    def check_above_zero(self, **values: float) -> None:
        """Refuses parameters, given by the names of their tags.

        Raises:
            PluginError: One is 0 or below, or so small that nothing can be divided by it.
        """
        for name, value in values.items():
            if value < SMALLEST:
                least = "positive" if value <= 0 else f"at least {SMALLEST:g}"
                raise invalid(name, value, least, self.place_of(name))

    def check_not_negative(self, *names: str) -> None:
        """Refuses parameters below 0, given by the names of their fields, of those that it has.

        Vectors are allowed: each of their numbers counts.

        Raises:
            PluginError: One of them is.
        """
        fields = {each.name: each for each in dataclasses.fields(self.parameters)}
        for name in names:
            value = getattr(self.config, name, 0.0)
            numbers = value if isinstance(value, tuple) else (value,)
            least = min((each for each in numbers if each is not None), default=0.0)
            if least < 0:
                tags: tuple[str, ...] = fields[name].metadata["tags"]
                written = (each for each in tags if self.tag.element.find(each) is not None)
                tag = next(written, tags[0])
                raise invalid(tag, float(least), "at least 0", self.place_of(tag))

    def check_lengths(self, **values: float) -> None:
        """Refuses sizes of a drive in m, given by the names of their tags.

        Raises:
            PluginError: One is 0 or below, or not of a size that anything has.
        """
        self.check_above_zero(**values)
        for name, value in values.items():
            if value > FARTHEST:
                raise invalid(name, value, f"at most {FARTHEST:g} m", self.place_of(name))

    def place_of(self, tag: str) -> Origin | None:
        """Where a tag of the plugin is written, or the plugin itself."""
        found = self.tag.element.find(tag)
        return found.origin if found is not None else self.tag.origin

    @property
    def title(self) -> str:
        """The plugin and its model, for messages."""
        name = self.tag.filename or self.tag.name
        model = f' of model "{self.part.name}"' if self.part.name else ""
        return f'plugin "{name}"{model}' if self.tag.filename else f'sensor "{name}"{model}'

    @property
    def node(self) -> str:
        """Who publishes, for listings."""
        names = (self.part.name, self.tag.name)
        return "/".join(name for name in names if name) or "world"


def _remappings(tag: PluginTag) -> dict[str, str]:
    ros = tag.element.find("ros")
    pairs = {}
    for remapping in ros.find_all("remapping") if ros else ():
        source, separator, target = remapping.text.strip().partition(":=")
        if separator:
            pairs[source.removeprefix("~/")] = target.removeprefix("~/")
    return pairs
