"""The base class of all plugins: parameters, file names, and access to the simulation."""

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
from cartwheel.plugins.inputs import checked_callback, checked_positions
from cartwheel.plugins.parameters import SMALLEST, invalid, read
from cartwheel.simulation import LinkHandle, Part
from cartwheel.simulation.limits import FARTHEST


class Closable(Protocol):
    """A resource that a plugin holds while it is loaded."""

    def close(self) -> None:
        """Releases the resource."""


C = TypeVar("C")
K = TypeVar("K", bound=Closable)


class Plugin(Generic[C]):
    """Base class of all plugins.

    Plugins are created before the model is compiled, so that they can request motors. A subclass
    sets `filenames` and `parameters`. Its `configure` acquires handles, advertises topics and
    schedules callbacks. Other packages register their plugins under the entry point group
    ``cartwheel.plugins``.
    """

    filenames: ClassVar[tuple[str, ...]]
    """File names without ``lib`` and ``.so``: ``gazebo_ros_diff_drive``."""
    parameters: ClassVar[type]
    """A frozen dataclass of `tag` fields."""
    for_sensor: ClassVar[bool] = False
    """Whether the plugin belongs inside a ``<sensor>``."""
    sensor_type: ClassVar[str] = ""
    """Usual type of that sensor, shown in its documentation. Empty if `serves` is set."""
    for_world: ClassVar[bool] = False
    """Whether the plugin belongs directly inside a ``<world>``. Its `part` is then the world's."""
    empty_is_model: ClassVar[bool] = False
    """Whether an empty ``<robotNamespace>`` selects the model's name instead of no namespace."""
    prefixes_by_namespace: ClassVar[bool] = False
    """Whether frame IDs are prefixed with the namespace if there is no ``tf_prefix``."""
    serves: ClassVar[tuple[str, ...]] = ()
    """Types of sensors that the plugin supports without a ``<plugin>``, like gz-sim's systems.

    The parameters of such a plugin are read from the ``<sensor>`` itself.
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
        # As in Gazebo: the tag takes precedence over the spawner's namespace.
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
            # The subclass's own close may use attributes that configure has not set.
            Plugin.close(self)
            raise

    def configure(self) -> None:
        """Acquires handles, advertises topics and schedules callbacks.

        Raises:
            PluginError: A parameter is not allowed.
            UnknownNameError: A link or joint does not exist.
        """
        raise NotImplementedError

    def reset(self) -> None:
        """Restores the initial state when simulation time is reset to zero."""

    def close(self) -> None:
        """Withdraws all topics and services, when the model is deleted."""
        self._open.close()

    def keep(self, item: K) -> K:
        """Registers an item that is closed with the plugin, and returns it."""
        self._open.callback(item.close)
        return item

    def under_model(self) -> None:
        """Uses the model's name as the namespace if neither the tag nor the spawner specifies one.

        Most Gazebo plugins use no namespace in this case.
        """
        element = self.tag.element
        namespace = element.find("robotNamespace") or element.find("ros")
        if namespace is None and not self.part.namespace:
            self.namespace = self.part.name

    def resolve(self, name: str) -> str:
        """Returns a topic or service name in the plugin's namespace, after remapping."""
        if name in self._remappings:
            return resolve_name(self._remappings[name], self.namespace)
        full = resolve_name(name, self.namespace)
        for source, target in self._remappings.items():
            if resolve_name(source, self.namespace) == full:
                return resolve_name(target, self.namespace)
        return full

    def remaps(self, name: str) -> bool:
        """Whether the tag remaps this private name (``out`` for ``~/out``)."""
        return name in self._remappings

    def frame(self, name: str) -> str:
        """Returns a frame ID with the robot's prefix."""
        return resolve_frame(name, self._frame_prefix)

    def advertise(
        self, topic: str, type_name: str, *, rate: float | None = None, qos: Qos = "default"
    ) -> Publisher:
        """Advertises a topic. The publisher is closed with the plugin."""
        name = GzBridge.of(self.graph).published(self.resolve(topic), type_name)
        return self.keep(self.graph.advertise(name, type_name, node=self.node, rate=rate, qos=qos))

    def subscribe(self, topic: str, type_name: str, callback: Callable[[Any], None]) -> None:
        """Subscribes to a topic. The subscription is closed with the plugin.

        Messages with values that cannot be executed, such as NaN, are ignored with a warning.
        """
        callback = checked_callback(callback, self.part, self.warn)
        bridge = GzBridge.of(self.graph)
        name, kind, receiver = bridge.read(self.resolve(topic), type_name, callback)
        subscription = self.graph.subscribe(name, receiver, type_name=kind, node=self.node)
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
        """Offers a service, which is withdrawn with the plugin.

        If another plugin already offers the service, a warning is reported: two robots of the same
        kind can share topics, and a service must not prevent the second one from loading.

        Returns:
            Whether the service is offered.
        """
        try:
            service = self.graph.serve(
                self.resolve(name), type_name, handler, node=self.node, threaded=threaded
            )
        except GraphError as error:
            if not self._crowded:
                # Plugins that share one name usually share several: one warning is enough.
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
        """Accepts manual joint positions while the plugin is loaded; see `JointInput`."""
        inputs = self.graph.joint_inputs
        joint_input = JointInput(
            model=self.part.name,
            owner=self.tag.name or self.node,
            joints=tuple(joints),
            put=checked_positions(put, self.part),
        )
        inputs.add(joint_input)
        self._open.callback(inputs.remove, joint_input)

    def reconfigure(
        self,
        name: str,
        parameters: tuple[ReconfigureParameter, ...],
        on_change: OnChange,
        *,
        initial: Mapping[str, Value] | None = None,
        preset: bool = False,
    ) -> ReconfigureServer | None:
        """Offers parameters that can be changed at run time, as a `ReconfigureServer`.

        Returns None, with a warning, if another server already offers them or a preset value is not
        allowed.
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
        """Reports a diagnostic about this plugin.

        Args:
            code: Kind of the diagnostic. Other packages define their own: ``Code("ACME1", …)``.
            message: One sentence.
            at: File and line of the element in question; defaults to the plugin's tag.
            hint: The likely fix, as a sentence.
            values: Names and numbers in the message, for programs.
            severity: Defaults to a warning, regardless of the code's severity.
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
        """Returns the link with this name, or the root link if no link has this name."""
        description = self.part.description
        known = description.link(name) is not None
        return self.part.link(name if known else description.canonical_link)

    def check_above_zero(self, **values: float) -> None:
        """Checks that parameters, given by their tags, are positive.

        Raises:
            PluginError: A value is 0 or negative, or too small to divide by.
        """
        for name, value in values.items():
            if value < SMALLEST:
                least = "positive" if value <= 0 else f"at least {SMALLEST:g}"
                raise invalid(name, value, least, self.place_of(name))

    def check_not_negative(self, *names: str) -> None:
        """Checks that parameters, given by their fields, are not negative.

        Fields that the plugin does not have are skipped. Each component of a vector is checked.

        Raises:
            PluginError: A value is negative.
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
        """Checks dimensions of a drive in m, given by their tags.

        Raises:
            PluginError: A value is 0 or negative, or larger than any robot.
        """
        self.check_above_zero(**values)
        for name, value in values.items():
            if value > FARTHEST:
                raise invalid(name, value, f"at most {FARTHEST:g} m", self.place_of(name))

    def place_of(self, tag: str) -> Origin | None:
        """Returns the file and line of a tag in the plugin, or of the plugin if it is missing."""
        child = self.tag.element.find(tag)
        return child.origin if child is not None else self.tag.origin

    @property
    def title(self) -> str:
        """Names the plugin and its model, for messages."""
        name = self.tag.filename or self.tag.name
        model = f' of model "{self.part.name}"' if self.part.name else ""
        return f'plugin "{name}"{model}' if self.tag.filename else f'sensor "{name}"{model}'

    @property
    def node(self) -> str:
        """Names the plugin as a node, for listings."""
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
