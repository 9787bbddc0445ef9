"""What the tags of plugins mean, and what a plugin reports about them.

The dialects declare the tags of each plugin with their roles and defaults. Authors derive plugins
from others and usually keep the names of their tags. For a plugin that Cartwheel does not simulate,
a tag therefore has the role that it has in any plugin.
"""

from __future__ import annotations

from functools import cache

from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import all_plugins, plugin_named, plugin_names, short_name
from cartwheel.dialects.remappings import namespace_of, remappings
from cartwheel.dialects.tag_roles import WHEEL_ROLES, Role, TagRole
from cartwheel.dialects.tags import default_joints as default_joints_of
from cartwheel.dialects.tags import read, roles_of, spellings_of, tags_of
from cartwheel.dialects.world_plugins import BUILT_IN, WITHOUT_EFFECT
from cartwheel.errors import Diagnostic, PluginError

_RELATED = {
    "diff_drive": "gazebo_ros_diff_drive",
    "diffdrive": "gazebo_ros_diff_drive",
    "diff-drive": "gazebo_ros_diff_drive",
    "skid_steer": "gazebo_ros_skid_steer_drive",
    "skid-steer": "gazebo_ros_skid_steer_drive",
}
"""Plugins by parts of the names of drives that are probably derived from them."""


def is_simulated(tag: PluginTag) -> bool:
    """Whether Cartwheel simulates a plugin, or does itself what the plugin does."""
    name = short_name(tag.filename)
    return plugin_named(tag.filename) is not None or name in BUILT_IN | WITHOUT_EFFECT


def diagnostics_of(tag: PluginTag) -> list[Diagnostic]:
    """What a plugin reports about its parameters; nothing for an unknown plugin."""
    plugin = plugin_named(tag.filename)
    if plugin is None:
        return []
    try:
        return read(plugin.parameters, tag.element)[1]
    except PluginError as error:
        return [error.diagnostic()]


def default_joints(tag: PluginTag) -> list[tuple[tuple[str, ...], str]]:
    """The joints that a plugin uses because no tag names one: the tag's spellings and the joint."""
    plugin = plugin_named(tag.filename)
    return [] if plugin is None else default_joints_of(plugin.parameters, tag.element)


@cache
def filenames() -> tuple[str, ...]:
    """The files of all plugins that Cartwheel simulates, such as ``libgazebo_ros_camera.so``."""
    return tuple(sorted({name for plugin in all_plugins() for name in plugin.filenames}))


@cache
def is_read(filename: str, tag: str) -> bool:
    """Whether a plugin that Cartwheel simulates reads a tag."""
    plugin = plugin_named(filename)
    return plugin is not None and tag in tags_of(plugin.parameters)


@cache
def spellings(filename: str, tag: str) -> tuple[str, ...]:
    """All tags that set the same parameter of a plugin as a tag does."""
    plugin = plugin_named(filename)
    return () if plugin is None else spellings_of(plugin.parameters, tag)


@cache
def roles_with(filename: str, *roles: Role) -> tuple[TagRole, ...]:
    """The tags that have one of these roles in a plugin, or in any plugin if it is unknown."""
    plugin = plugin_named(filename)
    plugins = all_plugins() if plugin is None else [plugin]
    return tuple(each for one in plugins for each in roles_of(one.parameters) if each.role in roles)


@cache
def tags_with(filename: str, *roles: Role) -> frozenset[str]:
    """All spellings of the tags that `roles_with` returns."""
    return frozenset(name for each in roles_with(filename, *roles) for name in each.tags)


def links_in(filename: str) -> frozenset[str]:
    """The tags of a plugin that name the link that it measures or moves."""
    # IMUs read their link from <frame_name>, which is a frame in all other plugins.
    return tags_with(filename, "link") - tags_with(filename, "frame")


def joints_in(filename: str) -> frozenset[str]:
    """The tags of a plugin that name joints other than those of driven wheels."""
    return tags_with(filename, "joint", "other_joint") - tags_with(filename, *WHEEL_ROLES)


@cache
def roles(filename: str) -> tuple[TagRole, ...]:
    """The tags of a plugin that have a role; of an unknown plugin only those of its wheels."""
    plugin = plugin_named(filename)
    if plugin is not None:
        return roles_of(plugin.parameters)
    name = short_name(filename)
    within = [each for each in plugin_names() if each.removesuffix("-system") in name]
    derived = plugin_named(max(within, key=len, default=""))
    if derived is not None and any(_is_of_wheels(each) for each in roles_of(derived.parameters)):
        return roles_of(derived.parameters)
    related = plugin_named(next((each for part, each in _RELATED.items() if part in name), ""))
    known = () if related is None else roles_of(related.parameters)
    return tuple(each for each in known if each.role in WHEEL_ROLES)


def _is_of_wheels(role: TagRole) -> bool:
    return role.role.startswith(("left_wheel", "right_wheel", "wheel_"))


def command_topic(tag: PluginTag) -> str:
    """The topic of a plugin's commands, in the namespace that its tags state.

    Plugins of one robot with the same result receive the same commands. Empty for a plugin that
    Cartwheel does not simulate, and for one that is no drive.
    """
    if plugin_named(tag.filename) is None:
        return ""
    for role in roles_with(tag.filename, "command_topic"):
        stated = next((each for name in role.tags if (each := tag.element.find(name))), None)
        default = next((str(each) for each in role.default), "")
        name = stated.text.strip() if stated is not None else default
        name = remappings(tag).get(name, name)
        space = namespace_of(tag)
        if space is None and (plain := tag.element.find("robotNamespace")) is not None:
            space = plain.text.strip()
        parts = ("" if name.startswith("/") else space or "", name or "cmd_vel")
        return "/" + "/".join(each.strip("/") for each in parts if each.strip("/"))
    return ""
