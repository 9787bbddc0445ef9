"""The ``<plugin>`` tags of worlds: those that act, what Cartwheel does anyway, and the rest."""

from __future__ import annotations

import functools

from cartwheel.errors import CartwheelError, Diagnostic, Severity, fault
from cartwheel.graph import Graph
from cartwheel.plugins.catalogue import plugin_named, short_name
from cartwheel.plugins.gz_sensor import SYSTEMS
from cartwheel.simulation import Part
from cartwheel.simulation.resident import Behaviour

BUILT_IN = {
    *SYSTEMS,
    "gz-sim-physics-system",
    "gz-sim-user-commands-system",
    "gz-sim-scene-broadcaster-system",
    "gazebo_ros_init",
    "gazebo_ros_factory",
    "gazebo_ros_force_system",
    "gazebo_ros_state",
    "gazebo_ros_properties",
    "gazebo_ros_api_plugin",
    "gazebo_ros_paths_plugin",
}
"""Physics, spawning, time and sensors need no plugin here, wherever one is named."""


def attach_world(part: Part, graph: Graph) -> list[Behaviour]:
    """Makes the plugins of the world itself; one that does nothing here is reported.

    A plugin that cannot be made costs the world that plugin, which is reported.

    Args:
        part: The world's own.
        graph: Where they publish.
    """
    made: list[Behaviour] = []
    for tag in part.world.plugins:
        name = short_name(tag.filename)
        if name in BUILT_IN:
            continue
        plugin = plugin_named(tag.filename)
        severity: Severity = "warning"
        if plugin is None:
            message = (
                f'world plugin "{tag.filename}" is not supported: what it does is missing here'
            )
        elif not plugin.for_world:
            message = f'plugin "{tag.filename}" has no effect here: it belongs inside a <model>'
        else:
            try:
                made.append(part.made(functools.partial(plugin, part, graph, tag, None)))
                continue
            except CartwheelError as error:
                severity = "error"
                message = f'plugin "{tag.filename}" is left out: {error.message}'
            except Exception as error:  # noqa: BLE001 - a plugin's own
                text = f'plugin "{tag.filename}" failed and is left out'
                part.report(fault(text, error, tag.origin))
                continue
        part.report(Diagnostic(severity=severity, message=message, origin=tag.origin))
    return made
