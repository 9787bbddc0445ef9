"""Creates the plugins of a model from its tags."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from functools import partial
from operator import is_

from cartwheel.codes import devices
from cartwheel.component import Shared
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.dialects.catalogue import (
    Plugins,
    plugin_named,
    plugin_names,
    plugin_serving,
    short_name,
    unloadable,
)
from cartwheel.dialects.classic.refusals import refusal
from cartwheel.dialects.gz.sensor_tags import own_tag, publishes
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.plugin_files import PluginFiles
from cartwheel.dialects.substitutes import substitute
from cartwheel.dialects.tags import tags_of
from cartwheel.dialects.world_plugins import (
    BUILT_IN,
    WITHOUT_EFFECT,
    Faults,
    create,
    misplaced,
    refused,
    without_effect,
)
from cartwheel.errors import CartwheelError, StaticModelError
from cartwheel.options import plugin_file
from cartwheel.similar_names import meant_one
from cartwheel.simulation import Part
from cartwheel.simulation.models.resident import Behaviour

_ANY: Faults = (CartwheelError,)
_HARMLESS: Faults = (StaticModelError,)
"""Errors after which a plugin is skipped, with a report."""


def attach(part: Part, shared: Shared, *, lenient: bool = False) -> list[Behaviour]:
    """Creates the plugins of a model and reports unsupported ones.

    If a plugin cannot be created and `lenient` is False, the model is not loaded. These plugins
    are always skipped with a report: gz-sim systems in a model that is part of a world, as in
    Gazebo; plugins for sensors without a ``<plugin>``; plugins that would drive a joint of a static
    model; and plugins that raise an unexpected exception, unless they are in a file of the user.

    Args:
        part: The model's part of the simulation.
        shared: Objects that all components of the simulation share.
        lenient: Skip every plugin that cannot be created, with a report.

    Raises:
        CartwheelError: A plugin cannot be created. Plugins created before it are closed.
    """
    plugins: list[Plugin[object]] = []
    sensors = [sensor for link in part.description.links for sensor in link.sensors]
    pairs: list[tuple[PluginTag, Sensor | None]] = [(tag, None) for tag in part.description.plugins]
    pairs += [(tag, sensor) for sensor in sensors for tag in sensor.plugins]
    systems = {short_name(tag.filename) for tag in (*part.world.plugins, *part.description.plugins)}
    more = shared.get(PluginFiles).classes
    try:
        for tag, sensor in pairs:
            plugin = plugin_named(tag.filename, more)
            # In this order: a world may have thousands of models without plugins.
            own_system = short_name(tag.filename).startswith("gz-sim-") and _is_of_world(part)
            if plugin is None and short_name(tag.filename) in BUILT_IN:
                if (wrong := refused(tag)) is not None:
                    part.report(wrong)
                continue
            if plugin is None and short_name(tag.filename) in WITHOUT_EFFECT:
                part.report(without_effect(tag))
            elif plugin is None:
                _report_unknown(part, tag, sensor, more)
            elif plugin.for_world or (plugin.for_sensor and sensor is None):
                part.report(misplaced(tag, "world" if plugin.for_world else "sensor"))
            else:
                wrong = None if sensor is None else refusal(part.description, tag, sensor)
                if wrong is not None:
                    part.report(wrong)
                forgiven = _ANY if lenient or own_system else _HARMLESS
                plugins += create(
                    part, shared, plugin, tag, sensor,
                    forgiven=forgiven, raises=plugin in more and not lenient,
                )  # fmt: skip
        alone = [
            one
            for one in sensors
            if one.name not in part.read_sensors
            and not any(plugin_named(tag.filename, more) for tag in one.plugins)
        ]
        plugins += _serve(part, shared, alone, systems)
        effects = [*_effects_of_world(part, shared, more), *_added_masses(part, shared)]
    except BaseException:
        for created in plugins:
            created.close()
        raise
    return [*plugins, *effects]


def _is_of_world(part: Part) -> bool:
    """Whether the description of the world contains the model."""
    return any(map(partial(is_, part.description), part.world.models))


def _effects_of_world(part: Part, shared: Shared, more: Plugins) -> Iterator[Behaviour]:
    """Creates what the world's plugins add to a model. Of several of one class, the first acts."""
    tags: dict[type[Plugin[object]], PluginTag] = {}
    for tag in part.world.plugins:
        plugin = plugin_named(tag.filename, more)
        if plugin is not None and plugin.for_world:
            tags.setdefault(plugin, tag)
    for plugin, tag in tags.items():
        yield from plugin.added_to(part, shared, tag)


def _added_masses(part: Part, shared: Shared) -> Iterator[Behaviour]:
    """Creates the forces of the water that moves with links, as their inertials state."""
    inertials = [link.inertial for link in part.description.links]
    if not any(each is not None and each.added_mass for each in inertials):
        return
    from cartwheel.dialects.gz.fluids.hydrodynamics import HydrodynamicsSystem

    yield from HydrodynamicsSystem.of_inertials(part, shared)


def _serve(
    part: Part, shared: Shared, sensors: Iterable[Sensor], systems: Collection[str]
) -> Iterator[Plugin[object]]:
    """Creates plugins for sensors that have no ``<plugin>``."""
    for sensor in sensors:
        plugin = plugin_serving(sensor.type, shared.get(PluginFiles).classes)
        wanted = publishes(sensor, systems)
        if wanted and plugin is not None:
            tag = own_tag(sensor, tags_of(plugin.parameters))
            yield from create(part, shared, plugin, tag, sensor, forgiven=_ANY)
            continue
        if sensor.plugins:
            # The diagnostic about the unsupported plugin also covers the sensor.
            continue
        reason = (
            (f', and sensors of type "{sensor.type}" are not simulated without one')
            if wanted
            else ""
        )
        part.report(
            devices.SENSOR_WITHOUT_PLUGIN.diagnostic(
                f'sensor "{sensor.name}" has no <plugin>{reason or ", so it publishes nothing"}',
                severity="warning" if wanted else "info",
                origin=sensor.origin,
                values={"sensor": sensor.name, "type": sensor.type},
            )
        )


def _report_unknown(part: Part, tag: PluginTag, sensor: Sensor | None, more: Plugins) -> None:
    # The cutoff is high because the names of different plugins are similar.
    meant = meant_one(tag.filename, [f"lib{name}.so" for name in plugin_names(more)], cutoff=0.92)
    broken = unloadable()
    suggested = f'Did you mean "{meant}"?' if meant else ""
    other = None if meant else substitute(tag)
    if other is not None:
        suggested = other.hint(in_sensor=sensor is not None)
    elif not (meant or broken):
        suggested = plugin_file()
    part.report(
        devices.PLUGIN_UNKNOWN.diagnostic(
            f'plugin "{tag.filename}" is not supported, so it has no effect',
            severity="warning",
            origin=tag.origin,
            hint=" ".join((suggested, *broken)).strip(),
            values={
                "name": tag.filename,
                "meant": meant,
                "substitute": other.filename if other is not None else "",
                "broken": tuple(broken),
            },
            mark=tag.filename,
        )
    )
