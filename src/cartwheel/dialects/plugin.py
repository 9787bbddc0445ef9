"""The base class of all plugins: parameters, file names, and the names of a tag."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, is_dataclass
from typing import Any, ClassVar, Generic, TypeVar, get_args

from cartwheel.codes import devices
from cartwheel.component import Component, Scope, Shared
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.dialects.remappings import namespace_of, remappings
from cartwheel.dialects.tags import SMALLEST, invalid, read
from cartwheel.errors import Origin
from cartwheel.graph import Action, ActionTopics, Goal
from cartwheel.graph.actionlib import STATUS_RATE
from cartwheel.simulation import Part

C = TypeVar("C")
T = TypeVar("T")


@dataclass(kw_only=True, slots=True)
class TagScope(Scope):
    """The scope of a plugin, whose parameters are tags."""

    tag: PluginTag

    def place_of(self, parameter: str) -> Origin | None:
        """Returns the file and line of a tag in the plugin, or of the plugin if it is missing."""
        child = self.tag.element.find(parameter)
        return child.origin if child is not None else self.tag.origin


@dataclass(frozen=True, kw_only=True, slots=True)
class NoTags:
    """The parameters of a plugin that reads no tags of its own."""


class Plugin(Component, Generic[C]):
    """Base class of all plugins.

    Plugins are created before the model is compiled, so that they can request motors. A subclass
    sets `filenames` and `parameters`. Its `configure` acquires handles, advertises topics and
    schedules callbacks. Other packages register their plugins under the entry point group
    ``cartwheel.plugins``.
    """

    filenames: ClassVar[tuple[str, ...]]
    """File names without ``lib`` and ``.so``: ``gazebo_ros_diff_drive``."""
    parameters: ClassVar[type]
    """A frozen dataclass of `tag` fields. By default, the one in ``Plugin[…]``."""
    for_sensor: ClassVar[bool] = False
    """Whether the plugin belongs inside a ``<sensor>``."""
    sensor_type: ClassVar[str] = ""
    """Usual type of that sensor, shown in its documentation. Empty if `serves` is set."""
    for_world: ClassVar[bool] = False
    """Whether the plugin belongs directly inside a ``<world>``. Its `part` is then the world's."""
    also_in_world: ClassVar[bool] = False
    """Whether a plugin of models may also be directly inside a ``<world>``."""
    moves_model: ClassVar[bool] = False
    """Whether the plugin moves a model as a whole, which must be free to move."""
    empty_is_model: ClassVar[bool] = False
    """Whether an empty ``<robotNamespace>`` selects the model's name instead of no namespace."""
    reads_robot_namespace: ClassVar[bool] = True
    """Whether ``<robotNamespace>`` selects the namespace, as in ROS 1."""
    prefixes_by_namespace: ClassVar[bool] = False
    """Whether frame IDs are prefixed with the namespace if there is no ``tf_prefix``."""
    serves: ClassVar[tuple[str, ...]] = ()
    """Types of sensors that the plugin supports without a ``<plugin>``, like gz-sim's systems.

    The parameters of such a plugin are read from the ``<sensor>`` itself.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        bases: tuple[Any, ...] = vars(cls).get("__orig_bases__", ())
        for each in (argument for base in bases for argument in get_args(base)):
            if isinstance(each, type) and is_dataclass(each) and "parameters" not in vars(cls):
                cls.parameters = each

    def __init__(self, part: Part, shared: Shared, tag: PluginTag, sensor: Sensor | None) -> None:
        self.tag = tag
        self.sensor: Sensor | None = sensor
        super().__init__(self._scope(part, shared, tag))
        self.config: C = self.read_tags(self.parameters, tag.element)
        try:
            self.configure()
        except BaseException:
            # The subclass's own close may use attributes that configure has not set.
            Component.close(self)
            raise

    @classmethod
    def added_to(cls, part: Part, shared: Shared, tag: PluginTag) -> Iterator[Component]:  # noqa: ARG003
        """Creates what a plugin of the world adds to each of its models; by default nothing.

        Args:
            part: The model's part of the simulation.
            shared: Objects that all components of the simulation share.
            tag: The plugin's tag in the world.
        """
        return iter(())

    @staticmethod
    def _scope_on(part: Part, shared: Shared, tag: PluginTag, node: str, what: str) -> Scope:
        """The scope of a component that `added_to` creates.

        Args:
            part: The model's part of the simulation.
            shared: Objects that all components of the simulation share.
            tag: The plugin's tag in the world.
            node: The name of its node, after that of the model.
            what: What it is, before the name of the model, for messages.
        """
        return Scope(
            part=part,
            shared=shared,
            node=f"{part.name}/{node}",
            title=f'{what} model "{part.name}"',
            origin=tag.origin,
            common=True,
        )

    def _scope(self, part: Part, shared: Shared, tag: PluginTag) -> TagScope:
        ros = namespace_of(tag)
        plain = tag.element.find("robotNamespace")
        # As in Gazebo: the tag takes precedence over the spawner's namespace.
        namespace = part.namespace.rstrip("/")
        frame_prefix = part.frame_prefix
        if ros is not None:
            namespace = ros
        elif plain is not None and self.reads_robot_namespace:
            namespace = plain.text.strip() or (part.name if self.empty_is_model else "")
        if ros is None and self.prefixes_by_namespace and not frame_prefix:
            frame_prefix = namespace
        names = (part.name, tag.name)
        name = tag.filename or tag.name
        model = f' of model "{part.name}"' if part.name else ""
        return TagScope(
            part=part,
            shared=shared,
            node="/".join(name for name in names if name) or "world",
            title=f'plugin "{name}"{model}' if tag.filename else f'sensor "{name}"{model}',
            origin=tag.origin,
            namespace=namespace,
            frame_prefix=frame_prefix,
            remappings=remappings(tag),
            input_name=tag.name,
            owner=self,
            tag=tag,
        )

    @property
    def namespace(self) -> str:
        """Namespace of the plugin's topics and services."""
        return self.scope.namespace

    @namespace.setter
    def namespace(self, namespace: str) -> None:
        self.scope.namespace = namespace

    def configure(self) -> None:
        """Acquires handles, advertises topics and schedules callbacks.

        Raises:
            PluginError: A parameter is not allowed.
            UnknownNameError: A link or joint does not exist.
        """
        raise NotImplementedError

    def offer_action(
        self,
        name: str,
        type_name: str,
        *,
        on_goal: Callable[[Goal], None],
        on_cancel: Callable[[Goal], None],
    ) -> Action:
        """Offers an action, which is withdrawn with the plugin.

        Args:
            name: Name, resolved in the plugin's namespace.
            type_name: Action type, ``pkg/action/Name``.
            on_goal: Accepts, rejects or ends a new goal.
            on_cancel: Ends a goal whose cancellation was requested.

        Raises:
            GraphError: The name is already in use, or the type is invalid.
        """
        part = self.part
        self.graph.types.named(type_name)
        action = Action(
            self.graph,
            self.resolve(name),
            type_name,
            node=self.node,
            time_ns=lambda: part.time_ns,
            on_goal=on_goal,
            on_cancel=on_cancel,
        )
        self.keep(action)
        part.actions.add(action.name)
        # ROS 1 clients find the server by its status.
        topics = self.keep(ActionTopics(self.graph, action))
        part.schedule(STATUS_RATE, after=topics.publish_status)
        return action

    def under_model(self) -> None:
        """Uses the model's name as the namespace if neither the tag nor the spawner specifies one.

        Most Gazebo plugins use no namespace in this case.
        """
        element = self.tag.element
        namespace = element.find("robotNamespace") or element.find("ros")
        if namespace is None and not self.part.namespace:
            self.namespace = self.part.name

    def remaps(self, name: str) -> bool:
        """Whether the tag remaps this private name (``out`` for ``~/out``)."""
        return name in self.scope.remappings

    def read_tags(self, cls: type[T], element: Element, *, ignore: Iterable[str] = ()) -> T:
        """Fills a parameter dataclass from an element and reports its diagnostics; see `read`.

        Raises:
            PluginError: A value has the wrong type, or a required tag is missing.
        """
        config, diagnostics = read(cls, element, ignore=ignore)
        for diagnostic in diagnostics:
            self.part.report(diagnostic)
        return config

    def warn_ignored(self, name: str, reason: str) -> None:
        """Warns that a tag has no effect; `reason` follows in the message."""
        self.warn(
            devices.PLUGIN_PARAMETER_IGNORED,
            f"<{name}> has no effect: {reason}",
            values={"parameter": name},
        )

    def check_above_zero(self, **values: float) -> None:
        """Checks that parameters, given by their tags, are positive.

        Raises:
            PluginError: A value is 0 or negative, or too small to divide by.
        """
        for name, value in values.items():
            if value < SMALLEST:
                least = "positive" if value <= 0 else f"at least {SMALLEST:g}"
                raise invalid(name, value, least, self.place_of(name))

    def check_not_negative(self, *names: str, **values: float) -> None:
        """Checks that parameters are not negative.

        Args:
            names: Fields. Those that the plugin does not have are skipped. Each component of a
                vector is checked.
            values: Values by their tags, as for `check_above_zero`.

        Raises:
            PluginError: A value is negative.
        """
        for name, each in values.items():
            if each < 0:
                raise invalid(name, each, "at least 0", self.place_of(name))
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


class SensorPlugin(Plugin[C]):
    """Base class of plugins that belong inside a ``<sensor>``."""

    for_sensor: ClassVar[bool] = True
    sensor: Sensor
