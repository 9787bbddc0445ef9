"""Transmissions for which gazebo_ros_control starts no controller of a robot."""

from __future__ import annotations

from cartwheel.description.model import Element, RobotDescription

_ABSENT = frozenset({"floating", "planar"})
"""Types of joints that Gazebo does not create for a URDF."""
_ACCEPTED = frozenset({"EffortJointInterface", "PositionJointInterface", "VelocityJointInterface"})
CONSEQUENCE = "so Gazebo starts no controller of this robot"


def stops(description: RobotDescription, transmission: Element, joint: Element) -> bool:
    """Whether the default hardware fails to start, because a joint does not exist in Gazebo.

    A transmission that the parser skips does not count. Source: transmission_interface,
    gazebo_ros_control.

    Args:
        description: The robot.
        transmission: A transmission.
        joint: Its only joint.
    """
    interfaces = _interfaces(transmission, joint)
    return bool(interfaces) and not _is_created(description, joint.attribute("name") or "")


def refused_interface(transmission: Element, joint: Element) -> Element | None:
    """Returns the interface of a transmission's only joint for which the default hardware fails to
    start: the first one, if it is not one of three. Source: as for `stops`.
    """
    first = next(iter(_interfaces(transmission, joint)), None)
    if first is None or first.text.strip().removeprefix("hardware_interface/") in _ACCEPTED:
        return None
    return first


def _interfaces(transmission: Element, joint: Element) -> list[Element]:
    """The interfaces of a joint; none if the parser skips the transmission."""
    kind = transmission.find("type")
    is_read = (
        transmission.attribute("name")
        and kind is not None
        and kind.text.strip()
        and any(each.attribute("name") for each in transmission.find_all("actuator"))
    )
    if not is_read:
        return []
    return [each for each in joint.find_all("hardwareInterface") if each.text.strip()]


def _is_created(description: RobotDescription, name: str) -> bool:
    """Whether Gazebo creates a joint: it merges links that a fixed joint connects."""
    joint = description.joint(name)
    if joint is None or joint.type in _ABSENT:
        return False
    return joint.type != "fixed" or joint.preserve_fixed or joint.parent == "world"
