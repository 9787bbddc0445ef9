"""What a model's tags make: plugins, each told what is its own."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from cartwheel.codes import devices
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import (
    CartwheelError,
    StaticModelError,
    UnknownNameError,
    meant_one,
)
from cartwheel.graph import Graph
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.catalogue import (
    plugin_named,
    plugin_names,
    plugin_serving,
    short_name,
    unloadable,
)
from cartwheel.plugins.gz_sensor import own_tag, publishes
from cartwheel.plugins.parameters import tags_of
from cartwheel.plugins.world_plugins import BUILT_IN, failed, left_out
from cartwheel.simulation import Part
from cartwheel.simulation.resident import Behaviour

_Faults = tuple[type[CartwheelError], ...]
_ANY: _Faults = (CartwheelError,)
_HARMLESS: _Faults = (StaticModelError,)
"""Of which a plugin is left out wherever it is."""


def attach(part: Part, graph: Graph, *, lenient: bool = False) -> list[Behaviour]:
    """Makes the plugins of a model; what is not supported is reported, never passed over.

    A plugin that cannot be made is an error of the model. A system of new Gazebo that a world's
    model names costs itself alone, as there, and so does a sensor without a plugin: that is
    reported.

    Args:
        part: Of the model.
        graph: Where plugins publish.
        lenient: A plugin costs itself alone, too, where it names what the model does not have.

    Raises:
        CartwheelError: A plugin's parameters make no sense; those made before are closed.
    """
    made: list[Plugin[object]] = []
    sensors = [sensor for link in part.description.links for sensor in link.sensors]
    pairs: list[tuple[PluginTag, Sensor | None]] = [(tag, None) for tag in part.description.plugins]
    pairs += [(tag, sensor) for sensor in sensors for tag in sensor.plugins]
    systems = {short_name(tag.filename) for tag in (*part.world.plugins, *part.description.plugins)}
    in_world = any(model is part.description for model in part.world.models)
    more: _Faults = (UnknownNameError,) if lenient else ()
    try:
        for tag, sensor in pairs:
            plugin = plugin_named(tag.filename)
            own_system = in_world and short_name(tag.filename).startswith("gz-sim-")
            if plugin is None and short_name(tag.filename) in BUILT_IN:
                continue
            if plugin is None:
                _report_unknown(part, tag)
            elif plugin.for_world or (plugin.for_sensor and sensor is None):
                place = "world" if plugin.for_world else "sensor"
                part.report(
                    devices.PLUGIN_MISPLACED.diagnostic(
                        f'plugin "{tag.filename}" has no effect here: '
                        f"it belongs inside a <{place}>",
                        origin=tag.origin,
                        values={"name": tag.filename, "place": place},
                    )
                )
            else:
                forgiven = _ANY if own_system else (*_HARMLESS, *more)
                made += _made(part, graph, plugin, tag, sensor, forgiven=forgiven)
        alone = [
            one
            for one in sensors
            if one.name not in part.read_sensors
            and not any(plugin_named(tag.filename) for tag in one.plugins)
        ]
        made += _serve(part, graph, alone, systems)
    except Exception:
        for plugin_made in made:
            plugin_made.close()
        raise
    return list(made)


def _made(
    part: Part,
    graph: Graph,
    plugin: type[Plugin[object]],
    tag: PluginTag,
    sensor: Sensor | None,
    *,
    forgiven: _Faults,
) -> list[Plugin[object]]:
    """The plugin; none where it cannot be made and that is reported."""
    try:
        return [part.made(lambda: plugin(part, graph, tag, sensor))]
    except CartwheelError as error:
        if not isinstance(error, forgiven):
            raise
        part.report(left_out(tag, error))
    except Exception as error:  # noqa: BLE001 - a plugin's own
        part.report(failed(tag, error))
    return []


def _serve(
    part: Part, graph: Graph, sensors: Iterable[Sensor], systems: Collection[str]
) -> Iterator[Plugin[object]]:
    """The plugins of sensors that have none of their own."""
    for sensor in sensors:
        plugin = plugin_serving(sensor.type)
        wanted = publishes(sensor, systems)
        if wanted and plugin is not None:
            tag = own_tag(sensor, tags_of(plugin.parameters))
            yield from _made(part, graph, plugin, tag, sensor, forgiven=_ANY)
            continue
        if sensor.plugins:
            # The plugin's diagnostic says what is missing.
            continue
        reason = f' and type "{sensor.type}", which publishes nothing without one' if wanted else ""
        part.report(
            devices.SENSOR_WITHOUT_PLUGIN.diagnostic(
                f'sensor "{sensor.name}" has no <plugin>{reason or ", so it publishes nothing"}',
                severity="warning" if wanted else "info",
                origin=sensor.origin,
                values={"sensor": sensor.name, "type": sensor.type},
            )
        )


def _report_unknown(part: Part, tag: PluginTag) -> None:
    # Only a spelling error has a likely meant name: other plugins share most of theirs.
    meant = meant_one(tag.filename, [f"lib{name}.so" for name in plugin_names()], cutoff=0.92)
    broken = unloadable()
    suggested = f'Did you mean "{meant}"?' if meant else ""
    part.report(
        devices.PLUGIN_UNKNOWN.diagnostic(
            f'plugin "{tag.filename}" is not supported, so it has no effect',
            severity="warning",
            origin=tag.origin,
            hint=" ".join((suggested, *broken)).strip(),
            values={"name": tag.filename, "meant": meant, "broken": tuple(broken)},
            mark=tag.filename,
        )
    )
