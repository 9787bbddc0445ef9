"""Information about Cartwheel's plugins and controllers, for the rules that check them."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from cartwheel.checks.subject import PluginKnowledge
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.dialects.tag_roles import TagRole, wheels
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
        roles=_roles,
        controller_types=tuple(sorted(controller_types())),
        controller_files=files_for,
    )


def _default_joints(tag: PluginTag) -> Iterable[tuple[tuple[str, ...], str]]:
    from cartwheel.dialects.catalogue import plugin_named
    from cartwheel.dialects.tags import default_joints

    plugin = plugin_named(tag.filename)
    return () if plugin is None else default_joints(plugin.parameters, tag.element)


_RELATED = {
    "diff_drive": "gazebo_ros_diff_drive",
    "diffdrive": "gazebo_ros_diff_drive",
    "diff-drive": "gazebo_ros_diff_drive",
    "skid_steer": "gazebo_ros_skid_steer_drive",
    "skid-steer": "gazebo_ros_skid_steer_drive",
}
"""Plugins by parts of the names of unsupported plugins, whose joints probably have equal tags."""


@cache
def _roles(filename: str) -> tuple[TagRole, ...]:
    """The roles of the tags of a plugin, or of the plugin from which it is probably derived."""
    from cartwheel.dialects.catalogue import plugin_named, plugin_names, short_name
    from cartwheel.dialects.tags import roles_of

    name = short_name(filename)
    within = [each for each in plugin_names() if each.removesuffix("-system") in name]
    plugin = plugin_named(filename) or plugin_named(max(within, key=len, default=""))
    if plugin is not None and (roles := roles_of(plugin.parameters)):
        return roles
    related = next((each for part, each in _RELATED.items() if part in name), "")
    plugin = plugin_named(related)
    roles = () if plugin is None else roles_of(plugin.parameters)
    return (*wheels(roles, "left"), *wheels(roles, "right"))


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
