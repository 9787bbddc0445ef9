"""The hardware in the ``<robotSimType>`` of gazebo_ros_control."""

from __future__ import annotations

from cartwheel.codes.devices import HARDWARE_UNKNOWN
from cartwheel.description.model import PluginTag
from cartwheel.errors import Diagnostic

PLAIN = ("gazebo_ros_control/DefaultRobotHWSim", "DefaultRobotHWSim", "")
"""Names of the only hardware in the package."""
_PACKAGE = "gazebo_ros_control/"


def is_plain(kind: str) -> bool:
    """Whether it is the hardware of the package."""
    return kind.rpartition("::")[2] in PLAIN


def is_unknown(kind: str) -> bool:
    """Whether it is said to be in the package, which does not contain it."""
    return kind.strip().startswith(_PACKAGE) and not is_plain(kind)


def unknown_hardware(tag: PluginTag, kind: str) -> Diagnostic:
    """The diagnostic for a plugin with unknown hardware."""
    return HARDWARE_UNKNOWN.diagnostic(
        f'<robotSimType>: the package "gazebo_ros_control" does not contain "{kind.strip()}", so '
        "DefaultRobotHWSim is used; Gazebo would start no controller",
        severity="error",
        origin=tag.origin,
        values={"hardware": kind.strip(), "meant": PLAIN[0], "plugin": tag.filename},
    )
