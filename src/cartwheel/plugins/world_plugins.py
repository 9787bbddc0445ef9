"""The ``<plugin>`` tags of worlds: what Cartwheel does anyway, and what is told to be missing."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic
from cartwheel.plugins.gz_sensor import SYSTEMS
from cartwheel.plugins.registry import plugins, short_name

_BUILT_IN = {
    *SYSTEMS,
    "gz-sim-physics-system",
    "gz-sim-user-commands-system",
    "gz-sim-scene-broadcaster-system",
    "gazebo_ros_init",
    "gazebo_ros_factory",
    "gazebo_ros_api_plugin",
    "gazebo_ros_paths_plugin",
}
"""Physics, spawning, time and sensors need no plugin here."""


def world_plugin_notes(world: WorldDescription) -> Iterator[Diagnostic]:
    """A warning for each plugin of a world that does nothing here."""
    for tag in world.plugins:
        name = short_name(tag.filename)
        if name in _BUILT_IN:
            continue
        if name in plugins():
            message = f'plugin "{tag.filename}" has no effect here: it belongs inside a <model>'
        else:
            message = (
                f'world plugin "{tag.filename}" is not supported: what it does is missing here'
            )
        yield Diagnostic(severity="warning", message=message, origin=tag.origin)
