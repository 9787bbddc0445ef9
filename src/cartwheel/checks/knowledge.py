"""Information about Cartwheel's plugins and controllers, for the rules that check them."""

from __future__ import annotations

from collections.abc import Iterable

from cartwheel.description.check import PluginKnowledge
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import Diagnostic, PluginError


def knowledge() -> PluginKnowledge:
    """Information about all plugins and controllers that Cartwheel supports."""
    from cartwheel.dialects.catalogue import all_plugins
    from cartwheel.dialects.ros_control.catalogue import controller_types
    from cartwheel.dialects.ros_control.suggestion import files_for

    names = {name for plugin in all_plugins() for name in plugin.filenames}
    return PluginKnowledge(
        filenames=tuple(sorted(names)),
        judge=_judge,
        default_joints=_default_joints,
        controller_types=tuple(sorted(controller_types())),
        controller_files=files_for,
    )


def _default_joints(tag: PluginTag) -> Iterable[tuple[tuple[str, ...], str]]:
    from cartwheel.dialects.catalogue import plugin_named
    from cartwheel.dialects.tags import default_joints

    plugin = plugin_named(tag.filename)
    return () if plugin is None else default_joints(plugin.parameters, tag.element)


def _judge(tag: PluginTag, _sensor: Sensor | None) -> Iterable[Diagnostic] | None:
    from cartwheel.dialects.catalogue import plugin_named, short_name
    from cartwheel.dialects.tags import read
    from cartwheel.dialects.world_plugins import BUILT_IN

    plugin = plugin_named(tag.filename)
    if plugin is None:
        return () if short_name(tag.filename) in BUILT_IN else None
    try:
        _, diagnostics = read(plugin.parameters, tag.element)
    except PluginError as error:
        return [error.diagnostic()]
    return diagnostics
