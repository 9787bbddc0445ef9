"""The ``<plugin>`` tags in worlds: supported, built-in and unsupported plugins."""

from __future__ import annotations

from cartwheel.calls import raise_exit
from cartwheel.codes import devices, running
from cartwheel.component import Shared
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.gz.sensor_tags import SYSTEMS
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.plugin_files import PluginFiles, raised_at
from cartwheel.errors import CartwheelError, Diagnostic, PluginError, fault
from cartwheel.options import plugin_file
from cartwheel.simulation import Part
from cartwheel.simulation.models.resident import Behaviour

Faults = tuple[type[CartwheelError], ...]

_OF_SERVER = frozenset(
    {
        "gazebo_ros_init",
        "gazebo_ros_factory",
        "gazebo_ros_force_system",
        "gazebo_ros_api_plugin",
        "gazebo_ros_paths_plugin",
    }
)
"""System plugins of Gazebo Classic, which it loads neither in a world nor in a model."""
_OF_WORLD = frozenset(
    {"gazebo_ros_state", "gazebo_ros_properties", "rotors_gazebo_ros_interface_plugin"}
)
"""World plugins of Gazebo Classic, which it does not load in a model."""
BUILT_IN = {
    *SYSTEMS,
    "gz-sim-physics-system",
    "gz-sim-user-commands-system",
    "gz-sim-scene-broadcaster-system",
    *_OF_SERVER,
    *_OF_WORLD,
}
"""Plugins for physics, spawning, time, sensors and ROS, which Cartwheel always provides."""
DISPLAY_ONLY = frozenset(
    {
        "BloomVisualPlugin",
        "DrawForcePlugin",
        "HeightmapLODPlugin",
        "KeyboardGUIPlugin",
        "LensFlareSensorPlugin",
        "LensFlareVisualPlugin",
        "LinkPlot3DPlugin",
        "gz-sim-lens-flare-system",
        "unitreeDrawForcePlugin",
    }
)
"""Plugins that only change what Gazebo's window shows."""
KEYS_OF_WINDOW = frozenset({"KeysToCmdVelPlugin"})
"""Plugins that convert keys, which are pressed in Gazebo's window, to velocity commands."""
SLEEPING = frozenset(
    {
        "disable_link_plugin",
        "gazebo_disable_link_plugin",
        "roboticsgroup_gazebo_disable_link_plugin",
        "roboticsgroup_upatras_gazebo_disable_link_plugin",
    }
)
"""Plugins that call ODE's ``dBodyDisable`` for a link at the start. ODE enables a body again that a
joint or a contact connects to one that is enabled.
"""
WITHOUT_EFFECT = DISPLAY_ONLY | KEYS_OF_WINDOW | SLEEPING


def without_effect(tag: PluginTag) -> Diagnostic:
    """Returns the note about a plugin that only concerns Gazebo's window, or has no lasting effect
    there.
    """
    name = short_name(tag.filename)
    reads_keys = name in KEYS_OF_WINDOW
    does = "changes what Gazebo's window shows"
    if reads_keys:
        does = "reads keys from Gazebo's window"
    if name in SLEEPING:
        does = "disables a link until a joint or a contact of the link moves it"
    return devices.PLUGIN_UNKNOWN.diagnostic(
        f'plugin "{tag.filename}" only {does}, so it has no effect',
        origin=tag.origin,
        hint="Drive the model with the keys of the web interface or of `cartwheel teleop`."
        if reads_keys
        else "",
        values={"name": tag.filename},
        mark=tag.filename,
    )


def misplaced(tag: PluginTag, place: str) -> Diagnostic:
    """Returns the diagnostic for a plugin that must be inside of a different element."""
    return devices.PLUGIN_MISPLACED.diagnostic(
        f'plugin "{tag.filename}" has no effect here because it must be inside a <{place}>',
        origin=tag.origin,
        values={"name": tag.filename, "place": place},
    )


def refused(tag: PluginTag, *, in_world: bool = False) -> Diagnostic | None:
    """Returns the diagnostic for a built-in plugin that Gazebo refuses to load in a model, or in a
    world; None if it loads the plugin.
    """
    name = short_name(tag.filename)
    if name in _OF_WORLD and not in_world:
        return misplaced(tag, "world")
    if name not in _OF_SERVER:
        return None
    meant = f"lib{tag.name}.so" if plugin_named(tag.name) is not None else ""
    return devices.PLUGIN_MISPLACED.diagnostic(
        f'plugin "{tag.filename}" has no effect here because Gazebo loads it only when it starts',
        origin=tag.origin,
        hint=f'Its name suggests that "{meant}" is meant.'
        if meant
        else "Remove it: the launch files of gazebo_ros load it.",
        values={"name": tag.filename, "place": "server", "meant": meant},
    )


def create(
    part: Part,
    shared: Shared,
    plugin: type[Plugin[object]],
    tag: PluginTag,
    sensor: Sensor | None = None,
    *,
    forgiven: Faults = (CartwheelError,),
    raises: bool = False,
) -> list[Plugin[object]]:
    """Returns a list of the plugin; empty, with a report, if it cannot be created.

    Args:
        part: The model's or the world's part of the simulation.
        shared: Objects that all components of the simulation share.
        plugin: Its class.
        tag: Its tag.
        sensor: The sensor around the tag.
        forgiven: Errors after which it is skipped, with a report.
        raises: Whether an unexpected exception is an error, instead of a report.

    Raises:
        CartwheelError: It cannot be created.
    """
    try:
        return [part.made(lambda: plugin(part, shared, tag, sensor))]
    except CartwheelError as error:
        if not isinstance(error, forgiven):
            error.origin = error.origin or tag.origin
            raise
        part.report(_left_out(tag, error))
    except (Exception, SystemExit) as error:
        found = _failed(tag, error, raises=raises)
        if raises:
            raise PluginError(
                f"{found.message}{raised_at(error, plugin)}", code=found.code, origin=found.origin,
                values=found.values,
            ) from error  # fmt: skip
        part.report(found)
    return []


def _left_out(tag: PluginTag, error: CartwheelError) -> Diagnostic:
    """Returns the diagnostic for a plugin or sensor that cannot be created."""
    return running.PLUGIN_LEFT_OUT.because(
        f"{_title(tag)} is ignored",
        error,
        origin=tag.origin,
        values={"plugin": tag.filename or tag.name},
    )


def _failed(tag: PluginTag, error: BaseException, *, raises: bool) -> Diagnostic:
    """Returns the diagnostic for a plugin or sensor with an unexpected exception at creation."""
    raise_exit(error)
    return fault(
        f"{_title(tag)} failed{'' if raises else ' and is ignored'}",
        error,
        tag.origin,
        code=running.PLUGIN_FAILED,
        values={"plugin": tag.filename or tag.name},
    )


def _title(tag: PluginTag) -> str:
    return f'plugin "{tag.filename}"' if tag.filename else f'sensor "{tag.name}"'


def attach_world(part: Part, shared: Shared) -> list[Behaviour]:
    """Creates the plugins of the world and reports those that have no effect.

    A plugin that cannot be created is skipped with a report.

    Args:
        part: The world's part of the simulation.
        shared: Objects that all components of the simulation share.
    """
    behaviours: list[Behaviour] = []
    for tag in part.world.plugins:
        name = short_name(tag.filename)
        if name in BUILT_IN:
            if (wrong := refused(tag, in_world=True)) is not None:
                part.report(wrong)
            continue
        if name in WITHOUT_EFFECT:
            part.report(without_effect(tag))
            continue
        plugin = plugin_named(tag.filename, shared.get(PluginFiles).classes)
        if plugin is None:
            part.report(
                devices.PLUGIN_UNKNOWN.diagnostic(
                    f'the world plugin "{tag.filename}" is not supported, so it has no effect',
                    severity="warning",
                    origin=tag.origin,
                    hint=plugin_file(),
                    values={"name": tag.filename},
                    mark=tag.filename,
                )
            )
        elif not (plugin.for_world or plugin.also_in_world):
            part.report(misplaced(tag, "model"))
        else:
            behaviours += create(part, shared, plugin, tag)
    return behaviours
