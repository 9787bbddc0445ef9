"""Plugins of ros2_control that start no controller manager in Gazebo."""

from __future__ import annotations

from cartwheel.codes.devices import CONTROLLERS_NOT_FOUND
from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Diagnostic

_STRICT = ("gz_ros2_control-system", "ign_ros2_control-system")
"""Those that need ``<parameters>``. Source: gz_ros2_control and ign_ros2_control."""


def states_files(tag: PluginTag) -> bool:
    """Whether a plugin has a ``<parameters>`` tag that is not empty."""
    return any(each.text.strip() for each in tag.element.find_all("parameters"))


def without_parameters(tag: PluginTag) -> Diagnostic | None:
    """The finding that a plugin starts no controller manager, because it has no ``<parameters>``.

    None for other plugins. That of gazebo_ros2_control starts the manager without parameters.
    """
    if short_name(tag.filename) not in _STRICT or states_files(tag):
        return None
    return CONTROLLERS_NOT_FOUND.diagnostic(
        f'"{tag.filename}" has no <parameters>, without which it does not start the controller '
        "manager in Gazebo",
        origin=tag.origin,
        values={"started": (), "plugin": tag.filename, "tag": "parameters"},
        hint="Add <parameters>$(find PACKAGE)/config/controllers.yaml</parameters>.",
    )
